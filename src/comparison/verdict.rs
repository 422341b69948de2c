//! Who does better, in a sentence for each opponent of the first controller.

use super::paired::{Measured, PairedComparison, Ratio};
use super::rates::MetricQuantiles;
use crate::campaign::ALL;
use crate::statistics::Interval;

/// What an interval says about the first of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Better,
    Worse,
    Unsure,
}

/// How the campaign's first controller fares against each of the others, over all episodes, each in a sentence; how often it
/// fails if it is the only one. "Better" and "worse" are said where a 95 % interval leaves no doubt, and each sentence has the
/// numbers that it stands on.
#[must_use]
pub fn verdict(summary: &[MetricQuantiles], comparisons: &[PairedComparison]) -> Vec<String> {
    let first = comparisons.first().map(|own| &own.a);
    let of_first = comparisons
        .iter()
        .filter(|own| Some(&own.a) == first && *own.stratum == *ALL);
    match first {
        Some(_) => of_first.map(of_pair).collect(),
        None => summary.first().map(of_one).into_iter().collect(),
    }
}

fn of_one(row: &MetricQuantiles) -> String {
    let rate = &row.failures;
    let (name, failed, n) = (&rate.controller, rate.failed(), rate.n);
    let known = match (rate.upper_95, rate.interval()) {
        (Some(upper), _) => format!("its failure rate is below {:.2} %", 100.0 * upper),
        (None, Some(Interval { lower, upper })) => format!(
            "its failure rate is between {:.2} and {:.2} %",
            100.0 * lower,
            100.0 * upper
        ),
        (None, None) => "these episodes give no bound of its failure rate".to_string(),
    };
    format!("{name} fails in {failed} of {n} episodes: {known}")
}

fn of_pair(pair: &PairedComparison) -> String {
    let failures = &pair.failures;
    let n = failures.both + failures.only_a + failures.only_b + failures.neither;
    let groups: Vec<&Ratio> = pair
        .ratios
        .iter()
        .filter(|ratio| ratio.scope == "group")
        .collect();
    if n == 1 {
        return of_one_episode(pair, &groups);
    }
    let (by_failures, failing) = failing(pair, n);
    let (sides, errors): (Vec<Option<Side>>, Vec<String>) =
        groups.iter().map(|group| error_of(group)).unzip();
    let errors = match sides.iter().all(|own| *own == Some(Side::Unsure)) {
        true => "not clearly different".to_string(),
        false => errors.join(" and "),
    };
    let any = |wanted| by_failures == wanted || sides.contains(&Some(wanted));
    let all = |wanted| sides.iter().all(|own| *own == Some(wanted));
    let (a, b) = (&pair.a, &pair.b);
    let opening = match (any(Side::Better), any(Side::Worse)) {
        (true, false) => format!("{a} does better than {b}"),
        (false, true) => format!("{a} does worse than {b}"),
        (true, true) if by_failures == Side::Worse && all(Side::Better) => {
            format!("{a} follows more closely than {b}, but fails more often")
        }
        (true, true) if by_failures == Side::Better && all(Side::Worse) => {
            format!("{a} fails less often than {b}, but follows less closely")
        }
        (true, true) => format!("{a} is in part better and in part worse than {b}"),
        (false, false) => format!("{n} episodes do not tell {a} and {b} apart"),
    };
    format!("{opening}: {failing}; in the median its RMS error is {errors}")
}

/// What a single episode shows.
fn of_one_episode(pair: &PairedComparison, groups: &[&Ratio]) -> String {
    let (a, b, failures) = (&pair.a, &pair.b, &pair.failures);
    let failing = match (failures.both, failures.only_a, failures.only_b) {
        (0, 0, 0) => "neither fails".to_string(),
        (0, 0, _) => format!("{b} fails"),
        (0, _, _) => format!("{a} fails"),
        _ => "both fail".to_string(),
    };
    let error = |group: &&Ratio| {
        let found = group.log_ratio?;
        Some(format!("{} in {}", times(found.value, None), group.name))
    };
    let errors: Vec<String> = groups.iter().filter_map(error).collect();
    format!(
        "{a} against {b} in this one episode, which tells nothing of others: {failing}; the RMS error of {a} is {}",
        errors.join(" and ")
    )
}

/// Whether `a` fails less often.
fn failing(pair: &PairedComparison, n: u64) -> (Side, String) {
    let failures = &pair.failures;
    let of_a = failures.both + failures.only_a;
    let of_b = failures.both + failures.only_b;
    if of_a + of_b == 0 {
        return (Side::Unsure, "neither fails".to_string());
    }
    if failures.both == n {
        return (Side::Unsure, "both fail in every episode".to_string());
    }
    let percent = |count: u64| 100.0 * count as f64 / n.max(1) as f64;
    let rates = format!(
        "it fails in {:.1} % of the episodes, the other in {:.1} %",
        percent(of_a),
        percent(of_b)
    );
    let interval = pair.difference.and_then(|found| found.interval);
    // Fewer failures are better.
    let side = interval.map_or(Side::Unsure, |own| side(-own.upper, -own.lower));
    let value = percent(of_a) - percent(of_b);
    let points = match interval {
        Some(Interval { lower, upper }) => format!(
            " ({value:+.1} points [{:+.1}, {:+.1}])",
            100.0 * lower,
            100.0 * upper
        ),
        None => format!(" ({value:+.1} points, no interval)"),
    };
    let unclear = match (side, interval) {
        (Side::Unsure, Some(_)) => ", no clear difference",
        _ => "",
    };
    (side, format!("{rates}{points}{unclear}"))
}

/// Whether the errors of `a` are smaller on a group of channels; none where no interval tells.
fn error_of(ratio: &Ratio) -> (Option<Side>, String) {
    let name = &ratio.name;
    let found = ratio
        .over_replicates
        .map(|found| Measured {
            value: found.value,
            interval: Some(found.interval),
        })
        .or(ratio.log_ratio);
    let interval = found.and_then(|found| found.interval);
    let side = interval.map(|own| side(own.lower, own.upper));
    let words = match (side, found) {
        (_, None) => format!("unknown in {name}"),
        (None, Some(found)) => format!("{} in {name} (no interval)", times(found.value, None)),
        (Some(Side::Unsure), _) => format!("not clearly different in {name}"),
        (Some(_), Some(found)) => format!("{} in {name}", times(found.value, interval)),
    };
    (side, words)
}

/// What an interval of "how much better" says.
fn side(lower: f64, upper: f64) -> Side {
    if lower > 0.0 {
        Side::Better
    } else if upper < 0.0 {
        Side::Worse
    } else {
        Side::Unsure
    }
}

/// A logarithm of a ratio as "3.1 times smaller [2.9, 3.3]": of what is larger as a number above 1, too.
fn times(log_ratio: f64, interval: Option<Interval>) -> String {
    let (sign, word) = if log_ratio < 0.0 {
        (-1.0, "larger")
    } else {
        (1.0, "smaller")
    };
    let number = |log_ratio: f64| {
        let ratio = (sign * log_ratio).exp();
        if ratio >= 9.995 && ratio.is_finite() {
            format!("{ratio:.1}")
        } else if ratio.is_finite() {
            format!("{ratio:.2}")
        } else {
            "inf".to_string()
        }
    };
    let ends = interval.map_or(String::new(), |Interval { lower, upper }| {
        let (low, high) = if sign < 0.0 {
            (upper, lower)
        } else {
            (lower, upper)
        };
        format!(" [{}, {}]", number(low), number(high))
    });
    if log_ratio == 0.0 || interval.is_none() && number(log_ratio) == "1.00" {
        "as large".to_string()
    } else if log_ratio.is_infinite() {
        format!("{word} beyond measure{ends}, as a diverged flight counts,")
    } else {
        format!("{} times {word}{ends}", number(log_ratio))
    }
}
