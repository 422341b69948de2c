//! From the parts of a run to its files: tables, statistics, manifest.

use super::directory::OutputDir;
use super::error::{GAINS, MANIFEST};
use super::failure::RunError;
use super::findings::Findings;
use super::flights::flights;
use super::integrity::records;
use super::manifest::{GIT_REVISION, Manifest, campaign_hash};
use super::parts::Parts;
use super::progress::Progress;
use super::staging::Staging;
use super::tables::{LargeTables, write_small};
use super::tabulation::{Tabulated, tabulate};
use crate::backend::gpu::GpuError;
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use crate::results::Results;
use crate::results::files::{Found, RUN_TABLES};
use crate::results::flights::Flights;
use crate::results::scores::Scores;
use crate::simulation::cross_check::CrossCheck;
use crate::simulation::{Segment, Times};
use rayon::ThreadPool;
use std::time::Instant;

/// The cross-check of some segments whose scores are given; or why there is none though there should be.
pub(super) type Check<'a> = &'a dyn Fn(&Scores, &[Segment]) -> (Option<CrossCheck>, Option<String>);

/// What a run is concluded with.
pub(super) struct Conclusion<'a> {
    pub(super) campaign: &'a Campaign,
    pub(super) gains: &'a [GainSet],
    /// The same as a file, as it was when they were flown.
    pub(super) gains_file: &'a [u8],
    pub(super) pool: &'a ThreadPool,
    pub(super) out: &'a OutputDir,
    /// Whether the large tables are written as CSV too.
    pub(super) csv: bool,
    /// Rows of a file of a large table, at most.
    pub(super) file_rows: usize,
    /// What there is to know beside.
    pub(super) notes: Vec<String>,
    /// Why episodes are missing, if a GPU failed.
    pub(super) interrupted: Option<GpuError>,
    /// Times so far.
    pub(super) times: Times,
    pub(super) check: Check<'a>,
    pub(super) progress: &'a (dyn Fn(Progress) + Sync),
}

impl Conclusion<'_> {
    /// Makes all files of what is kept, in the place of those of an earlier run.
    ///
    /// # Errors
    /// If a part is damaged, an earlier run has more episodes, or files cannot be written.
    pub(super) fn of(self, parts: &Parts) -> Result<Findings, RunError> {
        let (campaign, progress) = (self.campaign, self.progress);
        let mut times = self.times;
        progress(Progress::Tables);
        let start = Instant::now();
        let staging = Staging::within(self.out)?;
        let large = LargeTables::new(campaign, staging.files(), self.csv, self.file_rows);
        let made = tabulate(campaign, parts, self.pool, large)?;
        times.statistics_s += start.elapsed().as_secs_f64();
        unless_more_is_there(self.out, self.interrupted.as_ref(), made.episodes())?;

        progress(Progress::CrossCheck);
        let start = Instant::now();
        let (cross_check, cross_check_missing) = (self.check)(&made.scores, &made.segments);
        times.cross_check_s = start.elapsed().as_secs_f64();

        progress(Progress::Statistics);
        let start = Instant::now();
        let (results, flights) = statistics(campaign, self.gains, &made, self.pool);
        times.statistics_s += start.elapsed().as_secs_f64();

        progress(Progress::Writing);
        let start = Instant::now();
        let found = Found::new(campaign, &made.scores, &results, &flights);
        write_small(found, staging.files())?;
        staging.files().write(GAINS, self.gains_file)?;
        let files = records(staging.files().path(), counted())?;
        times.writing_s = start.elapsed().as_secs_f64();
        let plan = parts.plan();
        let mut robots = plan.robots.clone();
        let manifest = Manifest {
            name: campaign.name.clone(),
            version: env!("CARGO_PKG_VERSION").to_string(),
            git_revision: GIT_REVISION.map(String::from),
            campaign_path: plan.campaign_path.clone(),
            campaign_blake3: campaign_hash(campaign),
            campaign: plan.campaign.clone(),
            overlay: plan.overlay.clone(),
            robot: robots.remove(""),
            robots,
            seed: plan.seed,
            episodes: made.episodes(),
            episodes_asked: plan.episodes,
            stopped: made.stopping.found(campaign),
            verdict: results.verdict.clone(),
            unlike: results.unlike.clone(),
            harm: results.harm.clone(),
            requirements: results.requirements.clone(),
            interrupted: self.interrupted.map(|error| error.to_string()),
            precision: plan.precision,
            segments: made.segments,
            notes: self.notes,
            files,
            inputs: plan.inputs.clone(),
            cross_check,
            cross_check_missing,
            times,
            blake3: None,
        };
        staging.files().write(MANIFEST, &manifest.to_file()?)?;
        staging.commit()?;
        Ok(Findings { results, manifest })
    }
}

/// The files that a run's manifest counts: those that are read again.
fn counted() -> impl Iterator<Item = String> {
    let tables = RUN_TABLES.iter();
    let tables = tables.map(|table| format!("{}.parquet", table.name));
    tables.chain([GAINS.to_string()])
}

/// Every statistic, and the flights that are looked at.
fn statistics(
    campaign: &Campaign,
    gains: &[GainSet],
    made: &Tabulated,
    pool: &ThreadPool,
) -> (Results, Flights) {
    let scores = &made.scores;
    let flights = pool.install(|| flights(campaign, gains, scores));
    let results = Results::of(campaign, gains, scores, &flights.paces, pool);
    (results, flights)
}

/// An error if the directory keeps more episodes of an earlier run than an interrupted one has.
fn unless_more_is_there(
    out: &OutputDir,
    interrupted: Option<&GpuError>,
    episodes: u32,
) -> Result<(), RunError> {
    if let Some(reason) = interrupted
        && let Ok(earlier) = Manifest::read(out.path())
        && earlier.episodes > episodes
    {
        return Err(RunError::Interrupted {
            reason: reason.clone(),
            simulated: episodes,
            path: out.path().to_path_buf(),
            earlier: earlier.episodes,
        });
    }
    Ok(())
}
