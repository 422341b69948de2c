//! Student's t distribution.

use statrs::function::beta::ln_beta;

use super::binomial::beta_fraction;
use super::interval::is_level;
use super::search::bisect;

/// The t with P(|T| <= t) = `level` for Student's T with `freedom` > 0 degrees of freedom.
///
/// By bisection: the quantile function of `statrs` 0.19 does not end for some large degrees of
/// freedom.
pub(super) fn t_quantile(freedom: f64, level: f64) -> Option<f64> {
    if !is_level(level) || freedom.is_nan() || freedom <= 0.0 {
        return None;
    }
    // Beyond, t and z agree to 10^-7, and the log-gammas no longer tell them apart.
    let freedom = freedom.min(1e7);
    // t / sqrt(freedom) is the tangent of an angle, and all angles are a finite range.
    let angle = bisect(0.0, std::f64::consts::FRAC_PI_2, |angle| {
        two_sided_tail(angle.tan().powi(2), freedom) > 1.0 - level
    });
    Some(angle.tan() * freedom.sqrt())
}

/// P(T^2 > `square` x `freedom`) = I_x(freedom / 2, 1 / 2) with x = 1 / (1 + `square`) (DLMF 8.17).
pub(super) fn two_sided_tail(square: f64, freedom: f64) -> f64 {
    let (a, b) = (freedom / 2.0, 0.5);
    let (x, y) = (1.0 / (1.0 + square), square / (1.0 + square));
    let scale = (-a * square.ln_1p() + b * y.ln() - ln_beta(a, b)).exp();
    // The continued fraction converges on its own side of the mean, as for the binomial tails.
    if x < (a + 1.0) / (a + b + 2.0) {
        scale * beta_fraction(a, b, x) / a
    } else {
        1.0 - scale * beta_fraction(b, a, y) / b
    }
}
