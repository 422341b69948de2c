//! What the scores of a run say: how each controller fared, and how each pair of them compares.
//!
//! The sample unit is the episode. Metrics are compared in the logarithm, channel by channel or averaged over the channels of
//! one unit and over the team. A diverged episode has an infinite metric; where both controllers diverge the pair is a tie.

use crate::campaign::{Campaign, ChannelGroup, Requirement};
use crate::statistics::{
    Estimate, Interval, PairedFailures, clopper_pearson_upper, mcnemar_mid_p, median_bca,
    paired_difference, quantile, quantile_interval, wilson, win_rate,
};
use crate::tables::{Scores, Status, Table};
use std::ops::Range;
use std::sync::Arc;

/// Level of every two-sided interval, and of the one-sided failure bound.
pub const LEVEL: f64 = 0.95;
/// The quantiles of the summary.
const QUANTILES: [f64; 3] = [0.5, 0.95, 0.99];

/// How often a controller failed in a stratum.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureRate {
    /// Name of the controller.
    pub controller: String,
    /// Which episodes: "all", or those with or without a fault.
    pub stratum: String,
    /// Episodes in the stratum.
    pub n: u64,
    /// Episodes that broke a limit and stayed finite.
    pub exceeded: u64,
    /// Episodes that left the numbers.
    pub diverged: u64,
    /// Wilson interval of the failure rate.
    pub wilson: Interval,
    /// One-sided Clopper-Pearson bound of the failure rate.
    pub upper_95: f64,
}

impl FailureRate {
    /// Episodes that failed either way.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.exceeded + self.diverged
    }

    /// Share of the episodes that failed; 0 of none.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.failed() as f64 / self.n.max(1) as f64
    }
}

/// Quantiles of one metric over the episodes of a stratum.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricQuantiles {
    /// Failures of the same controller in the same stratum.
    pub failures: FailureRate,
    /// "rmse" or "max_abs".
    pub metric: &'static str,
    /// "position" (m), "attitude" or "joints" (rad).
    pub group: &'static str,
    /// Each of the quantiles, with its order-statistic interval where there are episodes enough.
    pub quantiles: Vec<(f64, Option<f64>, Option<Interval>)>,
}

/// How controller `a` compares with `b` on the same episodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedComparison {
    /// First controller.
    pub a: String,
    /// Second controller.
    pub b: String,
    /// Failures of both, each, and neither.
    pub failures: PairedFailures,
    /// McNemar's mid-p of equal failure rates.
    pub mid_p: f64,
    /// Failure rate of `a` minus that of `b`.
    pub difference: Option<Estimate>,
    /// RMS errors, by channel group and by channel.
    pub ratios: Vec<Ratio>,
}

/// How much smaller the RMS error of `a` is than that of `b`.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// "group" or "channel".
    pub scope: &'static str,
    /// The channel or group.
    pub name: Arc<str>,
    /// Median over the episodes of ln(rmse of b / rmse of a), averaged over the team and over the channels of a group.
    pub log_ratio: Option<Estimate>,
    /// Share of the episodes in which `a` is better; ties count half.
    pub win_rate: Option<Estimate>,
    /// Episodes in which only `a`, only `b` and both diverged.
    pub diverged: [u64; 3],
}

/// How every controller fared, in all episodes and in those with and without each fault that only some episodes have.
#[must_use]
pub fn summarise(campaign: &Campaign, scores: &Scores) -> Vec<MetricQuantiles> {
    let strata = strata(campaign, scores);
    let mut rows = Vec::new();
    for (controller, name) in campaign.controllers.iter().enumerate() {
        for (stratum, episodes) in &strata {
            let failures = failure_rate(name, stratum, &scores.status[controller], episodes);
            for ChannelGroup { role, channels } in campaign.channel_groups() {
                for (metric, values) in [("rmse", &scores.rmse), ("max_abs", &scores.max_abs)] {
                    let layout = Layout::new(campaign, channels.clone());
                    let mut sorted: Vec<f64> = episodes
                        .iter()
                        .map(|&episode| {
                            let of_team = layout.of(&values[controller], episode);
                            match scores.status[controller][episode] {
                                Status::Diverged => f64::INFINITY,
                                _ if metric == "rmse" => root_mean_square(of_team),
                                _ => of_team.fold(0.0, f64::max),
                            }
                        })
                        .collect();
                    sorted.sort_unstable_by(f64::total_cmp);
                    let quantiles = QUANTILES
                        .map(|q| {
                            (
                                q,
                                quantile(&sorted, q),
                                quantile_interval(&sorted, q, LEVEL),
                            )
                        })
                        .to_vec();
                    rows.push(MetricQuantiles {
                        failures: failures.clone(),
                        metric,
                        group: role.name(),
                        quantiles,
                    });
                }
            }
        }
    }
    rows
}

/// Every pair of controllers, in the campaign's order.
#[must_use]
pub fn compare(campaign: &Campaign, scores: &Scores) -> Vec<PairedComparison> {
    let count = campaign.controllers.len();
    (0..count)
        .flat_map(|a| (a + 1..count).map(move |b| (a, b)))
        .map(|(a, b)| {
            let failed = |controller: usize| {
                scores.status[controller]
                    .iter()
                    .map(|status| *status != Status::Ok)
            };
            let mut failures = PairedFailures {
                both: 0,
                only_a: 0,
                only_b: 0,
                neither: 0,
            };
            for pair in failed(a).zip(failed(b)) {
                match pair {
                    (true, true) => failures.both += 1,
                    (true, false) => failures.only_a += 1,
                    (false, true) => failures.only_b += 1,
                    (false, false) => failures.neither += 1,
                }
            }
            let groups = campaign.channel_groups().into_iter();
            let groups =
                groups.map(|group| ("group", Arc::from(group.role.name()), group.channels));
            let channels = campaign.channels().iter().enumerate();
            let channels = channels.map(|(c, name)| ("channel", name.clone(), c..c + 1));
            PairedComparison {
                a: campaign.controllers[a].clone(),
                b: campaign.controllers[b].clone(),
                mid_p: mcnemar_mid_p(failures.only_a, failures.only_b),
                difference: paired_difference(&failures, LEVEL),
                failures,
                ratios: groups
                    .chain(channels)
                    .map(|(scope, name, channels)| {
                        ratio(
                            scores,
                            [a, b],
                            scope,
                            name,
                            &Layout::new(campaign, channels),
                        )
                    })
                    .collect(),
            }
        })
        .collect()
}

/// The requirements that do not hold, each with the failure rate that it is about.
#[must_use]
pub fn unmet<'a>(campaign: &'a Campaign, scores: &Scores) -> Vec<(&'a Requirement, FailureRate)> {
    let all: Vec<usize> = (0..episodes(scores)).collect();
    campaign
        .requirements
        .iter()
        .filter_map(|requirement| {
            let controller = campaign
                .controllers
                .iter()
                .position(|name| *name == requirement.controller)?;
            let rate = failure_rate(
                &requirement.controller,
                "all",
                &scores.status[controller],
                &all,
            );
            (rate.upper_95 > requirement.failure_rate_upper_95).then_some((requirement, rate))
        })
        .collect()
}

/// The summary as a table.
#[must_use]
pub fn summary_table(rows: &[MetricQuantiles]) -> Table {
    let mut table = Table::default();
    for MetricQuantiles {
        failures,
        metric,
        group,
        quantiles,
    } in rows
    {
        let mut row = table.row();
        row.name(|| "controller".into(), failures.controller.as_str().into())
            .name(|| "stratum".into(), failures.stratum.as_str().into())
            .word(|| "metric".into(), metric)
            .word(|| "group".into(), group)
            .count(|| "n".into(), failures.n)
            .count(|| "failed".into(), failures.failed())
            .count(|| "exceeded".into(), failures.exceeded)
            .count(|| "diverged".into(), failures.diverged)
            .real_if("failure_rate", (failures.n > 0).then(|| failures.rate()))
            .real(|| "failure_rate_wilson_lower".into(), failures.wilson.lower)
            .real(|| "failure_rate_wilson_upper".into(), failures.wilson.upper)
            .real(|| "failure_rate_upper_95".into(), failures.upper_95);
        for (q, value, interval) in quantiles {
            let name = format!("q{:02}", (q * 100.0).round());
            row.real_if(&name, *value)
                .real_if(
                    &format!("{name}_lower"),
                    interval.map(|interval| interval.lower),
                )
                .real_if(
                    &format!("{name}_upper"),
                    interval.map(|interval| interval.upper),
                );
        }
    }
    table
}

/// The comparisons as a table.
#[must_use]
pub fn comparison_table(comparisons: &[PairedComparison]) -> Table {
    let mut table = Table::default();
    for comparison in comparisons {
        for ratio in &comparison.ratios {
            let failures = &comparison.failures;
            let [only_a, only_b, both] = ratio.diverged;
            let mut row = table.row();
            row.name(|| "a".into(), comparison.a.as_str().into())
                .name(|| "b".into(), comparison.b.as_str().into())
                .word(|| "scope".into(), ratio.scope)
                .name(|| "name".into(), ratio.name.clone())
                .count(|| "both_failed".into(), failures.both)
                .count(|| "only_a_failed".into(), failures.only_a)
                .count(|| "only_b_failed".into(), failures.only_b)
                .count(|| "neither_failed".into(), failures.neither)
                .real(|| "mcnemar_mid_p".into(), comparison.mid_p);
            estimate(
                &mut row,
                "failure_rate_difference",
                comparison.difference,
                |difference| difference,
            );
            estimate(&mut row, "log_ratio", ratio.log_ratio, |log_ratio| {
                log_ratio
            });
            estimate(&mut row, "ratio", ratio.log_ratio, f64::exp);
            estimate(&mut row, "win_rate", ratio.win_rate, |rate| rate);
            row.count(|| "only_a_diverged".into(), only_a)
                .count(|| "only_b_diverged".into(), only_b)
                .count(|| "both_diverged".into(), both);
        }
    }
    table
}

fn estimate(
    row: &mut crate::tables::Row<'_>,
    name: &str,
    estimate: Option<Estimate>,
    scale: fn(f64) -> f64,
) {
    row.real_if(name, estimate.map(|estimate| scale(estimate.value)))
        .real_if(
            &format!("{name}_lower"),
            estimate.map(|estimate| scale(estimate.interval.lower)),
        )
        .real_if(
            &format!("{name}_upper"),
            estimate.map(|estimate| scale(estimate.interval.upper)),
        );
}

/// Where the values of some channels of a team's episode lie in a list of [`Scores`].
pub(crate) struct Layout {
    team: usize,
    /// Channels of an agent.
    width: usize,
    channels: Range<usize>,
}

impl Layout {
    pub(crate) fn new(campaign: &Campaign, channels: Range<usize>) -> Self {
        Self {
            team: campaign.team,
            width: campaign.channels().len(),
            channels,
        }
    }

    fn of<'a>(&'a self, values: &'a [f64], episode: usize) -> impl Iterator<Item = f64> + 'a {
        let width = self.width;
        (0..self.team).flat_map(move |agent| {
            let first = (episode * self.team + agent) * width;
            self.channels
                .clone()
                .map(move |channel| values[first + channel])
        })
    }
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    (sum / count).sqrt()
}

fn episodes(scores: &Scores) -> usize {
    scores.status.first().map_or(0, Vec::len)
}

fn strata(campaign: &Campaign, scores: &Scores) -> Vec<(String, Vec<usize>)> {
    let all: Vec<usize> = (0..episodes(scores)).collect();
    let mut strata = vec![("all".to_string(), all.clone())];
    for (index, (fault, occurs)) in campaign.faults.iter().zip(&scores.fault_occurs).enumerate() {
        if fault.probability < 1.0 {
            let kind = fault.kind.name();
            let (with, without) = all.iter().copied().partition(|&episode| occurs[episode]);
            strata.push((format!("with fault{index} {kind}"), with));
            strata.push((format!("without fault{index} {kind}"), without));
        }
    }
    strata
}

fn failure_rate(
    controller: &str,
    stratum: &str,
    status: &[Status],
    episodes: &[usize],
) -> FailureRate {
    let count = |wanted: Status| {
        episodes
            .iter()
            .filter(|&&episode| status[episode] == wanted)
            .count() as u64
    };
    let (n, exceeded, diverged) = (
        episodes.len() as u64,
        count(Status::Exceeded),
        count(Status::Diverged),
    );
    FailureRate {
        controller: controller.to_string(),
        stratum: stratum.to_string(),
        n,
        exceeded,
        diverged,
        wilson: wilson(exceeded + diverged, n, LEVEL),
        upper_95: clopper_pearson_upper(exceeded + diverged, n, LEVEL),
    }
}

fn ratio(
    scores: &Scores,
    [a, b]: [usize; 2],
    scope: &'static str,
    name: Arc<str>,
    layout: &Layout,
) -> Ratio {
    let log_ratios = log_ratios(scores, [a, b], layout);
    let (mut wins, mut losses, mut ties, mut diverged) = (0, 0, 0, [0; 3]);
    for (episode, &log_ratio) in log_ratios.iter().enumerate() {
        match log_ratio.total_cmp(&0.0) {
            _ if log_ratio == 0.0 => ties += 1,
            std::cmp::Ordering::Greater => wins += 1,
            std::cmp::Ordering::Less | std::cmp::Ordering::Equal => losses += 1,
        }
        let gone = |controller: usize| scores.status[controller][episode] == Status::Diverged;
        match (gone(a), gone(b)) {
            (true, false) => diverged[0] += 1,
            (false, true) => diverged[1] += 1,
            (true, true) => diverged[2] += 1,
            (false, false) => {}
        }
    }
    Ratio {
        scope,
        name,
        log_ratio: median_bca(&log_ratios, LEVEL),
        win_rate: win_rate(wins, losses, ties, LEVEL),
        diverged,
    }
}

/// ln(rmse of `b` / rmse of `a`) of each episode, averaged over the team and the channels; infinite where one of them diverged,
/// 0 where both did.
pub(crate) fn log_ratios(scores: &Scores, [a, b]: [usize; 2], layout: &Layout) -> Vec<f64> {
    let of_episode = |episode: usize| {
        let gone = |controller: usize| scores.status[controller][episode] == Status::Diverged;
        match (gone(a), gone(b)) {
            (true, true) => 0.0,
            (true, false) => f64::NEG_INFINITY,
            (false, true) => f64::INFINITY,
            (false, false) => {
                let pairs = layout
                    .of(&scores.rmse[a], episode)
                    .zip(layout.of(&scores.rmse[b], episode));
                let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (of_a, of_b)| {
                    (sum + log_ratio_of(of_a, of_b), count + 1.0)
                });
                // One perfect channel each: neither is better.
                if sum.is_nan() { 0.0 } else { sum / count }
            }
        }
    };
    (0..episodes(scores)).map(of_episode).collect()
}

/// RMS error of each episode over the team and the channels; infinite where an agent diverged.
pub(crate) fn team_rmse(scores: &Scores, controller: usize, layout: &Layout) -> Vec<f64> {
    let of_episode = |episode: usize| match scores.status[controller][episode] {
        Status::Diverged => f64::INFINITY,
        _ => root_mean_square(layout.of(&scores.rmse[controller], episode)),
    };
    (0..episodes(scores)).map(of_episode).collect()
}

/// ln(b / a).
#[expect(
    clippy::float_cmp,
    reason = "two errors of exactly zero are a tie, and so are equal ones"
)]
fn log_ratio_of(of_a: f64, of_b: f64) -> f64 {
    if of_a == of_b {
        0.0
    } else {
        (of_b / of_a).ln()
    }
}
