//! Early stop: watching a run's failures until what is to be known of them is known.
//!
//! The bounds are confidence sequences ([`crate::statistics::sequential_upper`]): they hold at all numbers of episodes
//! together, so a run may be looked at as often as one likes and end at any look. Looks are at fixed numbers of
//! episodes, so a campaign ends at the same episode whatever the batches and threads.

use crate::campaign::{Campaign, Goal, Stop};
use crate::results::scores::Status;
use crate::statistics::{Interval, Proof, sequential_lower, sequential_proof, sequential_upper};
use serde::{Deserialize, Serialize};

/// Counts the failures of a run's controller and says when enough is known.
#[derive(Debug, Clone, PartialEq)]
pub struct StoppingRule {
    stop: Option<Stop>,
    episodes: u64,
    failures: u64,
    done: bool,
}

/// What a run with `[stop]` has proved, however long it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stopped {
    /// The controller whose failures decide.
    pub controller: String,
    /// Episodes that were counted.
    pub episodes: u64,
    /// Its failures among them.
    pub failures: u64,
    /// How sure the bounds are.
    pub confidence: f64,
    /// Lower bound of its failure rate.
    pub lower: f64,
    /// Upper bound of its failure rate.
    pub upper: f64,
    /// The goal that is reached, in words; none if no goal was reached.
    pub reached: Option<String>,
}

impl Stop {
    /// The levels of the lower and of the upper bound. A single goal about one side spends all doubt on that side, all
    /// others share it; so with probability `confidence` none of the goals is ever taken to be reached wrongly.
    fn levels(&self) -> (Option<f64>, Option<f64>) {
        let shared = f64::midpoint(1.0, self.confidence);
        match self.goals.as_slice() {
            [Goal::Below(_)] => (None, Some(self.confidence)),
            [Goal::Above(_)] => (Some(self.confidence), None),
            _ => (Some(shared), Some(shared)),
        }
    }

    /// The bounds after so many failures.
    #[must_use]
    pub fn bounds(&self, failures: u64, episodes: u64) -> Interval {
        let (low, high) = self.levels();
        Interval {
            lower: low.map_or(0.0, |level| sequential_lower(failures, episodes, level)),
            upper: high.map_or(1.0, |level| sequential_upper(failures, episodes, level)),
        }
    }

    /// The first goal that is reached after so many failures.
    #[must_use]
    pub fn reached(&self, failures: u64, episodes: u64) -> Option<Goal> {
        let (low, high) = self.levels();
        // Whether a bound has passed a limit is told much faster than where it is.
        let proof = |limit: f64, level: Option<f64>| {
            level.map(|level| sequential_proof(failures, episodes, limit, level))
        };
        let holds = |goal: &&Goal| match **goal {
            Goal::Below(limit) => proof(limit, high) == Some(Proof::Below),
            Goal::Above(limit) => proof(limit, low) == Some(Proof::Above),
            Goal::HalfWidth(width) => {
                let Interval { lower, upper } = self.bounds(failures, episodes);
                upper - lower <= 2.0 * width
            }
        };
        self.goals.iter().find(holds).copied()
    }
}

impl StoppingRule {
    /// A watch over the episodes of a campaign, from the first on.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        Self {
            stop: campaign.stop.clone(),
            episodes: 0,
            failures: 0,
            done: false,
        }
    }

    /// Whether no more episodes are needed.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.done
    }

    /// Takes in how the next episode ended, by controller.
    pub fn take(&mut self, status: impl Fn(usize) -> Status) {
        let Some(stop) = &self.stop else { return };
        self.episodes += 1;
        self.failures += u64::from(status(stop.controller) != Status::Ok);
        if self.episodes.is_multiple_of(u64::from(stop.every)) {
            self.done |= stop.reached(self.failures, self.episodes).is_some();
        }
    }

    /// What is known now; none where the campaign has no `[stop]`.
    #[must_use]
    pub fn found(&self, campaign: &Campaign) -> Option<Stopped> {
        let stop = self.stop.as_ref()?;
        let bounds = stop.bounds(self.failures, self.episodes);
        let in_words = |goal: Goal| match goal {
            Goal::Below(limit) => format!("failure_rate_below = {limit}"),
            Goal::Above(limit) => format!("failure_rate_above = {limit}"),
            Goal::HalfWidth(width) => format!("half_width = {width}"),
        };
        Some(Stopped {
            controller: campaign.controllers[stop.controller].clone(),
            episodes: self.episodes,
            failures: self.failures,
            confidence: stop.confidence,
            lower: bounds.lower,
            upper: bounds.upper,
            reached: stop.reached(self.failures, self.episodes).map(in_words),
        })
    }
}
