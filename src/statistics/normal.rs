//! The standard normal distribution.

/// The z with P(|Z| <= z) = `level` for a standard normal Z.
pub(super) fn two_sided_z(level: f64) -> f64 {
    std::f64::consts::SQRT_2 * statrs::function::erf::erfc_inv(1.0 - level)
}

/// The z that a standard normal number is below with probability `share`.
pub(crate) fn normal_quantile(share: f64) -> f64 {
    -std::f64::consts::SQRT_2 * statrs::function::erf::erfc_inv(2.0 * share)
}
