//! Every statistic of a run at once.

use super::paired::{PairedComparison, compare};
use super::requirements::{RequirementResult, requirements};
use super::scores::Scores;
use super::screening::{Screening, screen};
use super::sensitivity::{SensitivityResult, WorstEpisode, rank, worst};
use super::summary::{MetricQuantiles, summarise};
use crate::campaign::Campaign;
use rayon::ThreadPool;

/// What the scores of a run say.
#[derive(Debug, Clone)]
pub struct Results {
    /// How every controller fared.
    pub summary: Vec<MetricQuantiles>,
    /// How every pair compares.
    pub comparisons: Vec<PairedComparison>,
    /// What became of the requirements.
    pub requirements: Vec<RequirementResult>,
    /// What each stratum does to each controller.
    pub screenings: Vec<Screening>,
    /// What each condition does to each controller and pair.
    pub ranking: Vec<SensitivityResult>,
    /// The worst episodes of each controller.
    pub worst: Vec<WorstEpisode>,
}

impl Results {
    /// The statistics of a run's scores; the permutations of the sensitivity analysis take the threads of the pool.
    #[must_use]
    pub fn of(campaign: &Campaign, scores: &Scores, pool: &ThreadPool) -> Self {
        Self {
            summary: summarise(campaign, scores),
            comparisons: compare(campaign, scores),
            requirements: requirements(campaign, scores),
            screenings: screen(campaign, scores),
            ranking: pool.install(|| rank(campaign, scores)),
            worst: worst(campaign, scores),
        }
    }
}
