//! The natural logarithm with the same digits on every machine.

/// Terms of the series: the first left out is below 1e-17 of the sum.
const TERMS: u32 = 11;

/// The bits of a double's exponent, above 52 of its fraction.
const FRACTION_BITS: u32 = 52;
const FRACTION: u64 = (1 << FRACTION_BITS) - 1;
/// The exponent of one, as it is stored.
const BIAS: u64 = 1023;

/// ln x of a positive, finite and normal number, to 3 units in the last place of the larger of its two terms.
///
/// x = 2^e m with m in [√½, √2]; ln m = 2 artanh z with z = (m - 1) / (m + 1), |z| < 0.172, by its power series.
#[must_use]
pub(crate) fn natural_logarithm(x: f64) -> f64 {
    let bits = x.to_bits();
    let mut mantissa = f64::from_bits((bits & FRACTION) | (BIAS << FRACTION_BITS));
    let mut exponent = f64::from(u32::try_from(bits >> FRACTION_BITS).unwrap_or(0)) - 1023.0;
    if mantissa > std::f64::consts::SQRT_2 {
        mantissa *= 0.5;
        exponent += 1.0;
    }
    let z = (mantissa - 1.0) / (mantissa + 1.0);
    let square = z * z;
    let mut series = 0.0;
    for term in (0..TERMS).rev() {
        series = series * square + 1.0 / f64::from(2 * term + 1);
    }
    exponent * std::f64::consts::LN_2 + 2.0 * z * series
}
