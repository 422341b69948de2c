//! The lists of everything that acts on one agent's channels from outside, and what the loop keeps of them.

use super::delay_line::{Actuator, DelayLine};
use super::noise::{Noise, Turbulence};
use super::window::{IntermittentWindow, Window};
use crate::model::lanes::{Lane, Real};

/// A periodic signal; its list says of what shape.
#[derive(Clone, Copy)]
pub(crate) struct Oscillation<L: Lane> {
    /// Amplitude, while it is there.
    pub(crate) switch: Window<L>,
    /// 1 / smoothing of a square; nothing to the others.
    pub(crate) inverse_smoothing: L,
    pub(crate) phase: L::Turns,
    /// Turns per half step.
    pub(crate) advance: L::Turns,
    /// The amplitude of this step.
    pub(crate) held: L,
}

/// Everything that acts on one agent's channels from outside. Each list has an item per campaign entry that strikes
/// these channels, so what a campaign does not use is not there.
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

    /// Lost shares of the command.
    pub(crate) losses: Vec<[Window<L>; NC]>,
    /// Commands that replace the wanted one.
    pub(crate) hard_overs: Vec<[Window<L>; NC]>,
    pub(crate) command_biases: Vec<[Window<L>; NC]>,
    /// Shares of the other agents' commands that leak in.
    pub(crate) leaks: Vec<[Window<L>; NC]>,
    /// Largest changes of the command per step.
    pub(crate) rate_limits: Vec<[Window<L>; NC]>,
    /// By what share x and x' are measured too large.
    pub(crate) scales: Vec<[Window<L>; NC]>,
    pub(crate) sensor_biases: Vec<[Window<L>; NC]>,
    /// By what share of its first value the inertia grows.
    pub(crate) inertias: Vec<[Window<L>; NC]>,
    /// Forces that come with a shifted mass.
    pub(crate) weights: Vec<[Window<L>; NC]>,

    /// Lost shares of the command, now and then.
    pub(crate) intermittents: Vec<IntermittentWindow<L, NC>>,
    /// When the link brings no new command (the value is 1).
    pub(crate) command_holds: Vec<IntermittentWindow<L, NC>>,
    /// When the measurement stays what it was (the value is 1).
    pub(crate) sensor_holds: Vec<IntermittentWindow<L, NC>>,
    /// Sizes of measurements that are far off.
    pub(crate) outliers: Vec<IntermittentWindow<L, NC>>,

    pub(crate) noises: Vec<Noise<L, NC>>,
    pub(crate) turbulences: Vec<Turbulence<L, NC>>,

    /// amplitude sin(phase), part of d1.
    pub(crate) sines: Vec<[Oscillation<L>; NC]>,
    /// amplitude (1 + sin(phase)) / 2, part of d1; one turn of it is a gust, if it begins at the bottom.
    pub(crate) gusts: Vec<[Oscillation<L>; NC]>,
    /// amplitude sin(phase), added to the command.
    pub(crate) command_waves: Vec<[Oscillation<L>; NC]>,
    /// amplitude sin(phase), part of f2.
    pub(crate) sensor_waves: Vec<[Oscillation<L>; NC]>,
    /// amplitude tanh(sin(phase) / smoothing), part of f2.
    pub(crate) squares: Vec<[Oscillation<L>; NC]>,

    pub(crate) command_rings: Vec<DelayLine<L, NC, 1>>,
    /// Of x and x'.
    pub(crate) sensor_rings: Vec<DelayLine<L, NC, 2>>,

    /// What of d1 and of f2 is held over this step.
    pub(crate) held_disturbance: [L; NC],
    pub(crate) held_sensor: [L; NC],
    /// What faults leave of the command in this step, and what they add to it.
    pub(crate) command_gain: [L; NC],
    pub(crate) command_bias: [L; NC],
    /// By how much the acting command may change in a step.
    pub(crate) slew: [L; NC],
    /// Whether the link brings no new command (1 or 0).
    pub(crate) blocked: [L; NC],
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
    /// What is between the wanted command and the acting one at the current stage's time.
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
            losses: Vec::new(),
            hard_overs: Vec::new(),
            command_biases: Vec::new(),
            leaks: Vec::new(),
            rate_limits: Vec::new(),
            scales: Vec::new(),
            sensor_biases: Vec::new(),
            inertias: Vec::new(),
            weights: Vec::new(),
            intermittents: Vec::new(),
            command_holds: Vec::new(),
            sensor_holds: Vec::new(),
            outliers: Vec::new(),
            noises: Vec::new(),
            turbulences: Vec::new(),
            sines: Vec::new(),
            gusts: Vec::new(),
            command_waves: Vec::new(),
            sensor_waves: Vec::new(),
            squares: Vec::new(),
            command_rings: Vec::new(),
            sensor_rings: Vec::new(),
            held_disturbance: zero,
            held_sensor: zero,
            command_gain: one,
            command_bias: zero,
            slew: [L::splat(L::Real::MAX); NC],
            blocked: zero,
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

    /// Whether another command may arrive at the actuators than the one that is wanted now.
    pub(crate) fn carries(&self) -> bool {
        self.hold_steps > 1 || !self.command_rings.is_empty() || !self.command_holds.is_empty()
    }

    /// Whether a sampled controller gives a new command at the start of a step.
    pub(crate) fn ticks(&self, step: u32) -> bool {
        step.is_multiple_of(self.hold_steps)
    }

    /// Whether x and x' are not measured as they are.
    pub(crate) fn distorts(&self) -> bool {
        !self.scales.is_empty() || !self.sensor_holds.is_empty() || !self.sensor_rings.is_empty()
    }

    /// Whether anything of a step matters to the next.
    pub(crate) fn remembers(&self) -> bool {
        self.carries()
            || !self.rate_limits.is_empty()
            || !self.leaks.is_empty()
            || !self.sensor_holds.is_empty()
            || !self.sensor_rings.is_empty()
    }

    /// Whether what is held differs from step to step by more than switches turning on and off.
    pub(crate) fn is_restless(&self) -> bool {
        self.rises
            || self.remembers()
            || !self.noises.is_empty()
            || !self.turbulences.is_empty()
            || !self.intermittents.is_empty()
            || !self.outliers.is_empty()
    }
}
