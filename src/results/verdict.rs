//! Who does better, in a sentence for each opponent of the first controller.

use super::flights::Chatter;
use super::paired::{PairedComparison, Ratio};
use super::summary::MetricQuantiles;
use crate::campaign::{ALL, Campaign};
use crate::statistics::{Interval, LEVEL};
use crate::util::format::rounded_up;
use serde::Serialize;

/// What an interval says about the first of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Better,
    Worse,
    /// Surely different, but by less than counts.
    Alike,
    Unsure,
}

/// What is said of errors of which nothing is sure.
const UNCLEAR: &str = "not clearly different";

/// How sure the sentences of [`verdict`] are.
#[must_use]
pub fn how_sure(campaign: &Campaign) -> String {
    if !campaign.is_random() {
        return "nothing is random: the episodes are all the same, and no test is made".to_string();
    }
    let tests = match campaign.sampling.replicates() {
        None => "exact tests agree",
        Some(_) => "Student's t over the replicates leaves no doubt",
    };
    // By simulation, tests at 5 % of a run that ends by its own failures err in up to 7 % of the runs.
    let stop = match campaign.stop {
        Some(_) => {
            "; [stop] decides on the number of episodes by what it sees in them, which only the intervals of failure rates take \
             into account: all others may err in 7 % of the runs where they say 5 %"
        }
        None => "",
    };
    format!(
        "better and worse are said where {tests}, at 5 % for all these statements together; intervals 95 %{stop}"
    )
}

/// How the campaign's first controller fares against each of the others, over all episodes, each in a sentence, the
/// unfavourable ones first; how often it fails if it is the only one. "Better" and "worse" are said where the 95 %
/// interval and a test (McNemar's mid-p of the failures, the sign test of the errors, Student's t over the replicates
/// of a design; at 5 % over the number of all that is looked at) leave no doubt, the ratio of the errors is one that
/// counts (`verdict.smallest_ratio`), it does not chatter at its limits where the other does not, and the medians of
/// the summary do not say the contrary; each sentence has the numbers that it stands on.
#[must_use]
pub fn verdict(
    campaign: &Campaign,
    summary: &[MetricQuantiles],
    comparisons: &[PairedComparison],
    chattering: &[Chatter],
) -> Vec<String> {
    let first = comparisons.first().map(|own| &own.a);
    let of_first = comparisons
        .iter()
        .filter(|own| Some(&own.a) == first && *own.stratum == *ALL);
    let of_first: Vec<&PairedComparison> = of_first.collect();
    let chatters = chattering.iter().map(|own| own.sentence.clone());
    if of_first.is_empty() {
        return chatters.chain(summary.first().map(of_one)).collect();
    }
    let mut sentences = judged(campaign, summary, &of_first, chattering);
    sentences.sort_by_key(|(favour, _)| *favour);
    let sentences = sentences.into_iter().map(|(_, sentence)| sentence);
    chatters.chain(sentences).collect()
}

/// How the first controller of each of some comparisons fares against the second, as [`verdict`] has it.
#[must_use]
pub fn judged(
    campaign: &Campaign,
    summary: &[MetricQuantiles],
    comparisons: &[&PairedComparison],
    chattering: &[Chatter],
) -> Vec<(Favour, String)> {
    // Of each opponent, the failures and every channel group.
    let looks = comparisons.iter().map(|pair| 1 + groups(pair).count());
    let context = Context {
        campaign,
        summary,
        looks: looks.sum(),
        chattering,
    };
    comparisons
        .iter()
        .map(|pair| of_pair(pair, &context))
        .collect()
}

/// What a comparison is seen in.
struct Context<'a> {
    campaign: &'a Campaign,
    summary: &'a [MetricQuantiles],
    /// How much is looked at in all.
    looks: usize,
    /// The controllers that chatter, each with a sentence.
    chattering: &'a [Chatter],
}

impl Context<'_> {
    /// The smallest ratio that counts on a channel group.
    fn smallest(&self, name: &str) -> f64 {
        let groups = self.campaign.channel_groups();
        let of = groups.iter().find(|of| *of.name == *name);
        let group = of.map(|of| &self.campaign.groups()[of.group]);
        group.map_or(1.0, |group| group.verdict.smallest_ratio)
    }

    /// Whether a controller's commands are those of a bang-bang loop.
    fn chatters(&self, controller: &str) -> bool {
        self.chattering
            .iter()
            .any(|own| own.controller == controller)
    }

    /// The median RMS error of a controller on a channel group, over all episodes, as the summary has it.
    fn median(&self, controller: &str, name: &str) -> Option<f64> {
        let mut rows = self.summary.iter();
        let row = rows.find(|row| {
            let of = &row.failures;
            of.controller == controller
                && *of.stratum == *ALL
                && row.metric == "rmse"
                && *row.group == *name
        })?;
        // The first quantile is the median.
        row.quantiles.first()?.value
    }
}

/// What a comparison is for the first controller; what speaks against it is said first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Favour {
    /// It does worse.
    Against,
    /// It is in part better and in part worse.
    Mixed,
    /// Nothing is sure, or nothing that counts.
    Open,
    /// It does better.
    For,
}

fn of_one(row: &MetricQuantiles) -> String {
    let rate = &row.failures;
    let (name, failed, n) = (&rate.controller, rate.failed(), rate.n);
    let known = match (rate.upper_95, rate.interval) {
        // Above 50 % failures the interval is reported in place of the upper bound.
        (Some(upper), _) if 2 * failed <= n => {
            format!("is below {} %", rounded_up(100.0 * upper, 2))
        }
        (_, Some(Interval { lower, upper })) => {
            format!("is between {:.2} and {:.2} %", 100.0 * lower, 100.0 * upper)
        }
        (_, None) => "has no bound from these episodes".to_string(),
    };
    format!(
        "{name} fails in {failed} of {n} episodes: with 95 % confidence its failure rate {known}"
    )
}

fn groups(pair: &PairedComparison) -> impl Iterator<Item = &Ratio> {
    pair.ratios.iter().filter(|ratio| ratio.scope == "group")
}

fn of_pair(pair: &PairedComparison, context: &Context<'_>) -> (Favour, String) {
    let failures = &pair.failures;
    let n = failures.both + failures.only_a + failures.only_b + failures.neither;
    if n == 1 {
        return (Favour::Open, of_one_episode(pair));
    }
    let (by_failures, failing) = failing(pair, n, context.looks);
    let known = pair.known().is_some_and(|found| found.interval.is_some());
    let (sides, errors): (Vec<Option<Side>>, Vec<String>) = groups(pair)
        .map(|group| error_of(pair, group, context))
        .unzip();
    let unclear = |words: &String| words.starts_with(UNCLEAR);
    let errors = match errors.iter().all(unclear) {
        true => UNCLEAR.to_string(),
        false => errors.join(" and "),
    };
    let any = |wanted| by_failures == wanted || sides.contains(&Some(wanted));
    let all = |wanted| sides.iter().all(|own| *own == Some(wanted));
    let (a, b) = (&pair.a, &pair.b);
    let (favour, opening) = match (any(Side::Better), any(Side::Worse)) {
        (true, false) if context.chatters(a) && !context.chatters(b) => (
            Favour::Mixed,
            match by_failures {
                Side::Better => format!("{a} fails less often than {b}, but chatters"),
                _ => format!("{a} follows more closely than {b}, but chatters"),
            },
        ),
        (true, false) => (Favour::For, format!("{a} does better than {b}")),
        (false, true) => (Favour::Against, format!("{a} does worse than {b}")),
        (true, true) if by_failures == Side::Worse && all(Side::Better) => (
            Favour::Mixed,
            format!("{a} follows more closely than {b}, but fails more often"),
        ),
        (true, true) if by_failures == Side::Better && all(Side::Worse) => (
            Favour::Mixed,
            format!("{a} fails less often than {b}, but follows less closely"),
        ),
        (true, true) => (
            Favour::Mixed,
            format!("{a} is in part better and in part worse than {b}"),
        ),
        (false, false) if !known && sides.iter().all(Option::is_none) => (
            Favour::Open,
            format!("nothing here says how sure a difference between {a} and {b} is"),
        ),
        (false, false) if all(Side::Alike) && by_failures == Side::Unsure => {
            (Favour::Open, format!("{a} and {b} follow equally well"))
        }
        (false, false) => (
            Favour::Open,
            format!("{n} episodes do not tell {a} and {b} apart"),
        ),
    };
    let sentence = format!("{opening}: {failing}; in the median its RMS error is {errors}");
    (favour, sentence)
}

/// What a single episode shows.
fn of_one_episode(pair: &PairedComparison) -> String {
    let (a, b, failures) = (&pair.a, &pair.b, &pair.failures);
    let failing = match (failures.both, failures.only_a, failures.only_b) {
        (0, 0, 0) => "neither fails".to_string(),
        (0, 0, _) => format!("{b} fails"),
        (0, _, _) => format!("{a} fails"),
        _ => "both fail".to_string(),
    };
    let error = |group: &Ratio| {
        let found = group.log_ratio?;
        Some(format!("{} in {}", times(found.value, None), group.name))
    };
    let errors: Vec<String> = groups(pair).filter_map(error).collect();
    let errors = match groups(pair).any(|group| group.diverged[2] > 0) {
        true => "both diverge, so there are no errors to compare".to_string(),
        false => format!("the RMS error of {a} is {}", errors.join(" and ")),
    };
    format!(
        "{a} against {b} in this one episode, which tells nothing of others: {failing}; {errors}"
    )
}

/// Whether `a` fails less often.
fn failing(pair: &PairedComparison, n: u64, looks: usize) -> (Side, String) {
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
    let interval = pair.known().and_then(|found| found.interval);
    // Fewer failures are better.
    let side = interval.map_or(Side::Unsure, |own| {
        sure(side(-own.upper, -own.lower), pair.p(), looks)
    });
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
fn error_of(
    pair: &PairedComparison,
    ratio: &Ratio,
    context: &Context<'_>,
) -> (Option<Side>, String) {
    let name = &ratio.name;
    let Some(found) = ratio.known() else {
        return (None, format!("unknown in {name}"));
    };
    let Some(interval) = found.interval else {
        let words = format!("{} in {name} (no interval)", times(found.value, None));
        return (None, words);
    };
    let smallest = context.smallest(name);
    let side = match sure(
        side(interval.lower, interval.upper),
        ratio.p(),
        context.looks,
    ) {
        Side::Better | Side::Worse if found.value.abs() < smallest.ln() => Side::Alike,
        side => side,
    };
    let measured = times(found.value, Some(interval));
    // A ratio in the median of the pairs may contradict the medians of the two, which stand in the same report.
    let medians = [&pair.a, &pair.b].map(|own| context.median(own, name));
    let contrary = match (side, medians) {
        (Side::Better, [Some(a), Some(b)]) => (a > b).then_some("larger"),
        (Side::Worse, [Some(a), Some(b)]) => (a < b).then_some("smaller"),
        _ => None,
    };
    match (side, contrary) {
        (_, Some(contrary)) => (
            Some(Side::Unsure),
            format!("{measured} in {name}, although its own median is {contrary} than the other's"),
        ),
        (Side::Unsure, _) => (Some(side), format!("{UNCLEAR} in {name}")),
        (Side::Alike, _) => (
            Some(side),
            format!("{measured} in {name}, which is less than counts ({smallest})"),
        ),
        _ => (Some(side), format!("{measured} in {name}")),
    }
}

/// A side, if its test agrees with so many looks at the data.
fn sure(side: Side, p: Option<f64>, looks: usize) -> Side {
    match p {
        Some(p) if p * looks as f64 > 1.0 - LEVEL => Side::Unsure,
        _ => side,
    }
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
        format!("infinitely {word}{ends} (diverged episodes count as infinite),")
    } else {
        format!("{} times {word}{ends}", number(log_ratio))
    }
}
