//! Claims about a failure rate that may be looked at after every episode.
//!
//! A fixed-size bound that is looked at again and again until it says what one hopes for is wrong
//! far more often than its level: at 95 %, looking after each of 10,000 episodes, more than a third
//! of the time. The bounds here hold at all numbers of episodes together, so a run may stop at any
//! of them, for any reason, and still state the bound it has reached.
//!
//! **Construction** (Robbins 1970, Annals of Mathematical Statistics 41:1397-1409, with the
//! mixture confined to one side). For a rate p, weigh the alternatives q < p uniformly: the mixed
//! likelihood ratio after S failures in n episodes,
//!
//! ```text
//! E(p) = 1/p * integral over q from 0 to p of  q^S (1 - q)^(n - S) / (p^S (1 - p)^(n - S))  dq
//!      = P(Bin(n + 1, p) > S) / ((n + 1) p P(Bin(n, p) = S)),
//! ```
//!
//! is a martingale of mean 1 if p is the true rate, and a supermartingale if that is higher. By
//! Ville's inequality it ever reaches 1 / (1 - level) with probability at most 1 - level. With
//! q = u p the integrand is u^S ((1 - u p) / (1 - p))^(n - S), which increases with p: the rates
//! not yet excluded are an interval from 0, and the bound is its end. The lower bound is the same
//! for survivals.
//!
//! The one-sided mixture is what makes the price of looking small where it matters, at low rates:
//! without a failure it proves 1 % at 95 % after 449 episodes (a fixed number: 299), whereas a
//! mixture over all of [0, 1] needs 984.

use super::binomial;
use super::interval::{Interval, is_level};
use super::sample_size::fewest_runs;
use super::search::bisect;

/// What a look at a running campaign has proved about its failure rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// The rate is below the limit.
    Below,
    /// The rate is above the limit.
    Above,
    /// Neither is proved yet.
    Undecided,
}

/// Upper confidence bound of a failure rate that holds at all numbers of episodes at once: with
/// probability at least `level`, the true rate is below this bound after every episode, first to
/// last (a one-sided confidence sequence). Without episodes it is 1.
pub fn sequential_upper(failures: u64, n: u64, level: f64) -> f64 {
    if failures >= n || !is_level(level) {
        return 1.0;
    }
    bisect(failures as f64 / n as f64, 1.0, |rate| {
        !is_proved_below(rate, failures, n, level)
    })
}

/// Lower confidence bound of a failure rate that holds at all numbers of episodes at once; the
/// mirror image of [`sequential_upper`]. Without episodes it is 0.
pub fn sequential_lower(failures: u64, n: u64, level: f64) -> f64 {
    if failures == 0 || !is_level(level) {
        return 0.0;
    }
    let failures = failures.min(n);
    bisect(0.0, failures as f64 / n.max(1) as f64, |rate| {
        is_proved_above(rate, failures, n, level)
    })
}

/// Two-sided confidence sequence of a failure rate: with probability at least `level` it holds the
/// true rate after every episode. Each side errs with probability (1 - level) / 2 at most.
pub fn sequential_interval(failures: u64, n: u64, level: f64) -> Interval {
    let one_sided = f64::midpoint(1.0, level);
    Interval {
        lower: sequential_lower(failures, n, one_sided),
        upper: sequential_upper(failures, n, one_sided),
    }
}

/// The smallest number of episodes in which `failures_allowed` failures prove with [`sequential_upper`] that the
/// failure rate is at most `failure_rate`: what [`runs_needed`](super::runs_needed) is for a fixed number of them.
///
/// `None` where no number of episodes up to 2^53 is enough, or for a rate or level outside (0, 1).
pub fn sequential_runs_needed(failure_rate: f64, level: f64, failures_allowed: u64) -> Option<u64> {
    if !is_level(failure_rate) || !is_level(level) {
        return None;
    }
    fewest_runs(failures_allowed, |n| {
        is_proved_below(failure_rate, failures_allowed, n, level)
    })
}

/// What `failures` in `n` episodes prove about the failure rate and `limit`, however often and at
/// whichever n it is asked: a campaign that stops at its first proof errs with probability at most
/// 1 - `level`, in either direction. Nothing is proved about a limit outside (0, 1).
pub fn sequential_proof(failures: u64, n: u64, limit: f64, level: f64) -> Proof {
    let failures = failures.min(n);
    if !is_level(level) || !is_level(limit) {
        Proof::Undecided
    } else if is_proved_below(limit, failures, n, level) {
        Proof::Below
    } else if is_proved_above(limit, failures, n, level) {
        Proof::Above
    } else {
        Proof::Undecided
    }
}

/// Up to and beyond `failures` in one episode more.
fn tail_counts(failures: u64, n: u64, rate: f64) -> binomial::Tails {
    binomial::tails(failures.saturating_add(1), n.saturating_add(1), rate)
}

/// Whether E(`rate`) reaches 1 / (1 - level).
fn is_proved_below(rate: f64, failures: u64, n: u64, level: f64) -> bool {
    let (episodes, tail) = (n as f64, tail_counts(failures, n, rate).from);
    // Nothing speaks against rates up to the observed one, where both sides may underflow.
    failures < n
        && episodes * rate > failures as f64
        && tail * (1.0 - level) >= (episodes + 1.0) * rate * binomial::pmf(failures, n, rate)
}

/// The same for survivals and 1 - `rate`.
fn is_proved_above(rate: f64, failures: u64, n: u64, level: f64) -> bool {
    let (episodes, tail) = (n as f64, tail_counts(failures, n, rate).below);
    failures > 0
        && episodes * rate < failures as f64
        && tail * (1.0 - level)
            >= (episodes + 1.0) * (1.0 - rate) * binomial::pmf(failures, n, rate)
}
