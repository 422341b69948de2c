//! What the scores of a run say: how each controller fared, how each pair of them compares, and which fault hurts most.
//!
//! The sample unit is the episode. Metrics are compared in the logarithm, channel by channel or averaged over the channels of
//! one unit and over the team. A diverged episode has an infinite metric; where both controllers diverge the pair is a tie.
//!
//! Everything is said of all episodes together, then of each stratum. What is said of all is about the campaign's own mixture;
//! that each stratum has its share exactly, and not by chance, makes its intervals cautious, if anything (Hoeffding 1956, Annals
//! of Mathematical Statistics 27:713-721). Intervals and tests that the sampling design does not allow
//! ([`crate::random::allows`]) are absent; Student's t over the design's replicates takes the place of some.

mod columns;
mod paired;
mod requirements;
mod screening;
pub mod sensitivity;
mod strata;
mod summary;
pub mod tables;
mod verdict;
mod worst_fault;

pub use columns::{comparison_table, screening_table, summary_table};
pub(crate) use paired::log_ratios;
pub use paired::{Measured, PairedComparison, Ratio, compare};
pub use requirements::{RequirementResult, requirements};
pub use screening::{FaultEffect, Screening, screen};
pub use summary::{FailureRate, MetricQuantiles, summarise};
pub use verdict::{how_sure, verdict};
pub use worst_fault::harm;

use crate::campaign::Campaign;
use crate::statistics::{Estimate, LEVEL, replicate_mean, replicate_p};
use std::ops::Range;
use tables::{Scores, Status};

/// Fewest replicates of a sampling design whose scatter gives an interval.
pub const FEWEST_REPLICATES: usize = 5;

/// What the replicates of a sampling design say of a difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicated {
    /// Mean of the replicates' estimates, with Student's t interval.
    pub estimate: Estimate,
    /// p-value of Student's t test that there is no difference.
    pub p: f64,
}

/// Student's t over the estimates of replicates; none of too few, of any that is infinite, and of replicates that are all alike:
/// such as have no failure show no scatter, and an interval of no width would claim certainty.
#[expect(clippy::float_cmp, reason = "equal estimates, of which rates have few")]
fn over_replicates(estimates: &[f64]) -> Option<Replicated> {
    let alike = estimates.windows(2).all(|pair| pair[0] == pair[1]);
    if estimates.len() < FEWEST_REPLICATES || alike {
        return None;
    }
    Some(Replicated {
        estimate: replicate_mean(estimates, LEVEL)?,
        p: replicate_p(estimates)?,
    })
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

/// RMS error of each episode over the team and the channels; infinite where an agent diverged.
pub(crate) fn team_rmse(scores: &Scores, controller: usize, layout: &Layout) -> Vec<f64> {
    let of_episode = |episode: usize| match scores.status[controller][episode] {
        Status::Diverged => f64::INFINITY,
        _ => root_mean_square(layout.of(&scores.rmse[controller], episode)),
    };
    (0..scores.episodes()).map(of_episode).collect()
}
