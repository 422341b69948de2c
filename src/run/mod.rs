//! A whole run: gains, episodes, tables, statistics, files.

pub mod compare;
pub mod directory;
pub mod error;
pub(crate) mod file_names;
mod flights;
pub mod integrity;
mod labels;
mod lock;
pub mod manifest;
mod replacement;
pub mod replay;
pub mod replay_files;
mod scores_of_run;
mod staging;
pub(crate) mod table_reader;
mod tables;
pub mod tune;

use crate::backend::gpu::{Gpu, GpuError};
use crate::campaign::{Campaign, CampaignError};
use crate::controllers::{GainSet, GainsError, cautions};
use crate::results::files::{Found, RUN_TABLES};
use crate::results::flights::Flights;
use crate::results::scores::Scores;
use crate::results::{Results, can_be_judged};
use crate::simulation::cross_check::{CrossCheck, cross_check};
use crate::simulation::{Engine, RunOptions, Simulation, SimulationError, open, simulate};
use directory::OutputDir;
use error::{GAINS, MANIFEST, OutputError};
use flights::flights;
use integrity::{FileRecord, inputs, records};
pub use labels::Labels;
use manifest::{GIT_REVISION, Manifest, campaign_hash};
use rayon::ThreadPool;
use serde::Serialize;
use staging::Staging;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;
use thiserror::Error;

/// Why a run ended early.
#[derive(Debug, Error)]
pub enum RunError {
    /// No gains.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// Something is required that is not known of the gains.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// No directory to write.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Nothing simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Fewer episodes simulated than the directory holds already.
    #[error(
        "{reason}; {simulated} episodes were finished, and {} keeps the {earlier} of an earlier run; use --backend cpu",
        path.display()
    )]
    Interrupted {
        /// Why no more were simulated.
        reason: GpuError,
        /// Episodes that were simulated.
        simulated: u32,
        /// The directory.
        path: PathBuf,
        /// Episodes that it holds.
        earlier: u32,
    },
    /// The manifest cannot be encoded.
    #[error("the manifest cannot be encoded")]
    Manifest(#[from] serde_json::Error),
}

/// What a run found; for programs it is written as it stands here.
#[derive(Debug, Serialize)]
pub struct Findings {
    /// The statistics.
    #[serde(flatten)]
    pub results: Results,
    /// How it was found.
    pub manifest: Manifest,
}

/// What a run is at, reported while it goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The gains are synthesized or read.
    Gains,
    /// The simulation begins.
    Simulation,
    /// So many more episodes have been simulated.
    Simulated(u32),
    /// Some episodes are simulated again on the reference.
    CrossCheck,
    /// Intervals and tests.
    Statistics,
    /// Files.
    Writing,
}

/// What a run does beside simulating.
#[derive(Debug, Clone, Copy, Default)]
pub struct Extras {
    /// Whether the two big tables are written as CSV too.
    pub csv: bool,
    /// Episodes that are simulated again on the reference; [`GPU_CROSS_CHECK`] on a GPU and none on the CPU if not
    /// given.
    pub cross_check: Option<u32>,
}

/// Episodes of a GPU's run that are simulated again on the reference, if nothing else is asked for.
pub const GPU_CROSS_CHECK: u32 = 32;

/// Runs a campaign into a directory. A GPU that fails leaves a directory with the episodes that it finished, and the
/// findings say so. `progress` hears what the run is at.
///
/// # Errors
/// If gains cannot be had, nothing can be simulated, or files cannot be written.
pub fn run(
    campaign: &Campaign,
    options: &RunOptions,
    out: &OutputDir,
    extras: Extras,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    let (gpu, notes) = open(options)?;
    run_on(
        campaign,
        options,
        gpu.as_ref(),
        notes,
        out,
        extras,
        progress,
    )
}

/// [`run`] on a device at hand, to test what becomes of a run whose device fails.
///
/// # Errors
/// As [`run`].
#[doc(hidden)]
pub fn run_on(
    campaign: &Campaign,
    options: &RunOptions,
    gpu: Option<&Gpu>,
    mut notes: Vec<String>,
    out: &OutputDir,
    extras: Extras,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    // What is read from here on, not what the files are when the run ends.
    let inputs = inputs(campaign);
    let (gains, synthesis_s) = synthesized(campaign, progress)?;
    can_be_judged(campaign, &gains)?;
    notes.extend(cautions(campaign, &gains));

    progress(Progress::Simulation);
    let simulation = simulate(campaign, &gains, options, gpu, &|episodes| {
        progress(Progress::Simulated(episodes))
    })?;
    notes.extend(simulation.notes.iter().cloned());
    let start = Instant::now();
    progress(Progress::CrossCheck);
    let (cross_check, cross_check_missing) = checked(
        campaign,
        &gains,
        options,
        gpu,
        &simulation,
        extras.cross_check,
    );
    let episodes = simulation.episodes();
    let (tables, mut times) = (simulation.tables, simulation.times);
    times.cross_check_s = start.elapsed().as_secs_f64();
    times.synthesis_s = synthesis_s;

    unless_more_is_there(out, simulation.interrupted.as_ref(), episodes)?;

    progress(Progress::Statistics);
    let (results, flights, statistics_s) =
        statistics(campaign, &gains, &tables.scores, &simulation.pool);
    times.statistics_s += statistics_s;

    progress(Progress::Writing);
    let found = Found::new(campaign, &tables, &results, &flights);
    let (staging, files, writing_s) = staged(found, &gains, extras.csv, out)?;
    times.writing_s = writing_s;
    let mut robots = robots(campaign);
    let manifest = Manifest {
        name: campaign.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        git_revision: GIT_REVISION.map(String::from),
        campaign_path: campaign.path.display().to_string(),
        campaign_blake3: campaign_hash(campaign),
        campaign: campaign.text.clone(),
        overlay: campaign.overlay.clone(),
        robot: robots.remove(""),
        robots,
        seed: campaign.seed,
        episodes,
        episodes_asked: campaign.episodes,
        stopped: simulation.stopping.found(campaign),
        verdict: results.verdict.clone(),
        unlike: results.unlike.clone(),
        harm: results.harm.clone(),
        requirements: results.requirements.clone(),
        interrupted: simulation.interrupted.map(|error| error.to_string()),
        precision: options.precision,
        segments: simulation.segments,
        notes,
        files,
        inputs,
        cross_check,
        cross_check_missing,
        times,
    };
    staging.files().write(MANIFEST, &pretty(&manifest)?)?;
    staging.commit()?;
    Ok(Findings { results, manifest })
}

/// The gains of a campaign, and the time that they took, s.
fn synthesized(
    campaign: &Campaign,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<(Vec<GainSet>, f64), GainsError> {
    let start = Instant::now();
    progress(Progress::Gains);
    let gains = GainSet::of_groups(campaign)?;
    Ok((gains, start.elapsed().as_secs_f64()))
}

/// The text of the robot's file of each group of robots, by the group's name.
fn robots(campaign: &Campaign) -> BTreeMap<String, String> {
    let groups = campaign.groups().iter();
    groups
        .filter_map(|group| Some((group.name.to_string(), group.agent.file()?.text.clone())))
        .collect()
}

/// The files that a run's manifest counts: those that are read again.
fn counted() -> impl Iterator<Item = String> {
    let tables = RUN_TABLES.iter();
    let tables = tables.map(|table| format!("{}.parquet", table.name));
    tables.chain([GAINS.to_string()])
}

/// Every statistic, the flights that are looked at, and the time that they took, s.
fn statistics(
    campaign: &Campaign,
    gains: &[GainSet],
    scores: &Scores,
    pool: &ThreadPool,
) -> (Results, Flights, f64) {
    let start = Instant::now();
    let flights = pool.install(|| flights(campaign, gains, scores));
    let results = Results::of(campaign, gains, scores, &flights.paces, pool);
    (results, flights, start.elapsed().as_secs_f64())
}

/// All files but the manifest, written beside those of an earlier run; with their records, and the time that it took,
/// s.
fn staged(
    found: Found<'_>,
    gains: &[GainSet],
    csv: bool,
    out: &OutputDir,
) -> Result<(Staging, BTreeMap<String, FileRecord>, f64), RunError> {
    let start = Instant::now();
    let staging = Staging::within(out)?;
    let files = staging.files();
    tables::write(found, csv, files)?;
    files.write(GAINS, &pretty(&GainSet::to_file(found.campaign, gains))?)?;
    let records = records(files.path(), counted())?;
    Ok((staging, records, start.elapsed().as_secs_f64()))
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

/// The cross-check of a simulation: of its first segment, on the engine that simulated it; or why there is none though
/// there should be.
fn checked(
    campaign: &Campaign,
    gains: &[GainSet],
    options: &RunOptions,
    gpu: Option<&Gpu>,
    simulation: &Simulation,
    count: Option<u32>,
) -> (Option<CrossCheck>, Option<String>) {
    let Some(segment) = simulation.segments.first() else {
        return (None, None);
    };
    let default = match segment.engine {
        Engine::Gpu { .. } => GPU_CROSS_CHECK,
        Engine::Cpu { .. } => 0,
    };
    let count = count.unwrap_or(default);
    // A GPU that failed is gone; under `auto` its note says that its episodes are not checked.
    if count == 0 || simulation.segments.len() > 1 {
        return (None, None);
    }
    let scores = &simulation.tables.scores;
    let check = || cross_check(campaign, gains, options, segment, scores, gpu, count);
    match simulation.pool.install(check) {
        Ok(check) => (Some(check), None),
        Err(error) => (None, Some(error.to_string())),
    }
}

/// A value as the text of a JSON file.
fn pretty(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec_pretty(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}
