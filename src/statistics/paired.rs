//! Comparison of two controllers on the same episodes.

use super::binomial;
use super::interval::{Estimate, Interval, is_level};
use super::normal::two_sided_z;
use super::sample_size::fewest_runs;
use super::search::bisect;
use serde::Serialize;

/// Episodes by the outcome of controllers A and B, each run once on every episode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PairedFailures {
    /// Episodes in which both failed.
    #[serde(rename = "both_failed")]
    pub both: u64,
    /// Episodes in which A alone failed.
    #[serde(rename = "only_a_failed")]
    pub only_a: u64,
    /// Episodes in which B alone failed.
    #[serde(rename = "only_b_failed")]
    pub only_b: u64,
    /// Episodes in which neither failed.
    #[serde(rename = "neither_failed")]
    pub neither: u64,
}

/// Two-sided p-value of McNemar's test with the mid-p correction, for the hypothesis that A and B
/// fail equally often, from the discordant counts (Fagerland, Lydersen and Laake 2013, BMC Medical
/// Research Methodology 13:91).
///
/// Concordant episodes carry no information about it. Without discordant ones it is 1. A test at
/// 5 % that enumeration finds to keep its level while at most half of the episodes are discordant;
/// beyond that it may exceed it slightly (5.03 % at 80 to 95 % discordant, 5.7 % for 100 episodes
/// that are all discordant).
pub fn mcnemar_mid_p(only_a: u64, only_b: u64) -> f64 {
    let discordant = only_a.saturating_add(only_b);
    if discordant == 0 {
        return 1.0;
    }
    // The probability of a more extreme split plus half that of an equally extreme one, which is
    // the observed split and its mirror image, or the even split alone.
    let fewer = only_a.min(only_b);
    let more_extreme = 2.0 * binomial::tails(fewer, discordant, 0.5).below;
    let observed = binomial::pmf(fewer, discordant, 0.5);
    let equally_extreme = if only_a == only_b {
        observed
    } else {
        2.0 * observed
    };
    // Rounding may lift an even split of very many episodes above 1.
    (more_extreme + equally_extreme / 2.0).min(1.0)
}

/// Failure rate of A minus failure rate of B, with Tango's asymptotic score interval (Tango 1998,
/// Statistics in Medicine 17:891-908).
///
/// Unlike a Wald interval it has positive width and stays within [-1, 1] for every table, also
/// without discordant episodes. `None` without episodes.
pub fn paired_difference(failures: &PairedFailures, level: f64) -> Option<Estimate> {
    let concordant = failures.both.saturating_add(failures.neither);
    score_difference(failures.only_a, failures.only_b, concordant, level)
}

/// The smallest number of episodes that end alike under both controllers and prove, by one end of
/// Tango's interval, that their failure rates differ by at most `limit`, with one-sided
/// `confidence`. `None` as in [`runs_needed`](super::runs_needed).
pub fn alike_needed(limit: f64, confidence: f64) -> Option<u64> {
    if !is_level(limit) || !is_level(confidence) || confidence <= 0.5 {
        return None;
    }
    fewest_runs(0, |neither| {
        let alike = PairedFailures {
            both: 0,
            only_a: 0,
            only_b: 0,
            neither,
        };
        let found = paired_difference(&alike, 2.0 * confidence - 1.0);
        found.is_some_and(|found| found.interval.upper <= limit)
    })
}

/// Share of episodes in which A is better than B, ties counted half.
///
/// The share is (1 + d) / 2, where d is the difference of the paired shares of wins and losses, so
/// its interval is Tango's for d. Without ties that is the Wilson interval of wins / n; ties narrow
/// it as far as they reduce the variance, with no effective sample size to be chosen. `None` without
/// episodes.
pub fn win_rate(wins: u64, losses: u64, ties: u64, level: f64) -> Option<Estimate> {
    let share = |difference: f64| f64::midpoint(1.0, difference);
    let difference = score_difference(wins, losses, ties, level)?;
    Some(Estimate {
        value: share(difference.value),
        interval: Interval {
            lower: share(difference.interval.lower),
            upper: share(difference.interval.upper),
        },
    })
}

fn score_difference(plus: u64, minus: u64, neutral: u64, level: f64) -> Option<Estimate> {
    let (plus, minus) = (plus as f64, minus as f64);
    let n = plus + minus + neutral as f64;
    if n <= 0.0 {
        return None;
    }
    let interval = if is_level(level) {
        let z = two_sided_z(level);
        Interval {
            lower: score_lower_limit(plus, minus, n, z),
            upper: -score_lower_limit(minus, plus, n, z),
        }
    } else {
        Interval {
            lower: -1.0,
            upper: 1.0,
        }
    };
    Some(Estimate {
        value: (plus - minus) / n,
        interval,
    })
}

/// The smallest difference d that the score test does not reject: the root of
/// (plus - minus - n d) = z sd(d), below the estimate.
fn score_lower_limit(plus: f64, minus: f64, n: f64, z: f64) -> f64 {
    let observed = plus - minus;
    bisect(-1.0, observed / n, |difference| {
        observed - n * difference > z * score_sd(plus, minus, n, difference)
    })
}

/// Standard deviation of plus - minus if the true difference is `difference`, at the nuisance
/// parameter that is then most likely.
fn score_sd(plus: f64, minus: f64, n: f64, difference: f64) -> f64 {
    // Exchanging the controllers changes the sign of the difference and nothing else.
    let (plus, minus, d) = if difference < 0.0 {
        (minus, plus, -difference)
    } else {
        (plus, minus, difference)
    };
    // q, the probability of a minus, solves 2n q^2 + b q + c = 0 with c <= 0: the positive root,
    // in the form that does not cancel.
    let b = (2.0 * n - plus + minus) * d - plus - minus;
    let c = -minus * d * (1.0 - d);
    let root = (b * b - 8.0 * n * c).sqrt();
    let q = if b > 0.0 {
        -2.0 * c / (b + root)
    } else {
        (root - b) / (4.0 * n)
    };
    (n * (2.0 * q + d * (1.0 - d))).sqrt()
}
