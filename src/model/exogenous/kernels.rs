//! The signals of an agent, and what it feels of the others' jets, as kernels, which are compiled once per lane type
//! and number of channels, and not into every loop of every plant and controller.

use super::delay_line::Moment;
use super::evaluation::{self, HasSignals};
use super::friction::{self, Friction};
use super::inputs::ExogenousInputs;
use super::vortex::{self, Vortex};
use crate::model::lanes::{Kernel, Lane, MAX_WIDTH};
use std::marker::PhantomData;

/// [`ExogenousInputs::hold`], for the start of a step.
#[inline(always)]
pub(crate) fn hold<L: Lane, const NC: usize>(
    signals: &mut ExogenousInputs<L, NC>,
    step: u32,
    team: &[L; NC],
    seed: u64,
    episodes: &[u32; MAX_WIDTH],
) {
    L::dispatch(Hold {
        signals,
        step,
        team,
        seed,
        episodes,
    });
}

struct Hold<'a, L: Lane, const NC: usize> {
    signals: &'a mut ExogenousInputs<L, NC>,
    step: u32,
    team: &'a [L; NC],
    seed: u64,
    episodes: &'a [u32; MAX_WIDTH],
}

impl<L: Lane, const NC: usize> Kernel for Hold<'_, L, NC> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.signals
            .hold(self.step, self.team, self.seed, self.episodes);
        self.signals.evaluate(self.step, Moment::Start);
    }
}

/// [`evaluation::evaluate`], for the middle and the end of a step.
#[inline(always)]
pub(crate) fn evaluate<L: Lane, S: HasSignals<L, NC>, const NC: usize>(
    all: &mut [S],
    step: u32,
    moment: Moment,
) {
    L::dispatch(Evaluate {
        all,
        step,
        moment,
        lanes: PhantomData::<L>,
    });
}

struct Evaluate<'a, L, S, const NC: usize> {
    all: &'a mut [S],
    step: u32,
    moment: Moment,
    lanes: PhantomData<L>,
}

impl<L: Lane, S: HasSignals<L, NC>, const NC: usize> Kernel for Evaluate<'_, L, S, NC> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        evaluation::evaluate(self.all, self.step, self.moment);
    }
}

/// By how much x and x' are measured too large at a moment of the step, beside f2.
#[inline(always)]
pub(crate) fn distortion<L: Lane, const NC: usize>(
    signals: &ExogenousInputs<L, NC>,
    moment: Moment,
    motion: &[[L; NC]; 2],
) -> [[L; 2]; NC] {
    L::dispatch(Distortion {
        signals,
        moment,
        motion,
    })
}

struct Distortion<'a, L: Lane, const NC: usize> {
    signals: &'a ExogenousInputs<L, NC>,
    moment: Moment,
    motion: &'a [[L; NC]; 2],
}

impl<L: Lane, const NC: usize> Kernel for Distortion<'_, L, NC> {
    type Output = [[L; 2]; NC];
    #[inline(always)]
    fn run(self) -> Self::Output {
        let [position, velocity] = self.motion;
        let mut off = [[L::number(0.0); 2]; NC];
        for c in 0..NC {
            let motion = [position[c], velocity[c]];
            let [seen, seen_rate] = self.signals.measure(c, self.moment, motion);
            off[c] = [seen - position[c], seen_rate - velocity[c]];
        }
        off
    }
}

/// [`friction::friction_force`] of every channel.
#[inline(always)]
pub(crate) fn friction_forces<L: Lane, const NC: usize>(
    frictions: &[[Friction<L>; NC]],
    rates: &[L; NC],
) -> [L; NC] {
    L::dispatch(FrictionForces { frictions, rates })
}

struct FrictionForces<'a, L, const NC: usize> {
    frictions: &'a [[Friction<L>; NC]],
    rates: &'a [L; NC],
}

impl<L: Lane, const NC: usize> Kernel for FrictionForces<'_, L, NC> {
    type Output = [L; NC];
    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut forces = *self.rates;
        for (c, force) in forces.iter_mut().enumerate() {
            *force = friction::friction_force(self.frictions, c, self.rates[c]);
        }
        forces
    }
}

/// [`vortex::vortex_force`].
#[inline(always)]
pub(crate) fn vortex_force<L: Lane>(vortices: &[Vortex<L>], own: usize, places: &[[L; 3]]) -> L {
    L::dispatch(VortexForce {
        vortices,
        own,
        places,
    })
}

struct VortexForce<'a, L> {
    vortices: &'a [Vortex<L>],
    own: usize,
    places: &'a [[L; 3]],
}

impl<L: Lane> Kernel for VortexForce<'_, L> {
    type Output = L;
    #[inline(always)]
    fn run(self) -> L {
        vortex::vortex_force(self.vortices, self.own, self.places)
    }
}

/// [`ExogenousInputs::remember`] of every channel.
#[inline(always)]
pub(crate) fn remember<L: Lane, const NC: usize>(
    signals: &mut ExogenousInputs<L, NC>,
    step: u32,
    sent: &[L; NC],
    motion: &[[L; NC]; 2],
) {
    L::dispatch(Remember {
        signals,
        step,
        sent,
        motion,
    });
}

struct Remember<'a, L: Lane, const NC: usize> {
    signals: &'a mut ExogenousInputs<L, NC>,
    step: u32,
    sent: &'a [L; NC],
    motion: &'a [[L; NC]; 2],
}

impl<L: Lane, const NC: usize> Kernel for Remember<'_, L, NC> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let [position, velocity] = self.motion;
        for c in 0..NC {
            let motion = [position[c], velocity[c]];
            self.signals.remember(c, self.step, self.sent[c], motion);
        }
    }
}

/// Moves what follows a law of its own from a step to the next.
#[inline(always)]
pub(crate) fn end_step<L: Lane, const NC: usize>(
    signals: &mut ExogenousInputs<L, NC>,
    step: u32,
    seed: u64,
    episodes: &[u32; MAX_WIDTH],
) {
    if !signals.turbulences.is_empty() {
        L::dispatch(EndStep {
            signals,
            step,
            seed,
            episodes,
        });
    }
}

struct EndStep<'a, L: Lane, const NC: usize> {
    signals: &'a mut ExogenousInputs<L, NC>,
    step: u32,
    seed: u64,
    episodes: &'a [u32; MAX_WIDTH],
}

impl<L: Lane, const NC: usize> Kernel for EndStep<'_, L, NC> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for turbulence in &mut self.signals.turbulences {
            for c in 0..NC {
                turbulence.advance(c, self.step, self.seed, self.episodes);
            }
        }
    }
}
