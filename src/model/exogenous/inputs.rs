//! Everything that acts on one agent's channels from outside, and what the loop keeps of it.

use super::actuator::{Actuator, HeldCommand};
use super::friction::Friction;
use super::lists::SignalLists;
use super::noise::Turbulence;
use crate::model::lanes::Lane;

/// Everything that acts on one agent's channels from outside.
#[derive(Clone)]
pub(crate) struct ExogenousInputs<L: Lane, const NC: usize> {
    /// Scale of the ground's reaction: the sum of all that the campaign names.
    pub(crate) ground: [L; NC],
    /// The part of d1 that is always there.
    pub(crate) constant: [L; NC],
    /// 1 / true inertia, before it changes.
    pub(crate) first_inverse_inertia: [L; NC],
    /// Steps for which a sampled controller holds its command; 1 for one that never rests.
    pub(crate) hold_steps: u32,
    /// Whether some fault comes little by little.
    pub(crate) rises: bool,

    pub(crate) lists: SignalLists<L, NC>,
    pub(crate) turbulences: Vec<Turbulence<L, NC>>,
    pub(crate) frictions: Vec<[Friction<L>; NC]>,

    /// What of d1 and of f2 is held over this step.
    pub(crate) held_disturbance: [L; NC],
    pub(crate) held_sensor: [L; NC],
    /// What faults do to the command in this step.
    pub(crate) command: HeldCommand<L, NC>,
    /// By what share x and x' are measured too large in this step.
    pub(crate) scale: [L; NC],
    /// Whether the measurement stays what it was (1 or 0).
    pub(crate) frozen: [L; NC],
    /// 1 / true inertia in this step.
    pub(crate) inverse_inertia: [L; NC],

    /// At the start of the last step: the command that the controller sent, the one that arrived at the actuator, the
    /// one that acted, and x and x' as measured.
    pub(crate) last_sent: [L; NC],
    pub(crate) last_arrived: [L; NC],
    pub(crate) last_command: [L; NC],
    pub(crate) last_measured: [[L; 2]; NC],

    /// d1 and f2 at the current stage's time.
    pub(crate) disturbance: [L; NC],
    pub(crate) sensor_fault: [L; NC],
    /// What is between the demanded command and the acting one at the current stage's time.
    pub(crate) actuator: Actuator<L, NC>,
}

impl<L: Lane, const NC: usize> ExogenousInputs<L, NC> {
    /// No signal at all.
    pub(crate) fn none() -> Self {
        let (zero, one) = ([L::number(0.0); NC], [L::number(1.0); NC]);
        Self {
            ground: zero,
            constant: zero,
            first_inverse_inertia: one,
            hold_steps: 1,
            rises: false,
            lists: SignalLists::none(),
            turbulences: Vec::new(),
            frictions: Vec::new(),
            held_disturbance: zero,
            held_sensor: zero,
            command: HeldCommand::sound(),
            scale: zero,
            frozen: zero,
            inverse_inertia: one,
            last_sent: zero,
            last_arrived: zero,
            last_command: zero,
            last_measured: [[L::number(0.0); 2]; NC],
            disturbance: zero,
            sensor_fault: zero,
            actuator: Actuator::sound(),
        }
    }

    /// Whether another command may arrive at the actuators than the one that is demanded now.
    pub(crate) fn carries(&self) -> bool {
        self.hold_steps > 1
            || !self.lists.command_rings.is_empty()
            || !self.lists.command_holds.is_empty()
    }

    /// Whether a sampled controller gives a new command at the start of a step.
    pub(crate) fn ticks(&self, step: u32) -> bool {
        step.is_multiple_of(self.hold_steps)
    }

    /// Whether x and x' are not measured as they are.
    pub(crate) fn distorts(&self) -> bool {
        !self.lists.scales.is_empty()
            || !self.lists.sensor_holds.is_empty()
            || !self.lists.sensor_rings.is_empty()
    }

    /// Whether anything of a step matters to the next.
    pub(crate) fn remembers(&self) -> bool {
        self.carries()
            || !self.lists.rate_limits.is_empty()
            || !self.lists.leaks.is_empty()
            || !self.lists.sensor_holds.is_empty()
            || !self.lists.sensor_rings.is_empty()
    }

    /// Whether what is held differs from step to step by more than switches turning on and off.
    pub(crate) fn is_restless(&self) -> bool {
        self.rises
            || self.remembers()
            || !self.lists.noises.is_empty()
            || !self.turbulences.is_empty()
            || !self.lists.intermittents.is_empty()
            || !self.lists.outliers.is_empty()
    }
}
