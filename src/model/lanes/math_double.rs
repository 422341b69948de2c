//! Elementary functions of the double-precision lanes: in every layout, the episode loop of the reference has the same
//! bits, whatever the standard library of a machine makes of them. (References and the constants of turbulence are
//! still the standard library's.)
//!
//! The polynomials interpolate at Chebyshev nodes (near minimax); the error of each, before rounding, is stated beside
//! it. With the roundings the functions are good to some units in the last place, which is tested.

use super::lane::Lane;
use super::math::polynomial;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// sin(pi/2 f) / f in powers of f^2 on [-1, 1]; error 8.4e-17.
const SIN_FOLDED: [f64; 10] = [
    FRAC_PI_2,
    -0.645_964_097_506_246_3,
    0.079_692_626_246_167_05,
    -0.004_681_754_135_318_648,
    0.000_160_441_184_787_096_8,
    -3.598_843_234_229_558_7e-6,
    5.692_172_698_478_116e-8,
    -6.688_003_632_156_792e-10,
    6.064_254_026_315_552e-12,
    -4.250_280_792_369_264_7e-14,
];
/// (sin r - r) / r^3 in powers of r^2 on [-pi/2, pi/2]; error 3.5e-17.
const SIN: [f64; 9] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_333_333,
    -0.000_198_412_698_412_698_06,
    2.755_731_922_397_117_5e-6,
    -2.505_210_838_237_619e-8,
    1.605_904_347_799_452e-10,
    -7.647_139_048_550_473e-13,
    2.810_466_816_590_253e-15,
    -8.005_858_059_980_551e-18,
];
/// (cos r - 1) / r^2 in powers of r^2 on [-pi/2, pi/2]; error 1.5e-17.
const COS: [f64; 10] = [
    -0.5,
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_889,
    2.480_158_730_158_722_4e-5,
    -2.755_731_922_396_519e-7,
    2.087_675_698_473_769_7e-9,
    -1.147_074_530_945_303_7e-11,
    4.779_460_895_006_41e-14,
    -1.561_353_824_286_596_6e-16,
    4.001_849_844_121_593e-19,
];
/// atan(q) / q in powers of q^2 on [0, tan(pi/8)]; error 2.7e-18.
const ATAN: [f64; 13] = [
    1.0,
    -0.333_333_333_333_333_26,
    0.199_999_999_999_970_12,
    -0.142_857_142_853_293_6,
    0.111_111_110_853_012_38,
    -0.090_909_080_582_984_1,
    0.076_922_810_836_789_01,
    -0.066_662_050_231_780_91,
    0.058_768_317_098_427_496,
    -0.052_172_979_196_550_59,
    0.044_994_415_067_496_046,
    -0.033_386_452_259_033_17,
    0.015_112_376_431_495_17,
];
/// (ln((1 + s) / (1 - s)) - 2 s) / s^3 in powers of s^2 where that is between sqrt(1/2) and sqrt(2); error 1.6e-18.
const LN: [f64; 7] = [
    0.666_666_666_666_667,
    0.399_999_999_998_994_44,
    0.285_714_286_260_032_7,
    0.222_222_111_302_598_78,
    0.181_828_894_556_749_47,
    0.153_317_106_182_107_73,
    0.146_165_854_248_886_23,
];
/// The ninth convergent of the continued fraction x / (1 + x^2 / (3 + x^2 / (5 + ..))) of tanh, in powers of x^2;
/// relative error 4.3e-18 up to 20/16.
const TANH_NUMERATOR: [f64; 5] = TANH.0;
const TANH_DENOMINATOR: [f64; 6] = TANH.1;
const TANH: ([f64; 5], [f64; 6]) = convergent();
/// Where tanh is 1 to half a unit in the last place.
const TANH_LIMIT: f64 = 19.1;
/// How often the argument of tanh is halved.
const TANH_HALVINGS: u32 = 4;

/// pi and ln 2 as sums, of which a few times the first parts are exact.
const PI_PARTS: [f64; 3] = [
    3.141_592_653_468_251_2,
    1.215_420_101_260_793_2e-10,
    4.044_532_497_591_901e-21,
];
const LN_2_PARTS: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
/// The bits of the double nearest to sqrt(1/2), and those of a double's fraction.
const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
const FRACTION_BITS: u64 = (1 << 52) - 1;

/// Numerator and denominator of tanh x / x, worked out from the inside.
const fn convergent() -> ([f64; 5], [f64; 6]) {
    // value = above / below, in powers of x^2.
    let (mut above, mut below) = ([0.0; 6], [0.0; 6]);
    (above[0], below[0]) = (19.0, 1.0);
    let mut odd = 17.0;
    while odd > 0.0 {
        // odd + x^2 / value.
        let mut next = [0.0; 6];
        let mut k = 0;
        while k < 6 {
            next[k] = odd * above[k] + if k > 0 { below[k - 1] } else { 0.0 };
            k += 1;
        }
        (above, below) = (next, above);
        odd -= 2.0;
    }
    // All are whole numbers below 2^53 so far, and tanh x / x is 1 at 0.
    let scale = above[0];
    let (mut numerator, mut denominator) = ([0.0; 5], [0.0; 6]);
    let mut k = 0;
    while k < 6 {
        denominator[k] = above[k] / scale;
        if k < 5 {
            numerator[k] = below[k] / scale;
        }
        k += 1;
    }
    (numerator, denominator)
}

/// A phase, a fraction of a turn in 64-bit fixed point, folded to [-1, 1]: its sine is that of pi/2 times this.
#[inline(always)]
#[expect(
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    reason = "the signed reading of the phase is meant; near the ends, where digits are lost, the sine is flat"
)]
pub(crate) fn folded(phase: u64) -> f64 {
    const QUARTER: u64 = 1 << 62;
    let doubled = (phase << 1) as i64 as f64 * (1.0 / 9_223_372_036_854_775_808.0);
    // The half wave around half a turn is turned over.
    let sign = phase.wrapping_add(QUARTER) & (1 << 63);
    f64::from_bits(doubled.to_bits() ^ sign)
}

/// sin(pi/2 f) for f in [-1, 1].
#[inline(always)]
pub(crate) fn sin_folded<L: Lane<Real = f64>>(f: L) -> L {
    polynomial(f * f, &SIN_FOLDED) * f
}

/// Sine and cosine of an angle of at most a few turns, rad; see [`super::math::sin_cos`].
#[inline(always)]
pub(crate) fn sin_cos<L: Lane<Real = f64>>(x: L) -> (L, L) {
    let half = L::number(0.5);
    let n = x.mul_add(L::number(FRAC_1_PI), half).floor();
    let mut r = x;
    for part in PI_PARTS {
        r = n.mul_add(L::number(-part), r);
    }
    let r2 = r * r;
    let sine = polynomial(r2, &SIN).mul_add(r2 * r, r);
    let cosine = polynomial(r2, &COS).mul_add(r2, L::number(1.0));
    let parity = n.mul_add(half, -(n * half).floor());
    let sign = parity.mul_add(L::number(-4.0), L::number(1.0));
    (sine * sign, cosine * sign)
}

/// Hyperbolic tangent: of a sixteenth of the argument, as a quotient that is doubled four times.
#[inline(always)]
pub(crate) fn tanh<L: Lane<Real = f64>>(x: L) -> L {
    let x = x.max(L::number(-TANH_LIMIT)).min(L::number(TANH_LIMIT));
    let part = x * L::number(1.0 / f64::from(1 << TANH_HALVINGS));
    let part2 = part * part;
    let mut above = polynomial(part2, &TANH_NUMERATOR) * part;
    let mut below = polynomial(part2, &TANH_DENOMINATOR);
    for _ in 0..TANH_HALVINGS {
        // tanh 2y = 2 tanh y / (1 + tanh^2 y).
        let product = above * below;
        (above, below) = (product + product, above.mul_add(above, below * below));
    }
    above / below
}

/// The angle of the point (x, y), rad; 0 at the origin.
#[inline(always)]
pub(crate) fn atan2<L: Lane<Real = f64>>(y: L, x: L) -> L {
    let (zero, one) = (L::number(0.0), L::number(1.0));
    let (run, rise) = (x.abs(), y.abs());
    // The smallest normal double keeps 0/0 out: at the origin the quotient is 0.
    let q = run.min(rise) / run.max(rise).max(L::number(f64::MIN_POSITIVE));
    // atan q = pi/4 + atan((q - 1) / (q + 1)), for which the polynomial is made beyond tan(pi/8).
    let limit = L::number(std::f64::consts::SQRT_2 - 1.0);
    let near = L::select_le(q, limit, q, (q - one) / (q + one));
    let from = L::select_le(q, limit, zero, L::number(FRAC_PI_4));
    let angle = from + polynomial(near * near, &ATAN) * near;
    let angle = L::select_le(rise, run, angle, L::number(FRAC_PI_2) - angle);
    let angle = L::select_le(zero, x, angle, L::number(PI) - angle);
    L::select_le(zero, y, angle, -angle)
}

/// A positive normal number as mantissa 2^exponent, with a mantissa between sqrt(1/2) and sqrt(2).
#[inline(always)]
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "an exponent is a small integer"
)]
pub(crate) fn split(x: f64) -> (f64, f64) {
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = ((shifted as i64) >> 52) as f64;
    let fraction = (shifted & FRACTION_BITS).wrapping_add(SQRT_HALF_BITS);
    (f64::from_bits(fraction), exponent)
}

/// ln(mantissa 2^exponent) for a mantissa between sqrt(1/2) and sqrt(2).
#[inline(always)]
pub(crate) fn ln_split<L: Lane<Real = f64>>(mantissa: L, exponent: L) -> L {
    let f = mantissa - L::number(1.0);
    let s = f / (f + L::number(2.0));
    let s2 = s * s;
    let tail = polynomial(s2, &LN) * (s2 * s);
    let [high, low] = LN_2_PARTS.map(L::number);
    exponent.mul_add(high, (s + s) + exponent.mul_add(low, tail))
}
