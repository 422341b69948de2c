//! Which fault hurts which controller most.
//!
//! Strata are independent samples, so what a fault does is the difference between its stratum and a reference: the
//! stratum without faults where there is one. Which stratum is the worst is told by comparing it with all others (Hsu
//! 1981, Annals of Statistics 9:1026-1034): one is ruled out if another is worse by a one-sided interval at 1 - 5 % /
//! (k - 1), of k strata. The stratum that is truly the worst meets k - 1 others, so it is ruled out with a probability
//! of 5 % at most, whichever it is.

use super::scores::Scores;
use super::strata::{Subset, parts};
use super::summary::FailureRate;
use super::team::TeamNumbers;
use crate::campaign::{Campaign, ChannelsOfCampaign, StratumFaults};
use crate::statistics::{
    Estimate, LEVEL, independent_difference, quantile, quantile_interval, wilson,
};
use serde::Serialize;
use std::sync::Arc;

/// What the strata with certain faults do to a controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Screening {
    /// The controller.
    pub controller: String,
    /// The stratum that the others are compared with.
    pub reference: Arc<str>,
    /// The other strata with certain faults, in the campaign's order.
    #[serde(rename = "strata")]
    pub harms: Vec<FaultEffect>,
    /// The strata (of `harms`, by index) that cannot be told apart, at 95 %, from the one that fails most often, which
    /// is the first.
    #[serde(skip)]
    pub most_failures: Vec<usize>,
    /// The same for the growth of the errors, by channel group.
    #[serde(skip)]
    pub most_growth: Vec<Vec<usize>>,
}

/// What a stratum does to a controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultEffect {
    /// The stratum.
    pub stratum: Arc<str>,
    /// How often the controller fails there.
    #[serde(skip)]
    pub rate: FailureRate,
    /// Failure rate minus that of the reference (Newcombe 1998, Statistics in Medicine 17:873-890, method 10).
    #[serde(rename = "failure_rate_difference")]
    pub failures: Option<Estimate>,
    /// Whether it may be the stratum in which the controller fails most often.
    pub may_fail_most: bool,
    /// By channel group.
    pub growth: Vec<Growth>,
}

/// What a stratum does to the errors of a controller on a channel group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// The channel group.
    pub group: Arc<str>,
    /// Logarithm of the median RMS error minus that of the reference.
    pub log_growth: Option<Estimate>,
    /// Whether it may be the stratum in which these errors grow most.
    pub may_grow_most: bool,
}

/// What each stratum with certain faults does to each controller; nothing unless there are two strata to compare.
#[must_use]
pub fn screen(campaign: &Campaign, scores: &Scores) -> Vec<Screening> {
    let parts = parts(campaign, scores);
    let certain: Vec<(&Subset, bool)> = campaign
        .strata
        .all()
        .iter()
        .zip(parts.get(1..).unwrap_or_default())
        .filter_map(|(stratum, part)| match &stratum.faults {
            StratumFaults::Certain(faults) => Some((part, faults.is_empty())),
            StratumFaults::ByProbability => None,
        })
        .collect();
    if certain.len() < 2 {
        return Vec::new();
    }
    let of_controller = |controller| screen_controller(campaign, scores, controller, &certain);
    (0..campaign.controllers.len()).map(of_controller).collect()
}

fn screen_controller(
    campaign: &Campaign,
    scores: &Scores,
    controller: usize,
    certain: &[(&Subset, bool)],
) -> Screening {
    let rates: Vec<FailureRate> = certain
        .iter()
        .map(|(part, _)| FailureRate::of(campaign, scores, controller, part))
        .collect();
    // Without a stratum that has no faults, the one that the controller bears best, so far as is known.
    let least = || {
        let rate = |&k: &usize| rates[k].rate();
        (0..rates.len()).min_by(|a, b| rate(a).total_cmp(&rate(b)))
    };
    let fault_free = certain.iter().position(|(_, fault_free)| *fault_free);
    let reference = fault_free.or_else(least).unwrap_or(0);
    let others: Vec<usize> = (0..certain.len()).filter(|&k| k != reference).collect();

    let share = |k: usize, level: f64| {
        let rate = &rates[k];
        (rate.n > 0 && campaign.is_random()).then(|| Estimate {
            value: rate.rate(),
            interval: wilson(rate.failed(), rate.n, level),
        })
    };
    let groups = campaign.channel_groups();
    let errors: Vec<Vec<Vec<f64>>> = groups
        .iter()
        .map(|of_group| {
            let rmse = TeamNumbers::on(campaign, of_group).rmse(scores, controller);
            let of_part = |(part, _): &(&Subset, bool)| {
                let mut logs: Vec<f64> = part.episodes.iter().map(|&k| rmse[k].ln()).collect();
                logs.sort_unstable_by(f64::total_cmp);
                logs
            };
            certain.iter().map(of_part).collect()
        })
        .collect();
    let median = |group: usize, k: usize, level: f64| {
        let sorted = &errors[group][k];
        if !campaign.is_random() {
            return None;
        }
        Some(Estimate {
            value: quantile(sorted, 0.5)?,
            interval: quantile_interval(sorted, 0.5, level)?,
        })
    };
    let most_failures = worst(&others, &share);
    let most_growth: Vec<Vec<usize>> = (0..groups.len())
        .map(|group| worst(&others, &|k, level| median(group, k, level)))
        .collect();
    let growth = |place: usize, k: usize| -> Vec<Growth> {
        let of_group = |(group, own): (usize, &ChannelsOfCampaign)| Growth {
            group: own.name.clone(),
            log_growth: difference(&|k, level| median(group, k, level), k, reference, LEVEL),
            may_grow_most: most_growth[group].contains(&place),
        };
        groups.iter().enumerate().map(of_group).collect()
    };
    let harms = others.iter().enumerate().map(|(place, &k)| FaultEffect {
        stratum: certain[k].0.name.clone(),
        rate: rates[k].clone(),
        failures: difference(&share, k, reference, LEVEL),
        may_fail_most: most_failures.contains(&place),
        growth: growth(place, k),
    });
    Screening {
        controller: campaign.controllers[controller].clone(),
        reference: certain[reference].0.name.clone(),
        harms: harms.collect(),
        most_failures,
        most_growth,
    }
}

/// A quantity of the stratum `a` minus that of `b`; none where one of them has too few episodes.
fn difference(
    quantity: &dyn Fn(usize, f64) -> Option<Estimate>,
    a: usize,
    b: usize,
    level: f64,
) -> Option<Estimate> {
    independent_difference(quantity(a, level)?, quantity(b, level)?)
}

/// Places among `strata` of those that cannot be told apart from the largest, which is the first.
fn worst(strata: &[usize], quantity: &dyn Fn(usize, f64) -> Option<Estimate>) -> Vec<usize> {
    let others = strata.len().saturating_sub(1).max(1) as f64;
    // A two-sided interval of this level has a one-sided end at 1 - 5 % / (k - 1).
    let level = 1.0 - 2.0 * (1.0 - LEVEL) / others;
    let value = |&place: &usize| {
        quantity(strata[place], LEVEL).map_or(f64::NEG_INFINITY, |found| found.value)
    };
    let mut places: Vec<usize> = (0..strata.len()).collect();
    places.sort_by(|a, b| value(b).total_cmp(&value(a)));
    let ruled_out = |place: usize| {
        strata.iter().any(|&other| {
            difference(quantity, other, strata[place], level)
                .is_some_and(|difference| difference.interval.lower > 0.0)
        })
    };
    places.retain(|&place| !ruled_out(place));
    places
}
