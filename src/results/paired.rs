//! How pairs of controllers compare on the same episodes.

use super::replicates::{Replicated, over_replicates};
use super::scores::{Scores, Status};
use super::strata::{Subset, parts, replicates};
use super::team::TeamNumbers;
use crate::campaign::Campaign;
use crate::random::Method;
use crate::statistics::{
    Estimate, Interval, LEVEL, PairedFailures, holm, mcnemar_mid_p, median_bca, paired_difference,
    win_rate,
};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// An estimate, with its interval where the sampling design allows one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// Point estimate.
    pub value: f64,
    /// 95 % interval.
    #[serde(rename = "interval_95")]
    pub interval: Option<Interval>,
}

/// How controller `a` compares with `b` on the same episodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairedComparison {
    /// First controller.
    pub a: String,
    /// Second controller.
    pub b: String,
    /// Which episodes: "all", those of a stratum, or those with or without a fault.
    pub stratum: Arc<str>,
    /// Failures of both, each, and neither.
    #[serde(flatten)]
    pub failures: PairedFailures,
    /// McNemar's mid-p of equal failure rates, of independent draws.
    #[serde(rename = "mcnemar_mid_p")]
    pub mid_p: Option<f64>,
    /// The same after Holm's correction for its family: all pairs of controllers in all strata.
    #[serde(rename = "mcnemar_mid_p_holm")]
    pub p_holm: Option<f64>,
    /// Failure rate of `a` minus that of `b`.
    #[serde(rename = "failure_rate_difference")]
    pub difference: Option<Measured>,
    /// Student's t of that difference over the replicates of a sampling design, if there are enough of them.
    #[serde(rename = "failure_rate_difference_replicates")]
    pub over_replicates: Option<Replicated>,
    /// RMS errors, by channel group and by channel.
    #[serde(rename = "log_ratios")]
    pub ratios: Vec<Ratio>,
}

/// How much smaller the RMS error of `a` is than that of `b`. The RMS error of an episode is that of the summary: over
/// the team and the channels of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ratio {
    /// "group" or "channel".
    pub scope: &'static str,
    /// The channel or group.
    pub name: Arc<str>,
    /// Median over the episodes of ln(rmse of b / rmse of a).
    pub log_ratio: Option<Measured>,
    /// Student's t of that median over the replicates of a sampling design, if there are enough of them: the value is
    /// the mean of their medians.
    #[serde(rename = "log_ratio_replicates")]
    pub over_replicates: Option<Replicated>,
    /// Mid-p of the sign test of that median, of independent draws.
    #[serde(rename = "sign_mid_p")]
    pub sign_p: Option<f64>,
    /// Share of the episodes in which `a` is better; ties count half.
    pub win_rate: Option<Measured>,
    /// Episodes in which only `a`, only `b` and both diverged.
    #[serde(rename = "diverged_only_a_only_b_both")]
    pub diverged: [u64; 3],
}

impl PairedComparison {
    /// The difference of the failure rates with the interval that the sampling design allows: over its replicates where
    /// it has them.
    #[must_use]
    pub fn known(&self) -> Option<Measured> {
        known(self.difference, self.over_replicates)
    }

    /// p-value of equal failure rates, by the test that the sampling design allows.
    #[must_use]
    pub fn p(&self) -> Option<f64> {
        self.mid_p.or(self.over_replicates.map(|found| found.p))
    }
}

impl Ratio {
    /// The log-ratio with the interval that the sampling design allows: over its replicates where it has them.
    #[must_use]
    pub fn known(&self) -> Option<Measured> {
        known(self.log_ratio, self.over_replicates)
    }

    /// p-value of equal errors, by the test that the sampling design allows.
    #[must_use]
    pub fn p(&self) -> Option<f64> {
        self.sign_p.or(self.over_replicates.map(|found| found.p))
    }
}

/// Every pair of controllers, in the campaign's order: in all episodes, then in each stratum.
#[must_use]
pub fn compare(campaign: &Campaign, scores: &Scores) -> Vec<PairedComparison> {
    let count = campaign.controllers.len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    compare_pairs(campaign, scores, pairs)
}

/// Some pairs of controllers, `[first, second]`, in this order: in all episodes, then in each stratum.
#[must_use]
pub fn compare_pairs(
    campaign: &Campaign,
    scores: &Scores,
    pairs: impl IntoIterator<Item = [usize; 2]>,
) -> Vec<PairedComparison> {
    let parts = parts(campaign, scores);
    let pairs: Vec<[usize; 2]> = pairs.into_iter().collect();
    let mut comparisons: Vec<PairedComparison> = pairs
        .into_par_iter()
        .flat_map_iter(|pair| compare_pair(campaign, scores, pair, &parts))
        .collect();
    let p_values: Option<Vec<f64>> = comparisons.iter().map(|own| own.mid_p).collect();
    let adjusted = holm(&p_values.unwrap_or_default());
    for (comparison, p_holm) in comparisons.iter_mut().zip(adjusted) {
        comparison.p_holm = Some(p_holm);
    }
    comparisons
}

fn compare_pair(
    campaign: &Campaign,
    scores: &Scores,
    [a, b]: [usize; 2],
    parts: &[Subset],
) -> Vec<PairedComparison> {
    let series = TeamNumbers::all(campaign).into_iter();
    let series = series.map(|(name, numbers)| Series {
        scope: numbers.scope(),
        name,
        log_ratios: log_ratios(campaign, scores, [a, b], &numbers),
        status: &numbers.scores(scores).status,
    });
    let series: Vec<Series<'_>> = series.collect();
    let paired = campaign.allows(Method::Paired);
    let of_part = |part: &Subset| {
        let failures = paired_failures(scores, [a, b], &part.episodes);
        let difference = |episodes: &Vec<usize>| {
            let failures = paired_failures(scores, [a, b], episodes);
            Some(paired_difference(&failures, LEVEL)?.value)
        };
        let of_replicates = replicates(campaign, &part.episodes);
        let differences: Option<Vec<f64>> = of_replicates.iter().map(difference).collect();
        PairedComparison {
            a: campaign.controllers[a].clone(),
            b: campaign.controllers[b].clone(),
            stratum: part.name.clone(),
            mid_p: paired.then(|| mcnemar_mid_p(failures.only_a, failures.only_b)),
            p_holm: None,
            difference: paired_difference(&failures, LEVEL).map(|found| measured(found, paired)),
            over_replicates: differences.and_then(|own| over_replicates(&own)),
            failures,
            ratios: series
                .iter()
                .map(|series| ratio(campaign, [a, b], part, series))
                .collect(),
        }
    };
    parts.iter().map(of_part).collect()
}

fn known(
    measured_at_once: Option<Measured>,
    over_replicates: Option<Replicated>,
) -> Option<Measured> {
    let over_replicates = over_replicates.map(|found| measured(found.estimate, true));
    over_replicates.or(measured_at_once)
}

fn measured(estimate: Estimate, with_interval: bool) -> Measured {
    Measured {
        value: estimate.value,
        interval: with_interval.then_some(estimate.interval),
    }
}

fn paired_failures(scores: &Scores, [a, b]: [usize; 2], episodes: &[usize]) -> PairedFailures {
    let mut failures = PairedFailures {
        both: 0,
        only_a: 0,
        only_b: 0,
        neither: 0,
    };
    let failed =
        |controller: usize, episode: usize| scores.status[controller][episode] != Status::Ok;
    for &episode in episodes {
        match (failed(a, episode), failed(b, episode)) {
            (true, true) => failures.both += 1,
            (true, false) => failures.only_a += 1,
            (false, true) => failures.only_b += 1,
            (false, false) => failures.neither += 1,
        }
    }
    failures
}

/// The log-ratios of a pair on some channels, `[episode]`.
struct Series<'a> {
    scope: &'static str,
    name: Arc<str>,
    log_ratios: Vec<f64>,
    /// How the episodes ended for the agents whose channels they are, `[controller][episode]`.
    status: &'a [Vec<Status>],
}

fn ratio(campaign: &Campaign, [a, b]: [usize; 2], part: &Subset, series: &Series<'_>) -> Ratio {
    let Series {
        scope,
        name,
        log_ratios,
        status,
    } = series;
    let (mut wins, mut losses, mut ties, mut diverged) = (0, 0, 0, [0; 3]);
    for &episode in &part.episodes {
        let log_ratio = log_ratios[episode];
        match log_ratio.total_cmp(&0.0) {
            _ if log_ratio == 0.0 => ties += 1,
            std::cmp::Ordering::Greater => wins += 1,
            std::cmp::Ordering::Less | std::cmp::Ordering::Equal => losses += 1,
        }
        let gone = |controller: usize| status[controller][episode] == Status::Diverged;
        match (gone(a), gone(b)) {
            (true, false) => diverged[0] += 1,
            (false, true) => diverged[1] += 1,
            (true, true) => diverged[2] += 1,
            (false, false) => {}
        }
    }
    let of = |episodes: &[usize]| {
        episodes
            .iter()
            .map(|&k| log_ratios[k])
            .collect::<Vec<f64>>()
    };
    let median = |values: &[f64]| median_bca(values, LEVEL);
    let medians: Option<Vec<f64>> = replicates(campaign, &part.episodes)
        .iter()
        .map(|episodes| median(&of(episodes)).map(|median| median.value))
        .collect();
    Ratio {
        scope,
        name: name.clone(),
        log_ratio: median(&of(&part.episodes))
            .map(|found| measured(found, campaign.allows(Method::Quantile))),
        over_replicates: medians.and_then(|medians| over_replicates(&medians)),
        sign_p: campaign
            .allows(Method::Paired)
            .then(|| mcnemar_mid_p(wins, losses)),
        win_rate: win_rate(wins, losses, ties, LEVEL)
            .map(|found| measured(found, campaign.allows(Method::Paired))),
        diverged,
    }
}

/// ln(rmse of `b` / rmse of `a`) of each episode; infinite where one of them diverged, 0 where both did. Errors that
/// are rounding are taken for equal.
pub(super) fn log_ratios(
    campaign: &Campaign,
    scores: &Scores,
    [a, b]: [usize; 2],
    numbers: &TeamNumbers,
) -> Vec<f64> {
    let smallest = numbers.group(campaign).verdict.smallest_error;
    let [of_a, of_b] = [a, b].map(|controller| numbers.rmse(scores, controller));
    let of_pair = |(of_a, of_b): (f64, f64)| match of_a.is_infinite() && of_b.is_infinite() {
        true => 0.0,
        false => (of_b.max(smallest) / of_a.max(smallest)).ln(),
    };
    of_a.into_iter().zip(of_b).map(of_pair).collect()
}
