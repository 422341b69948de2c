//! How many runs a claim about a failure rate needs, and how likely they are to prove it.
//!
//! The claim is one-sided: "the failure rate is at most p", proved when the Clopper-Pearson upper
//! bound ([`clopper_pearson_upper`](super::clopper_pearson_upper)) is at most p. That is so when p,
//! were it the true rate, would let as few failures happen with probability at most 1 - confidence.

use super::binomial;
use super::interval::is_level;

/// Counts are exact in double precision up to here.
const MOST_RUNS: u64 = 1 << 53;

/// The smallest number of runs in which `failures_allowed` failures still prove that the failure
/// rate is at most `failure_rate`, with one-sided `confidence`.
///
/// The bound falls with every further run, so that bisection finds it exactly. Without a failure
/// it is the success-run rule: the smallest n with (1 - p)^n <= 1 - confidence, at 95 % about 3 / p
/// (the "rule of three"; -ln 0.05 = 2.996), so 299 runs for 1 %, 1109 for 0.27 %, 2995 for 0.1 %
/// and 29956 for 0.01 %.
///
/// `None` where no number of runs up to 2^53 is enough, or for a rate or confidence outside (0, 1).
pub fn runs_needed(failure_rate: f64, confidence: f64, failures_allowed: u64) -> Option<u64> {
    if !is_level(failure_rate) || !is_level(confidence) {
        return None;
    }
    fewest_runs(failures_allowed, |n| {
        proves(failures_allowed, n, failure_rate, confidence)
    })
}

/// The smallest number of runs, up to 2^53, that proves a claim with so many failures in them; each further run makes
/// the proof easier.
pub(super) fn fewest_runs(failures_allowed: u64, proves: impl Fn(u64) -> bool) -> Option<u64> {
    // As many runs as failures prove nothing.
    let mut too_few = failures_allowed;
    let mut enough = failures_allowed.checked_add(1)?;
    while !proves(enough) {
        too_few = enough;
        enough = enough.checked_mul(2).filter(|&n| n <= MOST_RUNS)?;
    }
    while enough - too_few > 1 {
        let middle = u64::midpoint(too_few, enough);
        if proves(middle) {
            enough = middle;
        } else {
            too_few = middle;
        }
    }
    Some(enough)
}

/// The largest number of failures with which `n` runs still prove that the failure rate is at most
/// `failure_rate`, with one-sided `confidence`; the counterpart of [`runs_needed`].
///
/// `None` where even a run without failures does not, or for a rate or confidence outside (0, 1).
pub fn failures_allowed(failure_rate: f64, confidence: f64, n: u64) -> Option<u64> {
    let proves = |failures: u64| proves(failures, n, failure_rate, confidence);
    if !is_level(failure_rate) || !is_level(confidence) || n > MOST_RUNS || !proves(0) {
        return None;
    }
    let (mut allowed, mut too_many) = (0, n);
    while too_many - allowed > 1 {
        let middle = u64::midpoint(allowed, too_many);
        if proves(middle) {
            allowed = middle;
        } else {
            too_many = middle;
        }
    }
    Some(allowed)
}

/// Probability that `n` runs prove a failure rate of at most `limit` with one-sided `confidence`,
/// if `true_rate` is the failure rate.
///
/// Below the limit it is the power of the campaign; at and above the limit it is the probability
/// of a false proof, at most 1 - confidence. With the number of runs it rises in saw teeth: it
/// falls from one run to the next unless a further failure becomes allowed, so that the numbers of
/// [`runs_needed`] are the ones to plan with. 0 for a rate outside [0, 1] and where `n` runs prove
/// nothing.
pub fn power(true_rate: f64, limit: f64, confidence: f64, n: u64) -> f64 {
    if !(0.0..=1.0).contains(&true_rate) {
        return 0.0;
    }
    failures_allowed(limit, confidence, n).map_or(0.0, |allowed| {
        binomial::tails(allowed + 1, n, true_rate).below
    })
}

/// Whether `failures` in `n` runs prove that the rate is at most `rate`: for `failures` below 2^53.
fn proves(failures: u64, n: u64, rate: f64, confidence: f64) -> bool {
    failures < n && binomial::tails(failures + 1, n, rate).below <= 1.0 - confidence
}
