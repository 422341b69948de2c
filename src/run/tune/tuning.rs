//! What a search found, or why it found nothing.

use super::structure::Structure;
use super::trial::Evaluation;
use super::watched::{delay_margin, peak_command};
use crate::campaign::{Campaign, CampaignError, Limit, Measure, MeasuredChannels, Tune};
use crate::controllers::{GainsError, SimulatedController};
use crate::run::error::OutputError;
use crate::simulation::SimulationError;
use thiserror::Error;

/// Why nothing was found.
#[derive(Debug, Error)]
pub enum TuneError {
    /// The campaign does not say what to search, or its settings are refused.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// No gains to begin with.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// Nothing simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// No directory to write.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// No candidate could be simulated.
    #[error("none of the {tried} candidates can fly; the last: {reason}")]
    NoneFlies {
        /// How many were tried.
        tried: usize,
        /// Why not.
        reason: String,
    },
    /// The findings cannot be encoded.
    #[error("the findings cannot be encoded")]
    Json(#[from] serde_json::Error),
}

/// What a search found.
#[derive(Debug, Clone)]
pub struct Tuning {
    /// The campaign.
    pub campaign: Campaign,
    /// What was asked for.
    pub asked: Tune,
    /// What was searched.
    pub structure: &'static Structure,
    /// What was measured of every candidate.
    pub measures: Vec<Measure>,
    /// Which of the measures the objective is made of.
    pub minimised: Vec<usize>,
    /// What had to hold, and of which of the measures.
    pub limits: Vec<(usize, Limit)>,
    /// Every candidate, generation by generation.
    pub generations: Vec<Vec<Evaluation>>,
    /// The finalists under more episodes, best first.
    pub finalists: Vec<Evaluation>,
    /// What the search began with, under the fresh episodes.
    pub start: Evaluation,
    /// The best of the finalists under the same fresh episodes.
    pub confirmed: Evaluation,
    /// Its controller, for each group of agents.
    pub controllers: Vec<SimulatedController>,
    /// What there is to know of the choice of the backend.
    pub notes: Vec<String>,
}

impl Tuning {
    /// Candidates that were tried, the finalists not counted again.
    #[must_use]
    pub fn tried(&self) -> usize {
        self.generations.iter().map(Vec::len).sum()
    }

    /// Names of the parameters, in the order of their values.
    #[must_use]
    pub fn parameters(&self) -> Vec<String> {
        let channels = self.campaign.channel_groups();
        let of_channels = channels.iter().flat_map(|own| {
            let free = self.structure.parameters.iter();
            free.map(|free| format!("{} {}", own.name, free.name))
        });
        of_channels.collect()
    }

    /// The largest commands and the delay margin of some channels: their places among the measures.
    #[must_use]
    pub fn paid(&self, channels: &MeasuredChannels) -> [Option<usize>; 2] {
        let wanted = [
            peak_command(channels.clone()),
            delay_margin(channels.clone()),
        ];
        wanted.map(|measure| self.measures.iter().position(|own| *own == measure))
    }
}
