//! Intervals of one failure rate.

use super::binomial;
use super::interval::{Interval, is_level};
use super::normal::two_sided_z;
use super::search::bisect;

const UNKNOWN: Interval = Interval {
    lower: 0.0,
    upper: 1.0,
};

/// Two-sided Wilson score interval of a failure rate (Wilson 1927, JASA 22:209-212).
///
/// Its coverage is `level` on average over the rates, and may fall short of it at a given rate;
/// use [`clopper_pearson_upper`] for a claim. Without episodes it is [0, 1].
pub fn wilson(failures: u64, n: u64, level: f64) -> Interval {
    if n == 0 || !is_level(level) {
        return UNKNOWN;
    }
    let (failures, survivals) = split(failures, n);
    let n = failures + survivals;
    let z = two_sided_z(level);
    let centre = failures + z * z / 2.0;
    let half_width = z * (failures * survivals / n + z * z / 4.0).sqrt();
    // The ends are exact at 0 and n, where rounding would leave them a last bit away.
    Interval {
        lower: if failures > 0.0 {
            (centre - half_width) / (n + z * z)
        } else {
            0.0
        },
        upper: if survivals > 0.0 {
            (centre + half_width) / (n + z * z)
        } else {
            1.0
        },
    }
}

/// Exact one-sided upper confidence bound of a failure rate (Clopper and Pearson 1934, Biometrika
/// 26:404-413): the true rate is at most this with confidence at least `level`.
///
/// Without a failure it is 1 - (1 - level)^(1/n); without episodes it is 1.
pub fn clopper_pearson_upper(failures: u64, n: u64, level: f64) -> f64 {
    if failures >= n || !is_level(level) {
        return 1.0;
    }
    bisect(0.0, 1.0, |rate| {
        binomial::tails(failures + 1, n, rate).below > 1.0 - level
    })
}

/// Exact two-sided (equal-tailed) Clopper-Pearson interval of a failure rate; covers it with
/// probability at least `level` whatever the rate. Without episodes it is [0, 1].
pub fn clopper_pearson(failures: u64, n: u64, level: f64) -> Interval {
    if n == 0 || !is_level(level) {
        return UNKNOWN;
    }
    let failures = failures.min(n);
    let one_sided = f64::midpoint(1.0, level);
    Interval {
        lower: lower_bound(failures, n, one_sided),
        upper: clopper_pearson_upper(failures, n, one_sided),
    }
}

fn lower_bound(failures: u64, n: u64, level: f64) -> f64 {
    if failures == 0 {
        return 0.0;
    }
    bisect(0.0, 1.0, |rate| {
        binomial::tails(failures, n, rate).from < 1.0 - level
    })
}

fn split(failures: u64, n: u64) -> (f64, f64) {
    let failures = failures.min(n);
    (failures as f64, (n - failures) as f64)
}
