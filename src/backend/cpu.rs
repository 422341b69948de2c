//! The CPU backend: blocks of episodes over all cores, each block in the widest lanes that the processor has.

use super::EpisodeResult;
use crate::campaign::AgentGroup;
use crate::draw::{Episode, draw};
use crate::model::controller::kinds::Controller;
use crate::model::episode::{AgentOutcome, Model, Snapshot};
use crate::model::lanes::{Lane, MAX_WIDTH, Real};
use crate::synthesis::LoopGains;
use rayon::prelude::*;
use std::ops::Range;

/// Number format of the episode loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Double: the reference.
    F64,
    /// Single: the default, in SIMD lanes where the processor has them.
    F32,
}

/// How single-precision episodes are laid side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Simd {
    /// One at a time, without fused multiply-add.
    Scalar,
    /// Eight, with AVX2 and FMA.
    Avx2,
    /// Sixteen, with AVX-512 F and DQ.
    Avx512,
}

impl Simd {
    /// Every layout, narrowest first.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Avx2, Self::Avx512];

    /// Whether this processor can run it.
    #[must_use]
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            Self::Scalar => true,
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq")
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Self::Scalar
        }
    }

    /// The widest layout of this processor.
    #[must_use]
    pub fn widest() -> Self {
        Self::ALL
            .into_iter()
            .rev()
            .find(|simd| simd.is_available())
            .unwrap_or(Self::Scalar)
    }
}

/// A campaign's controllers, ready in one precision and layout.
pub struct Cpu(Loop);

enum Loop {
    F64(Simulator<f64>),
    F32(Simulator<f32>, Simd),
}

/// The loop of a campaign in one precision, and its controllers by name and order.
struct Simulator<R> {
    group: AgentGroup,
    model: Model<R>,
    controllers: Vec<Controller<R>>,
}

impl Cpu {
    /// Prepares a campaign: tabulates the references and rounds the gains; `gains` are those of each of the campaign's
    /// controllers on each channel group. A layout that the processor lacks is replaced by the widest
    /// it has; [`Cpu::simd`] says which is used.
    #[must_use]
    pub fn new(
        group: &AgentGroup,
        gains: &[Vec<LoopGains>],
        precision: Precision,
        simd: Option<Simd>,
    ) -> Self {
        Self(match Self::layout(precision, simd) {
            None => Loop::F64(Simulator::new(group, gains)),
            Some(simd) => Loop::F32(Simulator::new(group, gains), simd),
        })
    }

    /// The layout that episodes have where one is asked for; none in double precision.
    #[must_use]
    pub fn layout(precision: Precision, asked: Option<Simd>) -> Option<Simd> {
        let available = asked.filter(|simd| simd.is_available());
        (precision == Precision::F32).then(|| available.unwrap_or_else(Simd::widest))
    }

    /// The layout in use; `None` in double precision.
    #[must_use]
    pub fn simd(&self) -> Option<Simd> {
        match self.0 {
            Loop::F64(_) => None,
            Loop::F32(_, simd) => Some(simd),
        }
    }

    /// Simulates a range of episodes under every controller, in order; `done` is told of each finished block's
    /// episodes.
    #[must_use]
    pub fn simulate(
        &self,
        episodes: Range<u32>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Vec<EpisodeResult> {
        match &self.0 {
            Loop::F64(simulator) => simulator.simulate::<f64>(episodes, done),
            Loop::F32(simulator, simd) => match simd {
                Simd::Scalar => simulator.simulate::<f32>(episodes, done),
                #[cfg(target_arch = "x86_64")]
                Simd::Avx2 => {
                    simulator.simulate::<crate::model::lanes::simd::F32x8>(episodes, done)
                }
                #[cfg(target_arch = "x86_64")]
                Simd::Avx512 => {
                    simulator.simulate::<crate::model::lanes::simd::F32x16>(episodes, done)
                }
                #[cfg(not(target_arch = "x86_64"))]
                _ => simulator.simulate::<f32>(episodes, done),
            },
        }
    }

    /// Simulates one episode under one controller and shows it every `every` steps.
    #[must_use]
    pub fn trace(
        &self,
        episode: u32,
        controller: usize,
        every: u32,
    ) -> (Vec<AgentOutcome>, Vec<Snapshot>) {
        match &self.0 {
            Loop::F64(simulator) => simulator.trace::<f64>(episode, controller, every),
            Loop::F32(simulator, simd) => {
                match simd {
                    Simd::Scalar => simulator.trace::<f32>(episode, controller, every),
                    #[cfg(target_arch = "x86_64")]
                    Simd::Avx2 => simulator
                        .trace::<crate::model::lanes::simd::F32x8>(episode, controller, every),
                    #[cfg(target_arch = "x86_64")]
                    Simd::Avx512 => simulator
                        .trace::<crate::model::lanes::simd::F32x16>(episode, controller, every),
                    #[cfg(not(target_arch = "x86_64"))]
                    _ => simulator.trace::<f32>(episode, controller, every),
                }
            }
        }
    }
}

impl<R: Real> Simulator<R> {
    fn new(group: &AgentGroup, gains: &[Vec<LoopGains>]) -> Self {
        let controllers = gains.iter().map(|groups| Controller::new(groups)).collect();
        Self {
            group: group.clone(),
            model: Model::new(group),
            controllers,
        }
    }

    fn simulate<L: Lane<Real = R>>(
        &self,
        episodes: Range<u32>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Vec<EpisodeResult> {
        let blocks: Vec<Range<u32>> = blocks(episodes);
        blocks
            .into_par_iter()
            .flat_map_iter(|block| {
                let count = block.end - block.start;
                let episodes: Vec<Episode> =
                    block.map(|episode| draw(&self.group, episode)).collect();
                let mut simulated: Vec<EpisodeResult> = episodes
                    .iter()
                    .map(|episode| EpisodeResult {
                        episode: episode.clone(),
                        outcomes: Vec::new(),
                    })
                    .collect();
                for controller in &self.controllers {
                    let outcomes = episodes
                        .chunks(L::WIDTH)
                        .flat_map(|part| self.model.simulate::<L>(controller, part));
                    for (simulated, outcome) in simulated.iter_mut().zip(outcomes) {
                        simulated.outcomes.push(outcome);
                    }
                }
                done(count);
                simulated
            })
            .collect()
    }

    fn trace<L: Lane<Real = R>>(
        &self,
        episode: u32,
        controller: usize,
        every: u32,
    ) -> (Vec<AgentOutcome>, Vec<Snapshot>) {
        self.model.trace::<L>(
            &self.controllers[controller],
            &draw(&self.group, episode),
            every,
        )
    }
}

/// Ranges of at most [`MAX_WIDTH`] episodes.
fn blocks(episodes: Range<u32>) -> Vec<Range<u32>> {
    const WIDTH: u32 = 16;
    const { assert!(WIDTH as usize == MAX_WIDTH) };
    (episodes.start..episodes.end)
        .step_by(MAX_WIDTH)
        .map(|first| first..first.saturating_add(WIDTH).min(episodes.end))
        .collect()
}
