//! Every statistic of a run at once.

use super::fairness::{Terms, terms, unlike};
use super::flights::{Pace, add_paces, chattering};
use super::paired::{PairedComparison, compare};
use super::requirements::{RequirementResult, requirements};
use super::scores::Scores;
use super::screening::{Screening, screen};
use super::sensitivity::{SensitivityResult, WorstEpisode, rank, worst};
use super::summary::{FailureRate, MetricQuantiles, failure_rates, summarise};
use super::verdict::verdict;
use super::worst_fault::harm;
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use rayon::ThreadPool;
use serde::{Serialize, Serializer};

/// What the scores of a run say; for programs it is written as it stands here.
#[derive(Debug, Clone, Serialize)]
pub struct Results {
    /// Who does better, a sentence for each opponent of the first controller.
    pub verdict: Vec<String>,
    /// In what the first controller and each of the others are unlike, in sentences.
    pub unlike: Vec<String>,
    /// What the strata do to each controller, in sentences.
    pub harm: Vec<String>,
    /// On what terms the controllers are compared.
    #[serde(rename = "fairness")]
    pub terms: Vec<Terms>,
    /// How often every controller failed, and each group of agents alone where there are several.
    pub failures: Vec<FailureRate>,
    /// How large the errors of every controller were.
    #[serde(rename = "errors")]
    pub summary: Vec<MetricQuantiles>,
    /// How every pair compares.
    pub comparisons: Vec<PairedComparison>,
    /// What became of the requirements.
    #[serde(serialize_with = "judged")]
    pub requirements: Vec<RequirementResult>,
    /// What each stratum does to each controller.
    #[serde(rename = "screening")]
    pub screenings: Vec<Screening>,
    /// What each condition does to each controller and pair.
    pub ranking: Vec<SensitivityResult>,
    /// The worst episodes of each controller.
    #[serde(rename = "worst_episodes")]
    pub worst: Vec<WorstEpisode>,
}

impl Results {
    /// The statistics of a run's scores, and of how restless the commands of its flights are; they take the
    /// threads of the pool.
    #[must_use]
    pub fn of(
        campaign: &Campaign,
        gains: &[GainSet],
        scores: &Scores,
        paces: &[Pace],
        pool: &ThreadPool,
    ) -> Self {
        pool.install(|| Self::on_threads(campaign, gains, scores, paces))
    }

    fn on_threads(campaign: &Campaign, gains: &[GainSet], scores: &Scores, paces: &[Pace]) -> Self {
        let mut terms = terms(campaign, gains, scores);
        add_paces(&mut terms, paces);
        let chattering = chattering(&terms);
        let summary = summarise(campaign, scores);
        let comparisons = compare(campaign, scores);
        let screenings = screen(campaign, scores);
        Self {
            verdict: verdict(campaign, &summary, &comparisons, &chattering),
            unlike: unlike(&terms),
            harm: harm(&screenings),
            terms,
            failures: failure_rates(campaign, scores),
            summary,
            comparisons,
            requirements: requirements(campaign, gains, scores),
            screenings,
            ranking: rank(campaign, scores),
            worst: worst(campaign, scores),
        }
    }
}

/// Requirements, each with whether it holds.
fn judged<S: Serializer>(
    requirements: &[RequirementResult],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Judged<'a> {
        #[serde(flatten)]
        result: &'a RequirementResult,
        met: bool,
    }
    serializer.collect_seq(requirements.iter().map(|result| Judged {
        result,
        met: result.is_met(),
    }))
}
