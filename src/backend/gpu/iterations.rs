//! How many steps a dispatch may take: a bound on the iterations of all loops that one invocation goes through, stated
//! for every adapter.
//!
//! A loop counts once for each look at its condition, the last one included. Every loop of `shaders/` counts, though
//! short ones are written out and a compiler unrolls others: which ones depends on the driver's estimate of their cost.
//! A loop that a campaign may leave out counts where it is there.

use super::GpuError;
use super::adapter::AdapterKind;
use super::device::Gpu;
use super::layout::{N_EXTREMES, N_SUMS, SHOWN_WORDS};
use super::shape::Shape;
use crate::model::agent::Coupling;
use crate::model::controller::observer_feedback::FTC_STATES;
use crate::model::exogenous::lists::{LISTS, WAVE_LISTS};
use crate::random::philox::ROUNDS;

/// Mesa's software drivers (llvmpipe) end all loops of an invocation after 65,535 iterations in all (`lp_bld_limits.h`,
/// `LP_MAX_TGSI_LOOP_ITERATIONS`). They report nothing: the steps that are left are skipped, and the numbers are wrong.
/// The bound is a little lower because a driver may add loops of its own, for example to clear workgroup memory. Other
/// software drivers have no such limit that we know of; the bound costs them nothing, since a dispatch of so many
/// iterations takes much longer than its submission.
const SOFTWARE: u64 = 65_000;

/// No hardware driver ends a loop. What counts there is that a dispatch is short beside the seconds after which a
/// display driver resets the device. The time of the last dispatch sees to that; this bound keeps what is asked for by
/// hand, and a measurement that was off, within reason. A step has at least 50 iterations and takes microseconds, so
/// 20,000 of them take about 0.1 s on a device that is not full.
const HARDWARE: u64 = 1 << 20;

/// Iterations of the loops that an invocation goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Iterations {
    /// In a step, at most.
    pub(crate) per_step: u64,
    /// In a dispatch beside its steps, at most, whatever its entry point.
    pub(crate) beside: u64,
}

impl Iterations {
    /// In a dispatch of so many steps, at most.
    pub(crate) fn in_steps(self, steps: u32) -> u64 {
        self.beside + u64::from(steps) * self.per_step
    }

    /// The steps of a dispatch whose iterations stay within a limit; none if a single step exceeds it.
    pub(crate) fn steps_within(self, limit: u64) -> Option<u32> {
        let steps = limit.checked_sub(self.beside)? / self.per_step;
        let steps = u32::try_from(steps).unwrap_or(u32::MAX);
        (steps > 0).then_some(steps)
    }
}

impl AdapterKind {
    /// Iterations of its loops that an invocation may have in a dispatch.
    pub(crate) fn most_iterations(self) -> u64 {
        match self {
            Self::Discrete | Self::Integrated | Self::Virtual => HARDWARE,
            // What does not say what it is may be a software driver.
            Self::Software | Self::Other => SOFTWARE,
        }
    }
}

impl Shape {
    /// Iterations of the loops of these shaders.
    pub(crate) fn iterations(&self) -> Iterations {
        let lists = &self.lists;
        let [bursts, waves, rings] = lists.groups().map(|count| count as u64);
        let (team, switches) = (self.team as u64, lists.switches() as u64);
        let turbulences = lists.turbulence_entries.len() as u64;
        let (noises, vortices) = (lists.noise_entries.len() as u64, lists.vortices as u64);
        let frictions = lists.frictions as u64;
        let if_there = |is_there: bool, iterations: u64| if is_there { iterations } else { 0 };
        // A loop looks at its condition once more than it runs.
        let passes = |count: u64| count + 1;
        let random = passes(u64::from(ROUNDS));

        // Signals that are evaluated: a loop of each list of waves, and one of the rings of commands.
        let evaluate = waves + WAVE_LISTS as u64 + passes(rings);
        // What is held over a step: a loop of each list, one of turbulences, the sum of the commands that leak, and
        // when it changes next.
        let hold = if_there(lists.leaks(), passes(team))
            + switches
            + LISTS.len() as u64
            + passes(turbulences)
            + (bursts + noises) * random
            + evaluate
            + passes(switches);
        // A stage: the sum over the team, frictions, the jets of the others, what is measured of the past.
        let coupled = self.coupling != Coupling::None;
        let stage = if_there(coupled, passes(team))
            + if_there(frictions > 0, passes(frictions))
            + if_there(vortices > 0, passes(vortices) + vortices * passes(team))
            + passes(rings);
        // Taking in the start of a step: what is measured, and the rings of commands and of measurements.
        let remember = 3 * passes(rings);
        let end = passes(turbulences) + turbulences * random;
        let step = 1;
        let per_step = step + hold + 2 * evaluate + 4 * stage + remember + end;

        // Every dispatch takes the signals from the draw, holds them, and ends the loop over its steps; `show` has one
        // stage more, and `start` and `finish` have loops over words.
        let words = passes(SHOWN_WORDS as u64)
            + passes(FTC_STATES as u64)
            + 2 * passes(N_SUMS as u64)
            + passes(N_EXTREMES as u64)
            + passes(2 * turbulences);
        let beside = passes(waves) + hold + step + stage + words;
        Iterations { per_step, beside }
    }

    /// The steps that a dispatch may take on an adapter.
    ///
    /// # Errors
    /// If a single step has more iterations than the adapter's loops may have.
    pub(super) fn most_steps(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let (iterations, adapter) = (self.iterations(), gpu.adapter());
        let limit = adapter.kind.most_iterations();
        iterations
            .steps_within(limit)
            .ok_or_else(|| GpuError::TooLarge {
                adapter: adapter.name.clone(),
                what: "a step of this team and its signals, in iterations of loops,",
                needed: iterations.in_steps(1),
                limit,
            })
    }
}
