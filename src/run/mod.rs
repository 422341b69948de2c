//! A whole run: gains, episodes, tables, statistics, files.

pub mod directory;
pub mod error;
pub mod manifest;
pub mod replay;
pub mod replay_files;
pub(crate) mod table_reader;
mod tables;

use crate::agent::Agent;
use crate::backend::gpu::{Gpu, GpuError};
use crate::campaign::Campaign;
use crate::controllers::{GainSet, GainsError};
use crate::results::{Results, harm, verdict};
use crate::simulation::cross_check::{CrossCheck, cross_check};
use crate::simulation::{Engine, RunOptions, Simulation, SimulationError, open, simulate};
use directory::OutputDir;
use error::{MANIFEST, OutputError};
use manifest::{GIT_REVISION, Manifest, campaign_hash};
use std::path::PathBuf;
use std::time::Instant;
use thiserror::Error;

/// Why a run ended early.
#[derive(Debug, Error)]
pub enum RunError {
    /// No gains.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// No directory to write.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Nothing flown.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Fewer episodes flown than the directory holds already.
    #[error(
        "{reason}; {simulated} episodes were finished, and {} keeps the {earlier} of an earlier run; use --backend cpu",
        path.display()
    )]
    Interrupted {
        /// Why no more were flown.
        reason: GpuError,
        /// Episodes that were flown.
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

/// What a run found.
#[derive(Debug)]
pub struct Findings {
    /// The statistics.
    pub results: Results,
    /// How it was found.
    pub manifest: Manifest,
}

/// What a run is at, told while it goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The gains are synthesized or read.
    Gains,
    /// The flight begins.
    Simulation,
    /// So many more episodes have been flown.
    Simulated(u32),
    /// Some episodes fly again on the reference.
    CrossCheck,
    /// Intervals and tests.
    Statistics,
    /// Files.
    Writing,
}

/// What a run does beside flying.
#[derive(Debug, Clone, Copy, Default)]
pub struct Extras {
    /// Whether the two big tables are written as CSV too.
    pub csv: bool,
    /// Episodes that are flown again on the reference; [`GPU_CROSS_CHECK`] on a GPU and none on the CPU if not given.
    pub cross_check: Option<u32>,
}

/// Episodes of a GPU's run that are flown again on the reference, if nothing else is asked for.
pub const GPU_CROSS_CHECK: u32 = 32;

/// Runs a campaign into a directory. A GPU that fails leaves a directory with the episodes that it finished, and the
/// findings say so. `told` hears what the run is at.
///
/// # Errors
/// If gains cannot be had, nothing can be flown, or files cannot be written.
pub fn run(
    campaign: &Campaign,
    options: &RunOptions,
    out: &OutputDir,
    extras: Extras,
    told: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    let (gpu, notes) = open(options)?;
    run_on(campaign, options, gpu.as_ref(), notes, out, extras, told)
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
    told: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    let start = Instant::now();
    told(Progress::Gains);
    let gains = GainSet::synthesize_or_load(campaign)?;
    let synthesis_s = start.elapsed().as_secs_f64();

    told(Progress::Simulation);
    let simulated = |episodes| told(Progress::Simulated(episodes));
    let flight = simulate(campaign, &gains, options, gpu, &simulated)?;
    notes.extend(flight.notes.iter().cloned());
    let start = Instant::now();
    told(Progress::CrossCheck);
    let (cross_check, cross_check_missing) =
        match checked(campaign, &gains, options, gpu, &flight, extras.cross_check) {
            Ok(check) => (check, None),
            Err(error) => (None, Some(error.to_string())),
        };
    let Simulation {
        tables,
        stopping,
        mut times,
        segments,
        interrupted,
        ..
    } = flight;
    times.cross_check_s = start.elapsed().as_secs_f64();
    times.synthesis_s = synthesis_s;

    let episodes = segments.iter().map(|segment| segment.episodes).sum();
    unless_more_is_there(out, interrupted.as_ref(), episodes)?;

    let start = Instant::now();
    told(Progress::Statistics);
    let results = Results::of(campaign, &tables.scores, &flight.pool);
    times.statistics_s += start.elapsed().as_secs_f64();

    let start = Instant::now();
    told(Progress::Writing);
    out.begin()?;
    tables::write(campaign, &tables, &results, extras.csv, out)?;
    out.write("gains.json", &pretty(&gains.to_file(campaign))?)?;
    times.writing_s = start.elapsed().as_secs_f64();
    let manifest = Manifest {
        name: campaign.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        git_revision: GIT_REVISION.map(String::from),
        campaign_path: campaign.path.display().to_string(),
        campaign_blake3: campaign_hash(campaign),
        campaign: campaign.text.clone(),
        overlay: campaign.overlay.clone(),
        robot: match &campaign.agent {
            Agent::Uav(_) => None,
            Agent::Biped(biped) => Some(biped.file.text.clone()),
        },
        seed: campaign.seed,
        episodes,
        episodes_asked: campaign.episodes,
        stopped: stopping.found(campaign),
        verdict: verdict(&results.summary, &results.comparisons),
        harm: harm(&results.screenings),
        requirements: results.requirements.clone(),
        interrupted: interrupted.map(|error| error.to_string()),
        precision: options.precision,
        segments,
        notes,
        cross_check,
        cross_check_missing,
        times,
    };
    out.write(MANIFEST, &pretty(&manifest)?)?;
    Ok(Findings { results, manifest })
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

/// The cross-check of a flight: of its first leg, on the engine that flew it.
fn checked(
    campaign: &Campaign,
    gains: &GainSet,
    options: &RunOptions,
    gpu: Option<&Gpu>,
    flight: &Simulation,
    count: Option<u32>,
) -> Result<Option<CrossCheck>, GpuError> {
    let Some(segment) = flight.segments.first() else {
        return Ok(None);
    };
    let default = match segment.engine {
        Engine::Gpu { .. } => GPU_CROSS_CHECK,
        Engine::Cpu { .. } => 0,
    };
    let count = count.unwrap_or(default);
    // A GPU that failed is gone; under `auto` its note says that its episodes are not checked.
    if count == 0 || flight.segments.len() > 1 {
        return Ok(None);
    }
    let scores = &flight.tables.scores;
    let check = || cross_check(campaign, gains, options, segment, scores, gpu, count);
    flight.pool.install(check).map(Some)
}

fn pretty(value: &impl serde::Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec_pretty(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}
