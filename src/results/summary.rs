//! How often each controller failed, and how large its errors were.

use super::replicates::over_replicates;
use super::scores::{Scores, Status};
use super::strata::{Subset, parts, replicates};
use super::team::{Layout, root_mean_square};
use crate::agent::ChannelGroup;
use crate::campaign::Campaign;
use crate::random::{Method, allows};
use crate::statistics::LEVEL;
use crate::statistics::{
    Interval, clopper_pearson_upper, quantile, quantile_interval, sequential_interval,
    sequential_upper, wilson,
};
use std::sync::Arc;

/// The quantiles of the summary.
const QUANTILES: [f64; 3] = [0.5, 0.95, 0.99];

/// How often a controller failed in a stratum, with the one interval that holds: by the design of the draws and by who
/// decides on the number of episodes.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureRate {
    /// Name of the controller.
    pub controller: String,
    /// Which episodes: "all", those of a stratum, or those with or without a fault.
    pub stratum: Arc<str>,
    /// Episodes in the stratum.
    pub n: u64,
    /// Episodes that broke a limit and stayed finite.
    pub exceeded: u64,
    /// Episodes that left the numbers.
    pub diverged: u64,
    /// Wilson interval of the failure rate: of independent draws in a fixed number.
    pub wilson: Option<Interval>,
    /// Confidence sequence of the failure rate: of independent draws in a number that `[stop]` decides.
    pub sequential: Option<Interval>,
    /// Student's t over the replicates of a sampling design, if there are enough of them.
    pub replicates: Option<Interval>,
    /// One-sided 95 % bound of the failure rate, of independent draws: Clopper-Pearson's, or that of the confidence
    /// sequence.
    pub upper_95: Option<f64>,
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

    /// The two-sided 95 % interval that holds, if one does.
    #[must_use]
    pub fn interval(&self) -> Option<Interval> {
        self.wilson.or(self.sequential).or(self.replicates)
    }

    /// Counts the failures of a controller in a part of the episodes.
    pub(super) fn of(
        campaign: &Campaign,
        scores: &Scores,
        controller: usize,
        part: &Subset,
    ) -> Self {
        let status = &scores.status[controller];
        let count = |episodes: &[usize], wanted: &[Status]| {
            let of_these = |episode: &&usize| wanted.contains(&status[**episode]);
            episodes.iter().filter(of_these).count() as u64
        };
        let exceeded = count(&part.episodes, &[Status::Exceeded]);
        let diverged = count(&part.episodes, &[Status::Diverged]);
        let (n, failed) = (part.episodes.len() as u64, exceeded + diverged);
        let independent = allows(campaign.sampling.design(), Method::FailureRate);
        let (fixed, stopped) = (
            independent && campaign.stop.is_none(),
            independent && campaign.stop.is_some(),
        );
        let share = |episodes: &Vec<usize>| {
            let failed = count(episodes, &[Status::Exceeded, Status::Diverged]);
            (!episodes.is_empty()).then(|| failed as f64 / episodes.len() as f64)
        };
        let shares: Option<Vec<f64>> = replicates(campaign, &part.episodes)
            .iter()
            .map(share)
            .collect();
        let over_replicates = shares.and_then(|shares| over_replicates(&shares));
        Self {
            controller: campaign.controllers[controller].clone(),
            stratum: part.name.clone(),
            n,
            exceeded,
            diverged,
            wilson: fixed.then(|| wilson(failed, n, LEVEL)),
            sequential: stopped.then(|| sequential_interval(failed, n, LEVEL)),
            replicates: over_replicates.map(|found| Interval {
                lower: found.estimate.interval.lower.max(0.0),
                upper: found.estimate.interval.upper.min(1.0),
            }),
            upper_95: match (fixed, stopped) {
                (true, _) => Some(clopper_pearson_upper(failed, n, LEVEL)),
                (_, true) => Some(sequential_upper(failed, n, LEVEL)),
                _ => None,
            },
        }
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
    /// Each of the quantiles, with its order-statistic interval where the design allows one and there are episodes
    /// enough.
    pub quantiles: Vec<(f64, Option<f64>, Option<Interval>)>,
}

/// How every controller fared, in all episodes and in each stratum.
#[must_use]
pub fn summarise(campaign: &Campaign, scores: &Scores) -> Vec<MetricQuantiles> {
    let parts = parts(campaign, scores);
    let intervals = allows(campaign.sampling.design(), Method::Quantile);
    let mut rows = Vec::new();
    for controller in 0..campaign.controllers.len() {
        for part in &parts {
            let failures = FailureRate::of(campaign, scores, controller, part);
            for ChannelGroup { role, channels } in campaign.channel_groups() {
                let layout = Layout::new(campaign, channels);
                for (metric, values) in [("rmse", &scores.rmse), ("max_abs", &scores.max_abs)] {
                    let of_episode = |&episode: &usize| {
                        let of_team = layout.of(&values[controller], episode);
                        match scores.status[controller][episode] {
                            Status::Diverged => f64::INFINITY,
                            _ if metric == "rmse" => root_mean_square(of_team),
                            _ => of_team.fold(0.0, f64::max),
                        }
                    };
                    let mut sorted: Vec<f64> = part.episodes.iter().map(of_episode).collect();
                    sorted.sort_unstable_by(f64::total_cmp);
                    let of_share = |q| {
                        let interval = quantile_interval(&sorted, q, LEVEL);
                        (q, quantile(&sorted, q), interval.filter(|_| intervals))
                    };
                    rows.push(MetricQuantiles {
                        failures: failures.clone(),
                        metric,
                        group: role.name(),
                        quantiles: QUANTILES.map(of_share).to_vec(),
                    });
                }
            }
        }
    }
    rows
}
