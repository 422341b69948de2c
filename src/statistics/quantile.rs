//! Quantiles of a metric as order statistics.

use super::binomial;
use super::interval::{Interval, is_level};
use super::search::first_rank;

/// The `q`-quantile of ascending values: the smallest value with at least the share `q` of all
/// values at or below it (type 1 of Hyndman and Fan 1996; `inverted_cdf` in NumPy).
///
/// It is the metric of one episode, so that this episode can be replayed, and it never mixes a
/// finite value with the `+inf` of a diverged one. `None` for no values, values that are not
/// ascending or hold NaN, or `q` outside [0, 1]; `q` = 0 is the smallest value.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    if !is_ascending(sorted) || !(0.0..=1.0).contains(&q) {
        return None;
    }
    let n = sorted.len();
    // Comparing k/n with q, and not k with q n, is exact for decimal q such as 0.07.
    let rank = first_rank(n, |k| k as f64 / n as f64 >= q)?;
    Some(sorted[rank - 1])
}

/// Distribution-free confidence interval of the `q`-quantile of the population that the ascending
/// values were drawn from (David and Nagaraja 2003, Order Statistics, section 7.1).
///
/// The number of values at or below the true quantile is binomial (n, q); each end is the order
/// statistic nearest the middle that the quantile passes with probability at most
/// (1 - level) / 2. Hence the coverage is at least `level`, for values with ties too, and each end
/// is a one-sided bound with confidence (1 + level) / 2. An end is infinite where it falls on a
/// diverged episode.
///
/// `None` if there are too few values for such ranks to exist (at 95 %: fewer than 6 for the
/// median, 72 for q = 0.95, 368 for q = 0.99), or on the conditions of [`quantile()`].
pub fn quantile_interval(sorted: &[f64], q: f64, level: f64) -> Option<Interval> {
    if !is_level(level) {
        return None;
    }
    let one_sided = f64::midpoint(1.0, level);
    Some(Interval {
        lower: quantile_lower(sorted, q, one_sided)?,
        upper: quantile_upper(sorted, q, one_sided)?,
    })
}

/// One-sided lower bound of the `q`-quantile, with confidence at least `level`: the lower end of
/// [`quantile_interval`], which has half of the rest. `None` as there: at 95 % for fewer than 5 values
/// for the median.
pub fn quantile_lower(sorted: &[f64], q: f64, level: f64) -> Option<f64> {
    if !is_ascending(sorted) || !(0.0..=1.0).contains(&q) || !is_level(level) {
        return None;
    }
    let n = sorted.len();
    let below = |rank: usize| binomial::tails(rank as u64, n as u64, q).below;
    // The last rank that the quantile stays below rarely enough.
    let above_lower = first_rank(n, |rank| below(rank) > 1.0 - level)?;
    Some(sorted[above_lower.checked_sub(2)?])
}

/// One-sided upper bound of the `q`-quantile, with confidence at least `level`. `None` as in
/// [`quantile_lower`]: at 95 % for fewer than 59 values for q = 0.95, 299 for q = 0.99.
pub fn quantile_upper(sorted: &[f64], q: f64, level: f64) -> Option<f64> {
    if !is_ascending(sorted) || !(0.0..=1.0).contains(&q) || !is_level(level) {
        return None;
    }
    let n = sorted.len();
    let from = |rank: usize| binomial::tails(rank as u64, n as u64, q).from;
    let upper = first_rank(n, |rank| from(rank) <= 1.0 - level)?;
    Some(sorted[upper - 1])
}

fn is_ascending(values: &[f64]) -> bool {
    // `is_sorted` finds NaN between two values; the last one covers a lone NaN.
    values.is_sorted() && values.last().is_some_and(|value| !value.is_nan())
}
