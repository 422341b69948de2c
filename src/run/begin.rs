//! A run from its campaign to its files, whether it is begun or gone on with.

use super::conclusion::Conclusion;
use super::directory::OutputDir;
use super::failure::RunError;
use super::findings::Findings;
use super::parts::{Parts, Plan, Resume, Writer};
use super::progress::Progress;
use super::shard::{Shard, Shards};
use super::tables::FILE_ROWS;
use crate::backend::cpu::Cpu;
use crate::backend::gpu::{Gpu, GpuTimes};
use crate::campaign::Campaign;
use crate::controllers::{GainSet, cautions};
use crate::results::can_be_judged;
use crate::results::extent::Extent;
use crate::results::scores::Scores;
use crate::simulation::cross_check::{CrossCheck, cross_check};
use crate::simulation::flight::{Flight, Flown};
use crate::simulation::{Engine, RunOptions, Segment, SimulationError, Times, open, threads};
use crate::util::json::pretty;
use rayon::ThreadPool;
use std::time::Instant;

/// What a run does beside simulating.
#[derive(Clone, Copy)]
pub struct Extras<'a> {
    /// Whether the two big tables are written as CSV too.
    pub csv: bool,
    /// Episodes that are simulated again on the reference; [`GPU_CROSS_CHECK`] on a GPU and none on the CPU if not
    /// given.
    pub cross_check: Option<u32>,
    /// Whether to begin anew where episodes of an unfinished run are kept.
    pub restart: bool,
    /// Whether to begin anew where those of another campaign are kept.
    pub overwrite: bool,
    /// Whether episodes of several engines or versions may stand in one run.
    pub allow_mixed: bool,
    /// Whether to end soon and keep what was flown; asked between batches.
    pub halt: &'a (dyn Fn() -> bool + Sync),
    /// Rows of a file of a large table, at most.
    pub file_rows: usize,
}

impl Default for Extras<'_> {
    fn default() -> Self {
        Self {
            csv: false,
            cross_check: None,
            restart: false,
            overwrite: false,
            allow_mixed: false,
            halt: &|| false,
            file_rows: FILE_ROWS,
        }
    }
}

impl Extras<'_> {
    fn resume(&self) -> Resume {
        Resume {
            restart: self.restart,
            overwrite: self.overwrite,
            allow_mixed: self.allow_mixed,
        }
    }
}

/// Episodes of a GPU's run that are simulated again on the reference, if nothing else is asked for.
pub const GPU_CROSS_CHECK: u32 = 32;

/// Runs a campaign into a directory, from where an earlier process ended. A GPU that fails leaves a directory with the
/// episodes that it finished, and the findings say so. `progress` hears what the run is at.
///
/// # Errors
/// If gains cannot be had, nothing can be simulated, files cannot be written, or the run was asked to end before it had
/// flown all: then the episodes that it flew are kept.
pub fn run(
    campaign: &Campaign,
    options: &RunOptions,
    out: &OutputDir,
    extras: Extras<'_>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    Extent::of(campaign).fits_here(campaign)?;
    let plan = Plan::of(campaign, options.precision, Parts::size_of(campaign));
    Parts::may_be_in(out.path(), campaign, &plan, extras.resume())?;
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
    extras: Extras<'_>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Findings, RunError> {
    let begun = Begun::new(campaign, options, progress)?;
    let Begun { gains, pool, .. } = &begun;
    let resume = extras.resume();
    let (plan, file) = (begun.plan.clone(), &begun.file);
    let mut parts = Parts::open(
        out,
        campaign,
        plan,
        file,
        &engine(options, gpu, pool),
        resume,
    )?;
    notes.extend(cautions(campaign, gains));
    notes.append(&mut parts.notes);
    let earlier_s = parts.loop_s();
    let pilot = Pilot {
        campaign,
        gains,
        options,
        gpu,
        pool,
        halt: extras.halt,
        progress,
    };
    let flown = pilot.fly(&mut parts)?;
    notes.extend(flown.notes);
    let conclusion = Conclusion {
        campaign,
        gains,
        gains_file: &begun.file,
        pool,
        out,
        csv: extras.csv,
        file_rows: extras.file_rows,
        notes,
        interrupted: flown.interrupted.clone(),
        times: Times {
            synthesis_s: begun.synthesis_s,
            loop_s: earlier_s + flown.loop_s,
            statistics_s: flown.taking_s,
            ..Times::default()
        },
        check: &|scores, segments| {
            let on = (options, gpu, pool);
            let found = (scores, segments);
            checked(campaign, gains, on, found, extras.cross_check)
        },
        progress,
    };
    let findings = conclusion.of(&parts);
    let findings = findings.map_err(|error| stuck(error, &parts))?;
    // Of a run that a GPU did not end, what it flew is gone on with.
    if flown.interrupted.is_none() {
        parts.remove()?;
    }
    Ok(findings)
}

/// What a shard has flown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShardFlown {
    /// Which.
    pub shard: Shard,
    /// Its episodes, all of which are kept.
    pub episodes: u32,
    /// What there is to know beside.
    pub notes: Vec<String>,
}

/// Flies a shard of a campaign's run into a directory that others fly theirs into; it is made one run by
/// [`super::merge`].
///
/// # Errors
/// As [`run`].
pub fn fly_shard(
    campaign: &Campaign,
    options: &RunOptions,
    out: &OutputDir,
    (shard, shards): (Shard, Shards),
    extras: Extras<'_>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<ShardFlown, RunError> {
    let plan = Plan::of(campaign, options.precision, Parts::size_of(campaign));
    Parts::may_be_in(out.path(), campaign, &plan, extras.resume())?;
    let (gpu, mut notes) = open(options)?;
    let begun = Begun::new(campaign, options, progress)?;
    let (resume, shard_of) = (extras.resume(), (shard, shards));
    let (plan, file) = (begun.plan.clone(), &begun.file);
    let engine = engine(options, gpu.as_ref(), &begun.pool);
    let mut parts = Parts::open_shard(out, campaign, plan, file, shard_of, &engine, resume)?;
    notes.append(&mut parts.notes);
    let pilot = Pilot {
        campaign,
        gains: &begun.gains,
        options,
        gpu: gpu.as_ref(),
        pool: &begun.pool,
        halt: extras.halt,
        progress,
    };
    let flown = pilot.fly(&mut parts)?;
    notes.extend(flown.notes);
    match flown.interrupted {
        Some(error) => Err(SimulationError::Gpu(error).into()),
        None => Ok(ShardFlown {
            shard,
            episodes: parts.kept(),
            notes,
        }),
    }
}

/// What a run has before it flies.
struct Begun {
    plan: Plan,
    gains: Vec<GainSet>,
    /// The gains as a file.
    file: Vec<u8>,
    synthesis_s: f64,
    pool: ThreadPool,
}

impl Begun {
    fn new(
        campaign: &Campaign,
        options: &RunOptions,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<Self, RunError> {
        // What is read from here on, not what the files are when the run ends.
        let mut plan = Plan::of(campaign, options.precision, Parts::size_of(campaign));
        let start = Instant::now();
        progress(Progress::Gains);
        let gains = GainSet::of_groups(campaign)?;
        let synthesis_s = start.elapsed().as_secs_f64();
        can_be_judged(campaign, &gains)?;
        let file = pretty(&GainSet::to_file(campaign, &gains))?;
        plan.gains_blake3 = blake3::hash(&file).to_hex().to_string();
        Ok(Self {
            plan,
            gains,
            file,
            synthesis_s,
            pool: threads(options)?,
        })
    }
}

/// What flies the episodes that are missing among parts.
struct Pilot<'a> {
    campaign: &'a Campaign,
    gains: &'a [GainSet],
    options: &'a RunOptions,
    gpu: Option<&'a Gpu>,
    pool: &'a ThreadPool,
    halt: &'a (dyn Fn() -> bool + Sync),
    progress: &'a (dyn Fn(Progress) + Sync),
}

impl Pilot<'_> {
    /// Flies what is missing, and keeps it part by part.
    ///
    /// # Errors
    /// If nothing can be simulated or kept, or it was asked to end before all was flown.
    fn fly(&self, parts: &mut Parts) -> Result<Flown, RunError> {
        (self.progress)(Progress::Simulation);
        if parts.kept() > 0 {
            (self.progress)(Progress::Kept(parts.kept()));
        }
        let wanted = parts.missing();
        let flight = Flight {
            campaign: self.campaign,
            gains: self.gains,
            options: self.options,
            gpu: self.gpu,
            wanted: &wanted,
            pool: self.pool,
            done: &|episodes| (self.progress)(Progress::Simulated(episodes)),
            halt: self.halt,
        };
        let mut writer = Writer::new(parts, self.campaign)?;
        let flown = match writer.is_done() {
            true => Ok(Flown::default()),
            false => flight.fly(&mut |batch| writer.take(&batch)),
        };
        let is_done = writer.is_done();
        let finished = writer.finish();
        if let Err(error) = finished {
            parts.leave();
            return Err(stuck(error.into(), parts));
        }
        let flown = flown.inspect_err(|_| parts.leave())?;
        let is_whole = is_done || flown.interrupted.is_some() || parts.missing().is_empty();
        if is_whole {
            return Ok(flown);
        }
        parts.leave();
        Err(RunError::Partial {
            kept: parts.kept(),
            asked: parts.asked(),
            path: parts.out().to_path_buf(),
        })
    }
}

/// The same error, with what is kept, where a disk takes no more.
fn stuck(error: RunError, parts: &Parts) -> RunError {
    match error {
        RunError::Output(source) if source.is_full() && parts.kept() > 0 => RunError::Stuck {
            source,
            kept: parts.kept(),
            asked: parts.asked(),
            path: parts.out().to_path_buf(),
            // The tables take about as much as the parts, which go when the tables are whole.
            needed_bytes: 2 * parts.bytes(),
        },
        other => other,
    }
}

/// What would simulate the next episode.
fn engine(options: &RunOptions, gpu: Option<&Gpu>, pool: &ThreadPool) -> Engine {
    match gpu {
        Some(gpu) => Engine::Gpu {
            adapter: gpu.adapter().clone(),
            batch: 0,
            gpu_times: GpuTimes::default(),
        },
        None => Engine::Cpu {
            simd: Cpu::layout(options.precision, options.simd),
            threads: pool.current_num_threads(),
        },
    }
}

/// The cross-check of a run: of its first segment, on the engine that simulated it; or why there is none though there
/// should be.
fn checked(
    campaign: &Campaign,
    gains: &[GainSet],
    (options, gpu, pool): (&RunOptions, Option<&Gpu>, &ThreadPool),
    (scores, segments): (&Scores, &[Segment]),
    count: Option<u32>,
) -> (Option<CrossCheck>, Option<String>) {
    let Some(segment) = segments.first() else {
        return (None, None);
    };
    let default = match segment.engine {
        Engine::Gpu { .. } => GPU_CROSS_CHECK,
        Engine::Cpu { .. } => 0,
    };
    let count = count.unwrap_or(default);
    // A GPU that failed is gone; under `auto` its note says that its episodes are not checked.
    if count == 0 || segments.len() > 1 {
        return (None, None);
    }
    let own = segment.engine.class();
    if own != engine(options, gpu, pool).class() {
        let reason = format!("{own} simulated them, which is not in use now");
        return (None, Some(reason));
    }
    let check = || cross_check(campaign, gains, options, segment, scores, gpu, count);
    match pool.install(check) {
        Ok(check) => (Some(check), None),
        Err(error) => (None, Some(error.to_string())),
    }
}
