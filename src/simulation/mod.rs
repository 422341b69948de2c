//! Simulating all episodes of a campaign on the backends that are to be had, into tables.

pub mod attenuation;
pub mod cross_check;
pub(crate) mod group_simulators;
pub mod stopping;
mod times;

pub use times::Times;

use crate::backend::EpisodeResult;
use crate::backend::cpu::{Precision, Simd};
use crate::backend::gpu::{Adapter, Gpu, GpuError, GpuTimes, Tuning, Wanted};
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use crate::results::scores::Status;
use crate::results::tables::Tables;
use group_simulators::GroupSimulators;
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc;
use std::time::Instant;
use stopping::StoppingRule;
use thiserror::Error;

/// Episodes of the CPU between two additions to the tables: enough to keep many cores busy, few enough to keep memory
/// small.
const CPU_BATCH: u32 = 2048;

/// Episodes of the CPU between two additions, at least, where they may be the last: sixteen lanes on each of sixteen
/// threads.
const LOOK_BATCH: u32 = 256;

/// Where the episodes are to be simulated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Backend {
    /// On a hardware GPU if there is one, else, and if it fails, on the CPU.
    Auto,
    /// On a GPU only: the best hardware one, or that of a name.
    Gpu {
        /// Part of the adapter's name; software adapters are taken only by name.
        adapter: Option<String>,
    },
    /// On the CPU.
    Cpu,
}

/// How a campaign is to be simulated.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Where.
    pub backend: Backend,
    /// Number format of the episode loop; double precision is simulated on the CPU.
    pub precision: Precision,
    /// Layout of the CPU's single-precision episodes; the widest of this processor if not given.
    pub simd: Option<Simd>,
    /// Threads; all cores if zero.
    pub threads: usize,
    /// How a GPU's work is cut up.
    pub tuning: Tuning,
}

impl RunOptions {
    /// On the CPU, with all its cores and the widest lanes.
    #[must_use]
    pub fn cpu(precision: Precision) -> Self {
        Self {
            backend: Backend::Cpu,
            precision,
            simd: None,
            threads: 0,
            tuning: Tuning::default(),
        }
    }
}

/// Why nothing could be simulated.
#[derive(Debug, Error)]
pub enum SimulationError {
    /// No threads.
    #[error("--threads {threads}: the threads cannot be started ({source}); use fewer")]
    Threads {
        /// As many as were asked for.
        threads: usize,
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
    /// No GPU, though one was asked for.
    #[error(transparent)]
    NoGpu(GpuError),
    /// The GPU failed before it had finished a batch.
    #[error("{0}; use --backend cpu")]
    Gpu(GpuError),
}

/// Consecutive episodes, and what simulated them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// The first episode.
    pub first: u32,
    /// How many.
    pub episodes: u32,
    /// What simulated them.
    #[serde(flatten)]
    pub engine: Engine,
}

/// What simulates episodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "backend", rename_all = "lowercase")]
pub enum Engine {
    /// The CPU backend.
    Cpu {
        /// Layout of single-precision episodes.
        simd: Option<Simd>,
        /// Threads.
        threads: usize,
    },
    /// The GPU backend, in single precision.
    Gpu {
        /// The adapter.
        adapter: Adapter,
        /// Episodes of a batch.
        batch: u32,
        /// Times.
        gpu_times: GpuTimes,
    },
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu { simd, threads } => {
                let lanes = simd.map_or(String::new(), |simd| format!(" ({simd:?})"));
                let threads = match threads {
                    1 => "1 thread".to_string(),
                    many => format!("{many} threads"),
                };
                write!(f, "the CPU{}, {threads}", lanes.to_lowercase())
            }
            Self::Gpu { adapter, .. } => write!(f, "{} ({})", adapter.name, adapter.driver),
        }
    }
}

/// The tables of a simulated campaign, and how they came about.
pub struct Simulation {
    /// The tables.
    pub tables: Tables,
    /// What has ended the run early, if it has.
    pub stopping: StoppingRule,
    /// Times so far.
    pub times: Times,
    /// What simulated them, in the order of the episodes; together they are the first episodes of the campaign.
    pub segments: Vec<Segment>,
    /// What the user should know of the choice of the backend.
    pub notes: Vec<String>,
    /// Why episodes are missing, if they are.
    pub interrupted: Option<GpuError>,
    /// The threads that were used.
    pub pool: ThreadPool,
}

impl Simulation {
    /// Episodes that were simulated.
    #[must_use]
    pub fn episodes(&self) -> u32 {
        self.segments.iter().map(|segment| segment.episodes).sum()
    }
}

/// The device to use, if any, and what there is to know about the choice.
///
/// # Errors
/// If a GPU is asked for and is not to be had.
pub fn open(options: &RunOptions) -> Result<(Option<Gpu>, Vec<String>), SimulationError> {
    let opened = match &options.backend {
        Backend::Cpu => return Ok((None, Vec::new())),
        Backend::Gpu { adapter: None } => {
            Gpu::open(Wanted::Hardware).map_err(SimulationError::NoGpu)?
        }
        Backend::Gpu {
            adapter: Some(name),
        } => Gpu::open(Wanted::Named(name)).map_err(SimulationError::NoGpu)?,
        // Double precision, or a layout of lanes, says that the CPU is meant.
        Backend::Auto if options.precision == Precision::F64 || options.simd.is_some() => {
            return Ok((None, Vec::new()));
        }
        Backend::Auto => match Gpu::open(Wanted::Hardware) {
            Ok(gpu) => gpu,
            Err(GpuError::NoHardware { .. }) => return Ok((None, Vec::new())),
            Err(error) => {
                return Ok((
                    None,
                    vec![format!("the CPU simulated all episodes: {error}")],
                ));
            }
        },
    };
    Ok((Some(opened), Vec::new()))
}

/// Simulates a campaign with gains at hand, on a GPU if one is given; `done` is told of finished episodes.
///
/// # Errors
/// If the threads cannot be started, or a GPU is asked for and simulates nothing. A GPU that fails later leaves the
/// episodes that it finished: the CPU simulates the others if it may, else they are missing and the simulation says
/// why.
pub fn simulate(
    campaign: &Campaign,
    gains: &[GainSet],
    options: &RunOptions,
    gpu: Option<&Gpu>,
    done: &(dyn Fn(u32) + Sync),
) -> Result<Simulation, SimulationError> {
    let threads = options.threads;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| SimulationError::Threads { threads, source })?;
    let mut simulation = Simulation {
        tables: Tables::new(campaign),
        stopping: StoppingRule::new(campaign),
        times: Times::default(),
        segments: Vec::new(),
        notes: Vec::new(),
        interrupted: None,
        pool,
    };
    // Of a batch that a GPU does not finish, episodes were told as done already.
    let told = AtomicU32::new(0);
    if let Some(gpu) = gpu {
        let failure = simulation.on_gpu(gpu, campaign, gains, options, &|episodes| {
            told.fetch_add(episodes, Ordering::Relaxed);
            done(episodes);
        });
        let simulated = simulation.episodes();
        told.fetch_sub(simulated, Ordering::Relaxed);
        match failure {
            None => {}
            Some(error) if options.backend == Backend::Auto => simulation.notes.push(format!(
                "the GPU failed after {simulated} of {} episodes, which are not cross-checked, and the CPU simulated the others: {error}",
                campaign.episodes
            )),
            Some(error) if simulated == 0 => return Err(SimulationError::Gpu(error)),
            Some(error) => {
                simulation.interrupted = Some(error);
                return Ok(simulation);
            }
        }
    }
    simulation.on_cpu(campaign, gains, options, &|episodes| {
        let take = |told: u32| Some(told - told.min(episodes));
        let told = told.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        done(episodes - told.unwrap_or_default().min(episodes));
    });
    Ok(simulation)
}

impl Simulation {
    /// Episodes in the tables.
    fn recorded(&self) -> u32 {
        u32::try_from(self.tables.scores.episodes()).unwrap_or(u32::MAX)
    }

    /// Simulates on a GPU, batch by batch, until all are done or it fails.
    fn on_gpu(
        &mut self,
        gpu: &Gpu,
        campaign: &Campaign,
        gains: &[GainSet],
        options: &RunOptions,
        done: &(dyn Fn(u32) + Sync),
    ) -> Option<GpuError> {
        let start = Instant::now();
        let loops = GainSet::loops_of(gains);
        let on_gpu = GroupSimulators::on_gpu(gpu, campaign, &loops, options.tuning);
        let mut simulators = match on_gpu {
            Ok(simulators) => simulators,
            Err(error) => return Some(error),
        };
        self.times.loop_s += start.elapsed().as_secs_f64();
        let (tables, stopping) = (&mut self.tables, &mut self.stopping);
        let (times, pool) = (&mut self.times, &self.pool);
        let (mut next, mut failure) = (0, None);
        let enough = AtomicBool::new(false);
        let seen = &enough;
        // The tables take in a batch while the next one is simulated; at most one waits, so memory stays small.
        std::thread::scope(|scope| {
            let (sender, batches) = mpsc::sync_channel::<Vec<Vec<EpisodeResult>>>(1);
            let filling = scope.spawn(move || {
                let mut spent_s = 0.0;
                for batch in batches {
                    spent_s += fill(tables, stopping, campaign, &batch);
                    seen.store(stopping.is_done(), Ordering::Relaxed);
                }
                spent_s
            });
            let more = || !enough.load(Ordering::Relaxed);
            while next < campaign.episodes && failure.is_none() && more() {
                let until = next
                    .saturating_add(simulators.batch())
                    .min(campaign.episodes);
                let start = Instant::now();
                let simulated = pool.install(|| simulators.simulate(&(next..until), done));
                times.loop_s += start.elapsed().as_secs_f64();
                match simulated.map(|simulated| sender.send(simulated)) {
                    Ok(Ok(())) => next = until,
                    // Nobody receives any more: filling has panicked, which is passed on below.
                    Ok(Err(_)) => break,
                    Err(error) => failure = Some(error),
                }
            }
            drop(sender);
            let filled = filling.join();
            times.statistics_s += filled.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        });
        // What was simulated beyond the end is in no table.
        let episodes = self.recorded();
        if episodes > 0 {
            self.segments.push(Segment {
                first: 0,
                episodes,
                engine: Engine::Gpu {
                    adapter: gpu.adapter().clone(),
                    batch: simulators.batch(),
                    gpu_times: simulators.gpu_times(),
                },
            });
        }
        failure.filter(|_| !self.stopping.is_done())
    }

    /// Simulates the episodes that are left on the CPU.
    fn on_cpu(
        &mut self,
        campaign: &Campaign,
        gains: &[GainSet],
        options: &RunOptions,
        done: &(dyn Fn(u32) + Sync),
    ) {
        let first = self.episodes();
        if first == campaign.episodes || self.stopping.is_done() {
            return;
        }
        let start = Instant::now();
        let loops = GainSet::loops_of(gains);
        let mut simulators =
            GroupSimulators::on_cpu(campaign, &loops, options.precision, options.simd);
        self.times.loop_s += start.elapsed().as_secs_f64();
        let batch = match &campaign.stop {
            None => CPU_BATCH,
            // Little is simulated in vain if batches are as short as the threads and the looks allow.
            Some(stop) => stop.every.clamp(LOOK_BATCH, CPU_BATCH),
        };
        let mut next = first;
        while next < campaign.episodes && !self.stopping.is_done() {
            let until = next.saturating_add(batch).min(campaign.episodes);
            let start = Instant::now();
            let simulate = || simulators.simulate(&(next..until), done);
            // Nothing on the CPU fails.
            let simulated = self.pool.install(simulate).unwrap_or_default();
            self.times.loop_s += start.elapsed().as_secs_f64();
            self.times.statistics_s +=
                fill(&mut self.tables, &mut self.stopping, campaign, &simulated);
            next = until;
        }
        self.segments.push(Segment {
            first,
            episodes: self.recorded() - first,
            engine: Engine::Cpu {
                simd: simulators.simd(),
                threads: self.pool.current_num_threads(),
            },
        });
    }
}

/// Adds simulated episodes, `[group][episode]`, to the tables, until the stopping rule has seen enough; the time that
/// it took, s.
fn fill(
    tables: &mut Tables,
    stopping: &mut StoppingRule,
    campaign: &Campaign,
    simulated: &[Vec<EpisodeResult>],
) -> f64 {
    let start = Instant::now();
    for place in 0..simulated.first().map_or(0, Vec::len) {
        if stopping.is_done() {
            break;
        }
        let groups: Vec<&EpisodeResult> = simulated.iter().map(|group| &group[place]).collect();
        tables.add(campaign, &groups);
        let status = &tables.scores.status;
        stopping.take(|controller| status[controller].last().copied().unwrap_or(Status::Ok));
    }
    start.elapsed().as_secs_f64()
}
