//! The statistics of a run, and the files that hold them.

use super::directory::OutputDir;
use super::error::OutputError;
use crate::campaign::Campaign;
use crate::results;
use crate::results::scores::Scores;
use crate::results::sensitivity;
use crate::results::sensitivity::{SensitivityResult, WorstEpisode};
use crate::results::tables::Tables;
use crate::results::{MetricQuantiles, PairedComparison, RequirementResult, Screening};
use rayon::ThreadPool;

/// What the scores of a run say.
pub(super) struct Statistics {
    pub(super) summary: Vec<MetricQuantiles>,
    pub(super) comparisons: Vec<PairedComparison>,
    pub(super) requirements: Vec<RequirementResult>,
    pub(super) screenings: Vec<Screening>,
    pub(super) ranking: Vec<SensitivityResult>,
    pub(super) worst: Vec<WorstEpisode>,
}

impl Statistics {
    /// All of them; the permutations of the sensitivity analysis take the threads of the run.
    pub(super) fn of(campaign: &Campaign, scores: &Scores, pool: &ThreadPool) -> Self {
        Self {
            summary: results::summarise(campaign, scores),
            comparisons: results::compare(campaign, scores),
            requirements: results::requirements(campaign, scores),
            screenings: results::screen(campaign, scores),
            ranking: pool.install(|| sensitivity::rank(campaign, scores)),
            worst: sensitivity::worst(campaign, scores),
        }
    }

    /// Writes the tables of the run; `csv` is whether the two big ones are written as CSV too.
    pub(super) fn write(
        &self,
        campaign: &Campaign,
        tables: &Tables,
        csv: bool,
        out: &OutputDir,
    ) -> Result<(), OutputError> {
        let summary = results::summary_table(campaign, &self.summary);
        let comparison = results::comparison_table(campaign, &self.comparisons);
        let screening = results::screening_table(&self.screenings);
        let ranking = sensitivity::ranking_table(&self.ranking);
        let worst = sensitivity::worst_table(&self.worst);
        for (name, table, with_csv) in [
            ("episodes", &tables.episodes, csv),
            ("channels", &tables.channels, csv),
            ("summary", &summary, true),
            ("comparison", &comparison, true),
            ("screening", &screening, true),
            ("ranking", &ranking, true),
            ("worst", &worst, true),
        ] {
            // One controller has nothing to be compared with; without strata nothing is screened; where nothing varies,
            // nothing is ranked.
            if table.is_empty() {
                continue;
            }
            out.write_parquet(&format!("{name}.parquet"), table)?;
            if with_csv {
                out.write_csv(&format!("{name}.csv"), table)?;
            }
        }
        Ok(())
    }
}
