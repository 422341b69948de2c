//! Elementary functions of the single-precision lanes, written with the operations that WGSL has too: the library
//! functions of a GPU may be off by 2^-11, and those of the host differ from machine to machine.
//!
//! The polynomials were fitted by iteratively reweighted least squares on Chebyshev nodes (near minimax); the error of
//! each is stated beside it and tested. Double precision has `math_double`.

use super::lane::Lane;

/// Spacing of the numbers that [`Lane::unit_from_words`] makes from 23 random bits.
pub(crate) const UNIT_SPACING: f64 = 1.0 / 8_388_608.0;
/// A quarter of a turn in 32-bit fixed point.
pub(crate) const QUARTER_TURN: u32 = 1 << 30;
/// The sign bit of a single.
pub(crate) const SIGN_BIT: u32 = 1 << 31;
/// The bits of a single's fraction.
pub(crate) const MANTISSA_BITS: u32 = 0x007f_ffff;
/// The bits of the single nearest to sqrt(1/2), where the mantissas of [`ln_split`] begin.
pub(crate) const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
/// Scales a doubled 32-bit phase, read as signed, to [-1, 1).
pub(crate) const FOLD_SCALE: f32 = 1.0 / 2_147_483_648.0;

/// sin(pi/2 f) / f in powers of f^2 on [-1, 1]; error 6.7e-9 before rounding.
pub(crate) const SIN_FOLDED: [f64; 5] = [
    1.570_796_370_506_286_6,
    -0.645_963_788_032_531_7,
    0.079_689_927_399_158_48,
    -0.004_674_159_456_044_435_5,
    0.000_151_679_312_693_886_46,
];
/// (sin r - r) / r^3 in powers of r^2 on [-pi/2, pi/2]; error 7e-9.
pub(crate) const SIN: [f64; 4] = [
    -0.166_666_656_732_559_2,
    0.008_333_242_498_338_223,
    -0.000_198_228_051_885_962_49,
    2.634_924_612_721_079e-6,
];
/// (cos r - 1) / r^2 in powers of r^2 on [-pi/2, pi/2]; error 4e-10.
pub(crate) const COS: [f64; 5] = [
    -0.5,
    0.041_666_660_457_849_5,
    -0.001_388_865_755_870_938_3,
    2.477_488_851_582_165_8e-5,
    -2.630_331_437_103_451e-7,
];
/// atan(q) / q in powers of q^2 on [0, 1]; error 1.4e-8.
pub(crate) const ATAN: [f64; 9] = [
    1.0,
    -0.333_330_929_279_327_4,
    0.199_930_578_470_230_1,
    -0.142_071_589_827_537_54,
    0.106_547_623_872_756_96,
    -0.075_338_378_548_622_13,
    0.043_041_128_665_208_817,
    -0.016_284_020_617_604_256,
    0.002_903_792_308_643_460_3,
];
/// (ln(1 + f) - f + f^2/2) / f^3 in powers of f on [sqrt(1/2) - 1, sqrt(2) - 1]; error 9e-7, times f^3.
pub(crate) const LN: [f64; 7] = [
    0.333_334_028_720_855_7,
    -0.250_011_295_080_184_94,
    0.199_862_375_855_445_86,
    -0.165_834_546_089_172_36,
    0.146_461_203_694_343_57,
    -0.142_018_198_966_979_98,
    0.095_011_875_033_378_6,
];
/// The rational approximation of tanh that is in wide use (Eigen's generic float kernel): odd numerator and even
/// denominator, exact to 3 ulp below [`TANH_LIMIT`], beyond which a single cannot tell tanh from 1.
pub(crate) const TANH_NUMERATOR: [f64; 7] = [
    4.893_524_558_917_86e-3,
    6.372_619_288_754_36e-4,
    1.485_722_357_179_79e-5,
    5.122_297_090_371_14e-8,
    -8.604_671_522_137_35e-11,
    2.000_187_904_824_77e-13,
    -2.760_768_477_423_55e-16,
];
pub(crate) const TANH_DENOMINATOR: [f64; 4] = [
    4.893_525_185_543_85e-3,
    2.268_434_632_439_00e-3,
    1.185_347_056_866_54e-4,
    1.198_258_394_667_02e-6,
];
pub(crate) const TANH_LIMIT: f64 = 7.905_311_107_635_498;

/// pi as a sum of a single and a remainder, so that `x - n pi` keeps its digits for a few turns.
pub(crate) const PI_HIGH: f64 = 3.141_592_741_012_573_2;
pub(crate) const PI_LOW: f64 = -8.742_277_657_347_586e-8;

/// A fraction of a turn in 64-bit fixed point; whole turns drop out.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value lies in [0, 2^64]"
)]
pub(crate) fn fixed_turns(turns: f64) -> u64 {
    let fraction = turns - turns.floor();
    // A fraction that rounds up to one turn is the same phase as zero; `as` saturates, so it is caught here.
    if fraction >= 1.0 {
        0
    } else {
        (fraction * 18_446_744_073_709_551_616.0) as u64
    }
}

/// A fraction of a turn in 32-bit fixed point, rounded to nearest.
pub(crate) fn fixed_turns_32(turns: f64) -> u32 {
    (fixed_turns(turns).wrapping_add(1 << 31) >> 32) as u32
}

#[inline(always)]
pub(crate) fn polynomial<L: Lane, const N: usize>(x: L, coefficients: &[f64; N]) -> L {
    let mut sum = L::number(coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = sum.mul_add(x, L::number(coefficients[k]));
    }
    sum
}

/// sin(pi/2 f) for f in [-1, 1].
#[inline(always)]
pub(crate) fn sin_folded<L: Lane>(f: L) -> L {
    polynomial(f * f, &SIN_FOLDED) * f
}

/// Sine and cosine of an angle, rad: reduction to [-pi/2, pi/2] by the nearest multiple n of pi, whose parity is the
/// sign.
#[inline(always)]
pub(crate) fn sin_cos<L: Lane>(x: L) -> (L, L) {
    let half = L::number(0.5);
    let n = x
        .mul_add(L::number(std::f64::consts::FRAC_1_PI), half)
        .floor();
    let r = n.mul_add(L::number(-PI_LOW), n.mul_add(L::number(-PI_HIGH), x));
    let r2 = r * r;
    let sine = polynomial(r2, &SIN).mul_add(r2 * r, r);
    let cosine = polynomial(r2, &COS).mul_add(r2, L::number(1.0));
    let parity = n.mul_add(half, -(n * half).floor());
    let sign = parity.mul_add(L::number(-4.0), L::number(1.0));
    (sine * sign, cosine * sign)
}

/// Hyperbolic tangent; error below 3 ulp.
#[inline(always)]
pub(crate) fn tanh<L: Lane>(x: L) -> L {
    let x = x.max(L::number(-TANH_LIMIT)).min(L::number(TANH_LIMIT));
    let x2 = x * x;
    polynomial(x2, &TANH_NUMERATOR) * x / polynomial(x2, &TANH_DENOMINATOR)
}

/// The angle of the point (x, y), rad; 0 at the origin.
#[inline(always)]
pub(crate) fn atan2<L: Lane>(y: L, x: L) -> L {
    let zero = L::number(0.0);
    let (run, rise) = (x.abs(), y.abs());
    // The smallest normal single keeps 0/0 out: at the origin the quotient is 0.
    let q = run.min(rise) / run.max(rise).max(L::number(f64::from(f32::MIN_POSITIVE)));
    let angle = polynomial(q * q, &ATAN) * q;
    let angle = L::select_le(
        rise,
        run,
        angle,
        L::number(std::f64::consts::FRAC_PI_2) - angle,
    );
    let angle = L::select_le(zero, x, angle, L::number(std::f64::consts::PI) - angle);
    L::select_le(zero, y, angle, -angle)
}

/// ln(mantissa 2^exponent) for a mantissa in [sqrt(1/2), sqrt(2)).
#[inline(always)]
pub(crate) fn ln_split<L: Lane>(mantissa: L, exponent: L) -> L {
    let f = mantissa - L::number(1.0);
    let f2 = f * f;
    let tail = polynomial(f, &LN) * (f2 * f);
    let small = f2.mul_add(L::number(-0.5), tail) + f;
    exponent.mul_add(L::number(std::f64::consts::LN_2), small)
}

/// `value` within `low` and `high`; `low` where it is NaN.
#[inline(always)]
pub(crate) fn clamp<L: Lane>(value: L, low: L, high: L) -> L {
    value.max(low).min(high)
}
