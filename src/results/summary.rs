//! How often each controller failed, and how large its errors were.

use super::replicates::over_replicates;
use super::scores::{Scores, Status};
use super::strata::{Subset, parts, replicates};
use super::team::Layout;
use crate::agent::ChannelGroup;
use crate::campaign::Campaign;
use crate::random::{Method, allows};
use crate::statistics::{
    Interval, LEVEL, clopper_pearson_upper, quantile, quantile_interval, rms, sequential_interval,
    sequential_upper, wilson,
};
use std::sync::Arc;

/// The quantiles of the summary.
const QUANTILES: [f64; 3] = [0.5, 0.95, 0.99];

/// How the interval of a failure rate is found. The design of the draws, and who decides on the number of episodes,
/// leave one way that holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RateMethod {
    /// Wilson's score interval: of independent draws in a fixed number.
    Wilson,
    /// A confidence sequence: of independent draws in a number that `[stop]` decides.
    Sequential,
    /// Student's t over the replicates of a sampling design.
    Replicates,
}

impl RateMethod {
    /// The method of a campaign.
    #[must_use]
    pub fn of(campaign: &Campaign) -> Self {
        match (campaign.sampling.replicates(), &campaign.stop) {
            (Some(_), _) => Self::Replicates,
            (None, Some(_)) => Self::Sequential,
            (None, None) => Self::Wilson,
        }
    }

    /// The word in the names of columns and keys.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wilson => "wilson",
            Self::Sequential => "sequential",
            Self::Replicates => "replicates",
        }
    }
}

/// How often a controller failed in a stratum.
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
    /// How its interval is found.
    pub method: RateMethod,
    /// Two-sided 95 % interval of the failure rate; absent over too few replicates.
    pub interval: Option<Interval>,
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

    /// The interval, if it is found by this method.
    #[must_use]
    pub fn interval_by(&self, method: RateMethod) -> Option<Interval> {
        self.interval.filter(|_| self.method == method)
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
        let method = RateMethod::of(campaign);
        let share = |episodes: &Vec<usize>| {
            let failed = count(episodes, &[Status::Exceeded, Status::Diverged]);
            (!episodes.is_empty()).then(|| failed as f64 / episodes.len() as f64)
        };
        let over_replicates = || {
            let shares = replicates(campaign, &part.episodes);
            let shares: Option<Vec<f64>> = shares.iter().map(share).collect();
            over_replicates(&shares?).map(|found| Interval {
                lower: found.estimate.interval.lower.max(0.0),
                upper: found.estimate.interval.upper.min(1.0),
            })
        };
        Self {
            controller: campaign.controllers[controller].clone(),
            stratum: part.name.clone(),
            n,
            exceeded,
            diverged,
            method,
            interval: match method {
                RateMethod::Wilson => Some(wilson(failed, n, LEVEL)),
                RateMethod::Sequential => Some(sequential_interval(failed, n, LEVEL)),
                RateMethod::Replicates => over_replicates(),
            },
            upper_95: match method {
                RateMethod::Wilson => Some(clopper_pearson_upper(failed, n, LEVEL)),
                RateMethod::Sequential => Some(sequential_upper(failed, n, LEVEL)),
                RateMethod::Replicates => None,
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
                            _ if metric == "rmse" => rms(of_team),
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
