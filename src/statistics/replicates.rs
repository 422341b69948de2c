//! What independent replicates of a design say together.

use super::interval::{Estimate, Interval};
use super::student::{t_quantile, two_sided_tail};

/// Mean of the estimates of independent replicates, with Student's t interval over the replicates.
///
/// The one interval that holds for designs whose episodes are not independent (Latin hypercubes,
/// scrambled nets): each replicate gives one number, a failure rate, a mean or a paired difference,
/// unbiased and independent of the others. It takes these numbers to be roughly normal. Failure
/// rates are that from some ten failures per replicate on: simulated coverage of ten replicates at
/// 95 % is then 95 % to 96 %, and with five failures 93 %. Two replicates have t = 12.7; five or more
/// are worth their episodes.
///
/// One replicate, or a level outside (0, 1), leaves the interval (-inf, +inf). `None` for no values
/// and for values that are not finite.
pub fn replicate_mean(values: &[f64], level: f64) -> Option<Estimate> {
    let (mean, error) = mean_and_error(values)?;
    let freedom = values.len() as f64 - 1.0;
    let half_width = t_quantile(freedom, level).map_or(f64::INFINITY, |t| t * error);
    Some(Estimate {
        value: mean,
        interval: Interval {
            lower: mean - half_width,
            upper: mean + half_width,
        },
    })
}

/// Two-sided p-value of Student's t test that the mean of independent replicates is 0: at or below
/// 1 - `level` where the interval of [`replicate_mean`] leaves 0 out, and as exact as it is.
///
/// `None` for fewer than two values, for values that are not finite and for values that are all alike.
pub fn replicate_p(values: &[f64]) -> Option<f64> {
    let (mean, error) = mean_and_error(values)?;
    let freedom = values.len() as f64 - 1.0;
    let square = (mean / error).powi(2) / freedom;
    (error > 0.0).then(|| two_sided_tail(square.min(f64::MAX), freedom))
}

/// The mean and its standard error.
fn mean_and_error(values: &[f64]) -> Option<(f64, f64)> {
    if values.is_empty() || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let n = values.len() as f64;
    // Divided first: sums of finite numbers may overflow, their mean cannot.
    let mean = values.iter().map(|value| value / n).sum::<f64>();
    let scatter = values.iter().map(|value| (value - mean).powi(2));
    Some((mean, (scatter.sum::<f64>() / (n - 1.0) / n).sqrt()))
}
