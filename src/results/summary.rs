//! How often each controller failed, and how large its errors were.

use super::numbers::{of_episodes, sorted};
use super::replicates::over_replicates;
use super::scores::{Scores, Status};
use super::strata::{Subset, parts, replicates};
use crate::campaign::{Campaign, ChannelsOfCampaign, EpisodeNumber};
use crate::random::Method;
use crate::statistics::{
    Interval, LEVEL, clopper_pearson_upper, quantile, quantile_interval, sequential_interval,
    sequential_upper, wilson,
};
use rayon::prelude::*;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
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
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Wilson, Self::Sequential, Self::Replicates];

    /// The method of a campaign.
    #[must_use]
    pub fn of(campaign: &Campaign) -> Self {
        match (campaign.sampling.replicates(), &campaign.stop) {
            (Some(_), _) => Self::Replicates,
            (None, Some(_)) => Self::Sequential,
            (None, None) => Self::Wilson,
        }
    }

    /// What an interval of it is, in a word or two.
    #[must_use]
    pub fn short(self) -> &'static str {
        match self {
            Self::Wilson => "Wilson 95 %",
            Self::Sequential => "sequential 95 %",
            Self::Replicates => "t 95 %",
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
    /// The group of agents whose failures alone are counted; none where an episode fails with any agent.
    pub agents: Option<Arc<str>>,
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

/// What [`FailureRate`] is for programs: with the counts and rates that follow from it, and its interval under the name
/// of its method.
impl Serialize for FailureRate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("controller", &self.controller)?;
        if let Some(agents) = &self.agents {
            map.serialize_entry("agents", agents)?;
        }
        map.serialize_entry("stratum", &self.stratum)?;
        map.serialize_entry("n", &self.n)?;
        map.serialize_entry("failed", &self.failed())?;
        map.serialize_entry("exceeded", &self.exceeded)?;
        map.serialize_entry("diverged", &self.diverged)?;
        map.serialize_entry("failure_rate", &self.rate())?;
        for method in RateMethod::ALL {
            let key = format!("{}_95", method.name());
            map.serialize_entry(&key, &self.interval_by(method))?;
        }
        map.serialize_entry("upper_95", &self.upper_95)?;
        map.end()
    }
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
        Self::counted(campaign, None, &scores.status, controller, part)
    }

    /// The same of each group of agents alone, where the campaign names several.
    fn of_groups(
        campaign: &Campaign,
        scores: &Scores,
        controller: usize,
        part: &Subset,
    ) -> Vec<Self> {
        let groups = campaign.groups().iter().zip(&scores.groups);
        let named = groups.filter(|_| campaign.has_named_groups());
        let own = named.map(|(group, own)| {
            let agents = Some(group.name.clone());
            Self::counted(campaign, agents, &own.status, controller, part)
        });
        own.collect()
    }

    /// Counts failures of agents under whom the episodes ended so, `[controller][episode]`.
    fn counted(
        campaign: &Campaign,
        agents: Option<Arc<str>>,
        status: &[Vec<Status>],
        controller: usize,
        part: &Subset,
    ) -> Self {
        let status = &status[controller];
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
        let interval = match method {
            RateMethod::Wilson => Some(wilson(failed, n, LEVEL)),
            RateMethod::Sequential => Some(sequential_interval(failed, n, LEVEL)),
            RateMethod::Replicates => over_replicates(),
        };
        let upper_95 = match method {
            RateMethod::Wilson => Some(clopper_pearson_upper(failed, n, LEVEL)),
            RateMethod::Sequential => Some(sequential_upper(failed, n, LEVEL)),
            RateMethod::Replicates => None,
        };
        Self {
            controller: campaign.controllers[controller].clone(),
            agents,
            stratum: part.name.clone(),
            n,
            exceeded,
            diverged,
            method,
            interval: interval.filter(|_| campaign.is_random()),
            upper_95: upper_95.filter(|_| campaign.is_random()),
        }
    }
}

/// Quantiles of one metric over the episodes of a stratum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricQuantiles {
    /// Failures of the same controller in the same stratum.
    #[serde(flatten)]
    pub failures: FailureRate,
    /// Failures of the group's agents alone, where the campaign has several groups.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_group: Option<FailureRate>,
    /// The name of an [`EpisodeNumber`].
    pub metric: &'static str,
    /// "position" (m), "attitude" or "joints" (rad), with the name of the agents' group in front where it has one.
    pub group: Arc<str>,
    /// Each of the quantiles, with its order-statistic interval where the design allows one and there are episodes
    /// enough.
    pub quantiles: Vec<Quantile>,
}

/// A quantile of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantile {
    /// The share of the episodes that are not above it.
    pub share: f64,
    /// Its value; none of no episodes.
    pub value: Option<f64>,
    /// Its order-statistic interval.
    #[serde(rename = "interval_95")]
    pub interval: Option<Interval>,
}

/// How often every controller failed, in all episodes and in each stratum; where the campaign names several groups
/// of agents, then how often each of them did alone.
#[must_use]
pub fn failure_rates(campaign: &Campaign, scores: &Scores) -> Vec<FailureRate> {
    let parts = parts(campaign, scores);
    let controllers = 0..campaign.controllers.len();
    let of_part = |(controller, part)| {
        let all = FailureRate::of(campaign, scores, controller, part);
        let groups = FailureRate::of_groups(campaign, scores, controller, part);
        std::iter::once(all).chain(groups).collect::<Vec<_>>()
    };
    controllers
        .flat_map(|controller| parts.iter().map(move |part| (controller, part)))
        .flat_map(of_part)
        .collect()
}

/// How every controller fared, in all episodes and in each stratum.
#[must_use]
pub fn summarise(campaign: &Campaign, scores: &Scores) -> Vec<MetricQuantiles> {
    let parts = parts(campaign, scores);
    let intervals = campaign.allows(Method::Quantile);
    let groups = campaign.channel_groups();
    let of_controller = |controller: usize| {
        let mut rows = Vec::new();
        let numbers_of = |of: &ChannelsOfCampaign| {
            let all = EpisodeNumber::ALL.iter();
            let of_number = |&number| {
                let values = of_episodes(campaign, scores, controller, number, of);
                (number, values)
            };
            all.map(of_number).collect::<Vec<_>>()
        };
        let numbers: Vec<_> = groups.iter().map(numbers_of).collect();
        for part in &parts {
            let failures = FailureRate::of(campaign, scores, controller, part);
            let of_groups = FailureRate::of_groups(campaign, scores, controller, part);
            for (channels, numbers) in groups.iter().zip(&numbers) {
                for (number, values) in numbers {
                    let sorted = sorted(values, part.episodes.iter().copied());
                    let of_share = |q| {
                        let interval = quantile_interval(&sorted, q, LEVEL);
                        Quantile {
                            share: q,
                            value: quantile(&sorted, q),
                            interval: interval.filter(|_| intervals),
                        }
                    };
                    rows.push(MetricQuantiles {
                        failures: failures.clone(),
                        of_group: of_groups.get(channels.group).cloned(),
                        metric: number.name(),
                        group: channels.name.clone(),
                        quantiles: QUANTILES.map(of_share).to_vec(),
                    });
                }
            }
        }
        rows
    };
    let controllers = (0..campaign.controllers.len()).into_par_iter();
    controllers.flat_map_iter(of_controller).collect()
}
