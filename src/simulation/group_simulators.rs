//! The simulators of a campaign, one of each group of agents.

use crate::backend::EpisodeResult;
use crate::backend::cpu::{Cpu, Precision, Simd};
use crate::backend::gpu::{
    Gpu, GpuError, GpuSimulator, GpuTimes, LandedBatch, PackedBatch, Packer, Tuning,
};
use crate::campaign::Campaign;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::synthesis::LoopGains;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// The simulators of a campaign, one of each group of agents. Groups do not act on each other, so that one may be
/// simulated after the other.
pub(crate) enum GroupSimulators<'g> {
    /// On the CPU.
    Cpu(Vec<Cpu>),
    /// On a GPU.
    Gpu(Vec<GpuSimulator<'g>>),
}

/// A group of agents in one episode under one controller: how each agent ended, and what was kept of some instants.
#[derive(Debug, Clone)]
pub(crate) struct GroupTrace<T> {
    pub(crate) outcomes: Vec<AgentOutcome>,
    pub(crate) kept: Vec<T>,
}

/// What draws and packs the episodes of a batch, and unpacks how they ended, beside the simulators: a device that
/// simulates leaves the CPU free.
pub(crate) enum Packers {
    /// On the CPU, simulating is all there is to do.
    Cpu,
    /// On a GPU, of each group of agents.
    Gpu(Vec<Arc<Packer>>),
}

/// A range of episodes, ready to be simulated.
pub(crate) struct Packed {
    pub(crate) range: Range<u32>,
    /// Of each group of agents on a GPU.
    batches: Vec<PackedBatch>,
}

/// The same, simulated.
pub(crate) enum Landed {
    Cpu(Vec<Vec<EpisodeResult>>),
    Gpu(Vec<LandedBatch>),
}

impl Packers {
    /// Makes a range of episodes ready.
    pub(crate) fn pack(&self, range: Range<u32>, pool: &ThreadPool) -> Packed {
        let batches = match self {
            Self::Cpu => Vec::new(),
            Self::Gpu(groups) => {
                let pack = |own: &Arc<Packer>| own.pack(range.clone().collect());
                pool.install(|| groups.iter().map(pack).collect())
            }
        };
        Packed { range, batches }
    }

    /// How the episodes ended, `[group][episode]`.
    ///
    /// # Errors
    /// If what a GPU returned is not of these episodes.
    pub(crate) fn unpack(
        &self,
        landed: Landed,
        pool: &ThreadPool,
    ) -> Result<Vec<Vec<EpisodeResult>>, GpuError> {
        match (self, landed) {
            (_, Landed::Cpu(groups)) => Ok(groups),
            (Self::Cpu, Landed::Gpu(_)) => Ok(Vec::new()),
            (Self::Gpu(groups), Landed::Gpu(landed)) => {
                let groups = groups.iter().zip(landed);
                let groups = groups.map(|(own, landed)| own.unpack(landed));
                pool.install(|| groups.collect())
            }
        }
    }
}

/// What is kept of an instant.
type Keep<'a, T> = &'a (dyn Fn(&Snapshot) -> T + Sync);

impl<'g> GroupSimulators<'g> {
    /// On the CPU; `gains` are those of each group's controllers, `[group][controller][channel group]`.
    pub(crate) fn on_cpu(
        campaign: &Campaign,
        gains: &[Vec<Vec<LoopGains>>],
        precision: Precision,
        simd: Option<Simd>,
    ) -> Self {
        let groups = campaign.groups().iter().zip(gains);
        let simulator = groups.map(|(group, gains)| Cpu::new(group, gains, precision, simd));
        Self::Cpu(simulator.collect())
    }

    /// On a GPU.
    ///
    /// # Errors
    /// If the campaign does not fit the adapter, or its driver refuses the shaders.
    pub(crate) fn on_gpu(
        gpu: &'g Gpu,
        campaign: &Campaign,
        gains: &[Vec<Vec<LoopGains>>],
        tuning: Tuning,
    ) -> Result<Self, GpuError> {
        let groups = campaign.groups().iter().zip(gains);
        let simulators = groups.map(|(group, gains)| GpuSimulator::new(gpu, group, gains, tuning));
        Ok(Self::Gpu(simulators.collect::<Result<_, _>>()?))
    }

    /// The layout of lanes in use; none in double precision and on a GPU.
    pub(crate) fn simd(&self) -> Option<Simd> {
        match self {
            Self::Cpu(groups) => groups.first()?.simd(),
            Self::Gpu(_) => None,
        }
    }

    /// Episodes that may be simulated at once, at most.
    pub(crate) fn batch(&self) -> u32 {
        match self {
            Self::Cpu(_) => u32::MAX,
            Self::Gpu(groups) => groups.iter().map(GpuSimulator::batch).min().unwrap_or(1),
        }
    }

    /// Times on the GPU so far.
    pub(crate) fn gpu_times(&self) -> GpuTimes {
        match self {
            Self::Cpu(_) => GpuTimes::default(),
            Self::Gpu(groups) => groups.iter().map(GpuSimulator::times).sum(),
        }
    }

    /// What packs and unpacks episodes for these.
    pub(crate) fn packers(&self) -> Packers {
        match self {
            Self::Cpu(_) => Packers::Cpu,
            Self::Gpu(groups) => Packers::Gpu(groups.iter().map(GpuSimulator::packer).collect()),
        }
    }

    /// Simulates at most [`GroupSimulators::batch`] episodes under every controller; `done` is told of episodes, each
    /// of which counts when all its groups are done.
    ///
    /// # Errors
    /// If the GPU fails; nothing of the range is known then.
    pub(crate) fn simulate(
        &mut self,
        packed: Packed,
        pool: &ThreadPool,
        done: &(dyn Fn(u32) + Sync),
    ) -> Result<Landed, GpuError> {
        let counted = AtomicU32::new(0);
        let count = |groups: u32, episodes: u32| {
            let before = counted.fetch_add(episodes, Ordering::Relaxed);
            done((before + episodes) / groups - before / groups);
        };
        match self {
            Self::Cpu(groups) => {
                let done = |episodes| count(small(groups.len()), episodes);
                let of_group = |cpu: &Cpu| cpu.simulate(packed.range.clone(), &done);
                let simulate = || groups.iter().map(of_group).collect();
                Ok(Landed::Cpu(pool.install(simulate)))
            }
            Self::Gpu(groups) => {
                let all = small(groups.len());
                let done = |episodes| count(all, episodes);
                let groups = groups.iter_mut().zip(packed.batches);
                let landed = groups.map(|(simulator, packed)| simulator.fly(packed, &done));
                landed.collect::<Result<_, _>>().map(Landed::Gpu)
            }
        }
    }

    /// Simulates some episodes under every controller and keeps something of every instant that is `every` steps after
    /// the one before, from the start to the end: `[episode][controller][group]`.
    ///
    /// # Errors
    /// If the GPU fails.
    pub(crate) fn trace<T: Send>(
        &mut self,
        episodes: &[u32],
        controllers: usize,
        every: u32,
        keep: Keep<'_, T>,
    ) -> Result<Vec<Vec<Vec<GroupTrace<T>>>>, GpuError> {
        let groups = match self {
            Self::Cpu(groups) => {
                let lanes = groups.first().map_or(1, Cpu::lanes);
                let of_block = |block: &[u32]| {
                    let mut all: Vec<Vec<Vec<GroupTrace<T>>>> =
                        block.iter().map(|_| Vec::new()).collect();
                    for controller in 0..controllers {
                        let traced = traces_on_cpu(groups, block, controller, every, keep);
                        for (of_episode, traced) in all.iter_mut().zip(traced) {
                            of_episode.push(traced);
                        }
                    }
                    all
                };
                return Ok(episodes.par_chunks(lanes).flat_map_iter(of_block).collect());
            }
            Self::Gpu(groups) => groups,
        };
        let mut all: Vec<Vec<Vec<GroupTrace<T>>>> = Vec::new();
        all.resize_with(episodes.len(), || {
            (0..controllers).map(|_| Vec::new()).collect()
        });
        for simulator in groups {
            let traced = trace_on_gpu(simulator, episodes, controllers, every, keep)?;
            for (of_episode, traced) in all.iter_mut().zip(traced) {
                for (of_controller, traced) in of_episode.iter_mut().zip(traced) {
                    of_controller.push(traced);
                }
            }
        }
        Ok(all)
    }
}

/// Some episodes under one controller, `[episode][group]`.
fn traces_on_cpu<T>(
    groups: &[Cpu],
    episodes: &[u32],
    controller: usize,
    every: u32,
    keep: Keep<'_, T>,
) -> Vec<Vec<GroupTrace<T>>> {
    let mut all: Vec<Vec<GroupTrace<T>>> = episodes.iter().map(|_| Vec::new()).collect();
    for cpu in groups {
        let traces = match episodes {
            [episode] => vec![cpu.trace(*episode, controller, every)],
            episodes => cpu.traces(episodes, controller, every),
        };
        for (of_episode, (outcomes, snapshots)) in all.iter_mut().zip(traces) {
            let kept = snapshots.iter().map(keep).collect();
            of_episode.push(GroupTrace { outcomes, kept });
        }
    }
    all
}

/// One episode under one controller, `[group]`.
pub(crate) fn trace_on_cpu<T>(
    groups: &[Cpu],
    episode: u32,
    controller: usize,
    every: u32,
    keep: Keep<'_, T>,
) -> Vec<GroupTrace<T>> {
    let mut all = traces_on_cpu(groups, &[episode], controller, every, keep);
    all.pop().unwrap_or_default()
}

/// `[episode][controller]`.
fn trace_on_gpu<T>(
    simulator: &mut GpuSimulator<'_>,
    episodes: &[u32],
    controllers: usize,
    every: u32,
    keep: Keep<'_, T>,
) -> Result<Vec<Vec<GroupTrace<T>>>, GpuError> {
    let of_controllers = || (0..controllers).map(|_| Vec::new()).collect();
    let mut kept: Vec<Vec<Vec<T>>> = episodes.iter().map(|_| of_controllers()).collect();
    let simulated = simulator.trace(episodes, every, &mut |instant| {
        for (episode, kept) in kept.iter_mut().enumerate() {
            for (controller, kept) in kept.iter_mut().enumerate() {
                kept.push(keep(&Snapshot {
                    step: instant.step,
                    agents: instant.agents(episode, controller),
                    internals: Vec::new(),
                }));
            }
        }
    })?;
    let of_episode = |(simulated, kept): (EpisodeResult, Vec<Vec<T>>)| {
        let pairs = simulated.outcomes.into_iter().zip(kept);
        pairs
            .map(|(outcomes, kept)| GroupTrace { outcomes, kept })
            .collect()
    };
    Ok(simulated.into_iter().zip(kept).map(of_episode).collect())
}

/// A number of groups.
fn small(groups: usize) -> u32 {
    u32::try_from(groups).unwrap_or(u32::MAX).max(1)
}
