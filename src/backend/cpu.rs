//! The CPU backend: blocks of episodes over all cores, each block in the widest lanes that the processor has.

use super::EpisodeResult;
use crate::campaign::AgentGroup;
use crate::draw::{Episode, draw};
use crate::model::controller::kinds::Controller;
use crate::model::episode::{Model, Trace};
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

/// How episodes are laid side by side: so many of single precision, half as many of double.
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

    /// The layout that is asked for, if this processor can run it; else the widest.
    fn asked_or_widest(asked: Option<Self>) -> Self {
        let available = asked.filter(|simd| simd.is_available());
        available.unwrap_or_else(Self::widest)
    }
}

/// A campaign's controllers, ready in one precision and layout.
pub struct Cpu(Loop);

enum Loop {
    F64(Simulator<f64>, Simd),
    F32(Simulator<f32>, Simd),
}

/// The loop of a campaign in one precision, and its controllers by name and order.
struct Simulator<R> {
    group: AgentGroup,
    model: Model<R>,
    controllers: Vec<Controller<R>>,
}

/// `$body` with `$simulator`, and `$L` as the lanes of its layout.
macro_rules! with_lanes {
    ($loop:expr, |$simulator:ident, $L:ident| $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        use crate::model::lanes::{double, simd};
        match $loop {
            #[cfg(target_arch = "x86_64")]
            Loop::F64($simulator, Simd::Avx512) => {
                type $L = double::F64x8;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            Loop::F64($simulator, Simd::Avx2) => {
                type $L = double::F64x4;
                $body
            }
            Loop::F64($simulator, _) => {
                type $L = f64;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            Loop::F32($simulator, Simd::Avx512) => {
                type $L = simd::F32x16;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            Loop::F32($simulator, Simd::Avx2) => {
                type $L = simd::F32x8;
                $body
            }
            Loop::F32($simulator, _) => {
                type $L = f32;
                $body
            }
        }
    }};
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
        let layout = Simd::asked_or_widest(simd);
        Self(match precision {
            Precision::F64 => Loop::F64(Simulator::new(group, gains), layout),
            Precision::F32 => Loop::F32(Simulator::new(group, gains), layout),
        })
    }

    /// The layout that episodes have where one is asked for; none in double precision, in which all of them give the
    /// same bits.
    #[must_use]
    pub fn layout(precision: Precision, asked: Option<Simd>) -> Option<Simd> {
        (precision == Precision::F32).then(|| Simd::asked_or_widest(asked))
    }

    /// The layout in use; `None` in double precision.
    #[must_use]
    pub fn simd(&self) -> Option<Simd> {
        match self.0 {
            Loop::F64(..) => None,
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
        with_lanes!(&self.0, |simulator, L| simulator
            .simulate::<L>(episodes, done))
    }

    /// Simulates one episode under one controller and shows it every `every` steps.
    #[must_use]
    pub fn trace(&self, episode: u32, controller: usize, every: u32) -> Trace {
        let mut traces = match &self.0 {
            // The same bits as in lanes, of which all but one would be idle.
            Loop::F64(simulator, _) => simulator.trace::<f64>(&[episode], controller, every),
            Loop::F32(..) => self.traces(&[episode], controller, every),
        };
        traces.pop().unwrap_or_default()
    }

    /// The same of some episodes, which are simulated side by side.
    #[must_use]
    pub fn traces(&self, episodes: &[u32], controller: usize, every: u32) -> Vec<Trace> {
        with_lanes!(&self.0, |simulator, L| {
            let blocks = episodes.chunks(L::WIDTH);
            blocks
                .flat_map(|block| simulator.trace::<L>(block, controller, every))
                .collect()
        })
    }

    /// How many episodes are simulated side by side.
    #[must_use]
    pub fn lanes(&self) -> usize {
        with_lanes!(&self.0, |_simulator, L| L::WIDTH)
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
        episodes: &[u32],
        controller: usize,
        every: u32,
    ) -> Vec<Trace> {
        let drawn = episodes.iter().map(|&episode| draw(&self.group, episode));
        let drawn: Vec<Episode> = drawn.collect();
        self.model
            .trace::<L>(&self.controllers[controller], &drawn, every)
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
