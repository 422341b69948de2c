//! Whether a campaign's `[[require]]` hold.

use super::scores::Scores;
use super::strata::parts;
use super::summary::FailureRate;
use crate::campaign::{ALL, Campaign, Requirement};
use serde::{Deserialize, Serialize};

/// What became of a `[[require]]`: the bound that was found beside the one that is required.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RequirementResult {
    /// The controller that it is about.
    pub controller: String,
    /// Which episodes: "all", or those of a stratum.
    pub stratum: String,
    /// The required bound: `failure_rate_upper_95`.
    pub limit: f64,
    /// The bound of the failure rate that was found, one-sided, 95 %: Clopper-Pearson's, or that of the confidence
    /// sequence where the campaign has a `[stop]`.
    pub upper_95: f64,
    /// Episodes of the stratum.
    pub n: u64,
    /// Those among them that failed.
    pub failed: u64,
}

impl RequirementResult {
    /// Whether the required bound is proved.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.upper_95 <= self.limit
    }

    /// Share of the episodes that failed; 0 of none.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.failed as f64 / self.n.max(1) as f64
    }

    /// The controller, with the stratum if it is about one.
    #[must_use]
    pub fn subject(&self) -> String {
        if self.stratum == ALL {
            self.controller.clone()
        } else {
            format!("{} in {:?}", self.controller, self.stratum)
        }
    }
}

/// What became of each requirement, in the campaign's order.
#[must_use]
pub fn requirements(campaign: &Campaign, scores: &Scores) -> Vec<RequirementResult> {
    let parts = parts(campaign, scores);
    let result = |requirement: &Requirement| {
        let part = parts.iter().find(|part| part.name == requirement.stratum)?;
        let mut controllers = campaign.controllers.iter();
        let controller = controllers.position(|name| *name == requirement.controller)?;
        let rate = FailureRate::of(campaign, scores, controller, part);
        Some(RequirementResult {
            controller: requirement.controller.clone(),
            stratum: requirement.stratum.to_string(),
            limit: requirement.failure_rate_upper_95,
            // A campaign whose design gives no bound has no requirements.
            upper_95: rate.upper_95?,
            n: rate.n,
            failed: rate.failed(),
        })
    };
    campaign.requirements.iter().filter_map(result).collect()
}
