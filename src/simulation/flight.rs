//! Episodes flown in batches, which leave as they end.

use super::group_simulators::{GroupSimulators, Landed, Packed, Packers};
use super::options::{Backend, RunOptions, SimulationError};
use super::segment::Engine;
use crate::backend::EpisodeResult;
use crate::backend::gpu::{Gpu, GpuError, GpuTimes};
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use rayon::ThreadPool;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc;
use std::time::Instant;

/// Episodes of the CPU for each of its threads between two batches: enough to keep all of them busy, few enough to
/// keep memory small, and that little is lost with the process.
const PER_THREAD: u32 = 512;

/// Episodes of a batch of the CPU, at least and at most: sixteen lanes on each of sixteen threads where they may be the
/// last.
const FEWEST: u32 = 256;
const MOST: u32 = 8192;

/// Consecutive episodes that were simulated.
#[derive(Debug)]
pub struct Batch {
    /// The first episode.
    pub first: u32,
    /// How each went, `[group of agents][episode]`.
    pub groups: Vec<Vec<EpisodeResult>>,
    /// What simulated them, with the times of this batch.
    pub engine: Engine,
    /// How long the loop took, s.
    pub loop_s: f64,
}

impl Batch {
    /// How many episodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.groups.first().map_or(0, Vec::len)
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// An episode by its place in the batch, of each group of agents.
    #[must_use]
    pub fn episode(&self, place: usize) -> Vec<&EpisodeResult> {
        self.groups.iter().map(|group| &group[place]).collect()
    }
}

/// What is to be flown, and with what.
pub struct Flight<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The gains of each group of agents.
    pub gains: &'a [GainSet],
    /// How.
    pub options: &'a RunOptions,
    /// The device, if one is to be used.
    pub gpu: Option<&'a Gpu>,
    /// Which episodes, in ascending order.
    pub wanted: &'a [Range<u32>],
    /// The threads.
    pub pool: &'a ThreadPool,
    /// Is told of finished episodes.
    pub done: &'a (dyn Fn(u32) + Sync),
    /// Whether to end soon; asked between batches.
    pub halt: &'a (dyn Fn() -> bool + Sync),
}

/// How a flight went.
#[derive(Debug, Default)]
pub struct Flown {
    /// Tabulating references and the episode loop itself, s.
    pub loop_s: f64,
    /// What was done with the batches, beside the loop, s.
    pub taking_s: f64,
    /// What the user should know of the choice of the backend.
    pub notes: Vec<String>,
    /// Why episodes are missing, if a GPU failed.
    pub interrupted: Option<GpuError>,
    /// Episodes that were handed out.
    pub episodes: u32,
    /// Whether whoever takes the batches wanted no more.
    enough: bool,
}

/// Takes in a batch, and says whether there is to be another.
pub type Take<'a> = &'a mut (dyn FnMut(Batch) -> ControlFlow<()> + Send);

impl Flight<'_> {
    /// Flies; `take` is handed the batches in order, beside the next one's simulation.
    ///
    /// # Errors
    /// If a GPU is asked for and simulates nothing. A GPU that fails later leaves the episodes that it finished: the
    /// CPU simulates the others if it may, else they are missing and the result says why.
    pub fn fly(&self, take: Take<'_>) -> Result<Flown, SimulationError> {
        let mut flown = Flown::default();
        // Of a batch that a GPU does not finish, episodes were told as done already.
        let told = AtomicU32::new(0);
        if let Some(gpu) = self.gpu {
            let failure = self.on_gpu(gpu, &mut flown, take, &|episodes| {
                told.fetch_add(episodes, Ordering::Relaxed);
                (self.done)(episodes);
            });
            let simulated = flown.episodes;
            told.fetch_sub(
                simulated.min(told.load(Ordering::Relaxed)),
                Ordering::Relaxed,
            );
            match failure.filter(|_| !flown.enough) {
                None => {}
                Some(error) if self.options.backend == Backend::Auto => flown.notes.push(format!(
                    "the GPU failed after {simulated} of {} episodes, which are not cross-checked, and the CPU simulated the others: {error}",
                    self.asked()
                )),
                Some(error) if simulated == 0 => return Err(SimulationError::Gpu(error)),
                Some(error) => {
                    flown.interrupted = Some(error);
                    return Ok(flown);
                }
            }
        }
        self.on_cpu(&mut flown, take, &|episodes| {
            let take = |told: u32| Some(told - told.min(episodes));
            let told = told.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
            (self.done)(episodes - told.unwrap_or_default().min(episodes));
        });
        Ok(flown)
    }

    /// Episodes that are to be flown.
    fn asked(&self) -> u32 {
        self.wanted.iter().map(|own| own.end - own.start).sum()
    }

    /// What is left when the first `flown` episodes are done, in batches.
    fn batches(&self, flown: u32, size: u32) -> impl Iterator<Item = Range<u32>> {
        let mut done = flown;
        let left = self.wanted.iter().map(move |own| {
            let skipped = done.min(own.end - own.start);
            done -= skipped;
            own.start + skipped..own.end
        });
        left.flat_map(move |own| {
            let step = usize::try_from(size.max(1)).unwrap_or(usize::MAX);
            let end = own.end;
            let firsts = own.step_by(step);
            firsts.map(move |first| first..first.saturating_add(size).min(end))
        })
    }

    /// Simulates on a GPU until all are done or it fails.
    fn on_gpu(
        &self,
        gpu: &Gpu,
        flown: &mut Flown,
        take: Take<'_>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Option<GpuError> {
        let start = Instant::now();
        let loops = GainSet::loops_of(self.gains);
        let tuning = self.options.tuning;
        let on_gpu = GroupSimulators::on_gpu(gpu, self.campaign, &loops, tuning);
        flown.loop_s += start.elapsed().as_secs_f64();
        let mut simulators = match on_gpu {
            Ok(simulators) => simulators,
            Err(error) => return Some(error),
        };
        let batch = simulators.batch();
        let engine = |gpu_times: GpuTimes| Engine::Gpu {
            adapter: gpu.adapter().clone(),
            batch,
            gpu_times,
        };
        self.on(&mut simulators, batch, &engine, flown, take, done)
    }

    /// Simulates what is left on the CPU.
    fn on_cpu(&self, flown: &mut Flown, take: Take<'_>, done: &(dyn Fn(u32) + Sync)) {
        if flown.enough || self.batches(flown.episodes, MOST).next().is_none() {
            return;
        }
        let start = Instant::now();
        let (options, loops) = (self.options, GainSet::loops_of(self.gains));
        let mut simulators =
            GroupSimulators::on_cpu(self.campaign, &loops, options.precision, options.simd);
        flown.loop_s += start.elapsed().as_secs_f64();
        let (simd, threads) = (simulators.simd(), self.pool.current_num_threads());
        let most = u32::try_from(threads).unwrap_or(MOST);
        let most = most.saturating_mul(PER_THREAD).clamp(FEWEST, MOST);
        let batch = match &self.campaign.stop {
            None => most,
            // Little is simulated in vain if batches are as short as the threads and the looks allow.
            Some(stop) => stop.every.clamp(FEWEST, most),
        };
        let engine = |_: GpuTimes| Engine::Cpu { simd, threads };
        // Nothing on the CPU fails.
        self.on(&mut simulators, batch, &engine, flown, take, done);
    }

    /// Simulates batch by batch, while one thread packs the batch after and another one unpacks and takes in the batch
    /// before; at most one waits on either side, so memory stays small.
    fn on(
        &self,
        simulators: &mut GroupSimulators<'_>,
        batch: u32,
        engine: &dyn Fn(GpuTimes) -> Engine,
        flown: &mut Flown,
        take: Take<'_>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Option<GpuError> {
        let (enough, mut failure) = (AtomicBool::new(false), None);
        let (packers, seen) = (simulators.packers(), &enough);
        // Where the episodes at hand may be the last, none is simulated before that is known.
        let waits = self.campaign.stop.is_some();
        let ranges: Vec<Range<u32>> = self.batches(flown.episodes, batch).collect();
        let mut before = GpuTimes::default();
        std::thread::scope(|scope| {
            let (ready, packed) = mpsc::sync_channel::<Packed>(1);
            let (sender, landed) = mpsc::sync_channel::<Flying>(1);
            let (answer, taken) = mpsc::channel::<()>();
            let packers = &packers;
            scope.spawn(move || {
                for range in ranges {
                    let packed = packers.pack(range, self.pool);
                    // Nobody wants another one.
                    if ready.send(packed).is_err() {
                        break;
                    }
                }
            });
            let taking = scope.spawn(move || self.taking(packers, landed, take, seen, &answer));
            let mut start = Instant::now();
            for packed in packed {
                if enough.load(Ordering::Relaxed) || (self.halt)() {
                    break;
                }
                let first = packed.range.start;
                let simulated = simulators.simulate(packed, self.pool, done);
                let loop_s = start.elapsed().as_secs_f64();
                flown.loop_s += loop_s;
                let landed = match simulated {
                    Ok(landed) => landed,
                    Err(error) => {
                        failure = Some(error);
                        break;
                    }
                };
                let times = simulators.gpu_times();
                let next = Flying {
                    first,
                    landed,
                    engine: engine(times - before),
                    loop_s,
                };
                before = times;
                // If nobody receives any more, taking has panicked, which is passed on below.
                if sender.send(next).is_err() || waits && taken.recv().is_err() {
                    break;
                }
                start = Instant::now();
            }
            drop(sender);
            let done = taking.join();
            let taken = done.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            flown.episodes += taken.episodes;
            flown.taking_s += taken.spent_s;
            flown.enough |= taken.enough;
            failure = failure.take().or(taken.failure);
        });
        failure
    }

    /// Unpacks what was simulated and hands it out, until there is no more or whoever takes it wants no more, of which
    /// `seen` tells; each batch is answered.
    fn taking(
        &self,
        packers: &Packers,
        landed: mpsc::Receiver<Flying>,
        take: Take<'_>,
        seen: &AtomicBool,
        answer: &mpsc::Sender<()>,
    ) -> Taken {
        let mut taken = Taken::default();
        for flying in landed {
            let start = Instant::now();
            if !seen.load(Ordering::Relaxed) {
                match packers.unpack(flying.landed, self.pool) {
                    Ok(groups) => {
                        let batch = Batch {
                            first: flying.first,
                            groups,
                            engine: flying.engine,
                            loop_s: flying.loop_s,
                        };
                        taken.episodes += u32::try_from(batch.len()).unwrap_or(u32::MAX);
                        taken.enough = take(batch).is_break();
                    }
                    Err(error) => taken.failure = Some(error),
                }
                let is_last = taken.enough || taken.failure.is_some();
                seen.store(is_last, Ordering::Relaxed);
            }
            taken.spent_s += start.elapsed().as_secs_f64();
            // Nobody may wait for it.
            let _ = answer.send(());
        }
        taken
    }
}

/// A batch between its simulation and whoever takes it.
struct Flying {
    first: u32,
    landed: Landed,
    engine: Engine,
    loop_s: f64,
}

/// What became of the batches that were handed out.
#[derive(Default)]
struct Taken {
    episodes: u32,
    spent_s: f64,
    /// Whether whoever took them wanted no more.
    enough: bool,
    failure: Option<GpuError>,
}
