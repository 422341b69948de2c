//! Disturbances and faults of one agent's channels: what is held over a step, and what varies within it.
//!
//! What switches, rises or is drawn is held over each step. Periodic parts are evaluated at each stage's time.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

mod command_path;
pub(crate) mod delay_line;
pub(crate) mod dryden;
pub(crate) mod kernels;
pub(crate) mod noise;
pub(crate) mod vortex;
pub(crate) mod window;

use super::lanes::{Lane, MAX_WIDTH, Real};
use delay_line::{Actuator, DelayLine, Moment};
use kernels::distortion;
use noise::{Noise, Turbulence};
use window::{IntermittentWindow, Window};

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

/// Everything that acts on one agent's channels from outside. Each list has an item per campaign entry that strikes these
/// channels, so what a campaign does not use is not there.
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

    /// At the start of the last step: the command that the controller sent, the one that arrived at the actuator, the one that
    /// acted, and x and x' as measured.
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

    /// Sets what is held over step number `step`; `team` is the sum of the team's last commands.
    #[inline(always)]
    pub(crate) fn hold(
        &mut self,
        step: u32,
        team: &[L; NC],
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let one = L::number(1.0);
        let now = L::number(f64::from(step));
        for c in 0..NC {
            self.hold_command(c, step, team[c], seed, episodes);
            self.hold_sensor(c, step, seed, episodes);
            let mut force = self.constant[c];
            for weight in &self.weights {
                force = force + weight[c].at(now);
            }
            for turbulence in &self.turbulences {
                force = force + turbulence.force(c);
            }
            self.held_disturbance[c] = force;
            let mut grown = one;
            for inertia in &self.inertias {
                grown = grown + inertia[c].at(now);
            }
            self.inverse_inertia[c] = self.first_inverse_inertia[c];
            if !self.inertias.is_empty() {
                self.inverse_inertia[c] = self.first_inverse_inertia[c] / grown;
            }
            for waves in [
                &mut self.sines,
                &mut self.gusts,
                &mut self.command_waves,
                &mut self.sensor_waves,
                &mut self.squares,
            ] {
                for wave in waves {
                    wave[c].held = wave[c].switch.at(now);
                }
            }
        }
    }

    #[inline(always)]
    pub(crate) fn hold_sensor(
        &mut self,
        c: usize,
        step: u32,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let zero = L::number(0.0);
        let now = L::number(f64::from(step));
        let mut sensor = zero;
        for added in &self.sensor_biases {
            sensor = sensor + added[c].at(now);
        }
        for noise in &mut self.noises {
            if step.is_multiple_of(4) {
                noise.draw(c, step / 4, seed, episodes);
            }
            let sample = noise.samples[c][(step % 4) as usize];
            sensor = sample.mul_add(noise.switch[c].at(now), sensor);
        }
        for outlier in &self.outliers {
            let [size, sign] = outlier.at(c, step, seed, episodes);
            sensor = size.mul_add(sign, sensor);
        }
        self.held_sensor[c] = sensor;
        let mut scale = zero;
        for added in &self.scales {
            scale = scale + added[c].at(now);
        }
        self.scale[c] = scale;
        let mut frozen = zero;
        for hold in &self.sensor_holds {
            let [holds, _] = hold.at(c, step, seed, episodes);
            frozen = frozen.max(holds);
        }
        self.frozen[c] = if step == 0 { zero } else { frozen };
        for ring in &mut self.sensor_rings {
            ring.hold(c, step);
        }
    }

    /// f2 at t = 0, and by how much x and x' are measured too large then: what the observers' first measurement includes.
    pub(crate) fn at_start(
        mut self,
        [reference, reference_rate]: [[L; NC]; 2],
        initial: &[[L; 3]; NC],
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) -> ([L; NC], [[L; 2]; NC]) {
        self.hold(0, &[L::number(0.0); NC], seed, episodes);
        self.evaluate(0, Moment::Start);
        let position = std::array::from_fn(|c| reference[c] + initial[c][1]);
        let velocity = std::array::from_fn(|c| reference_rate[c] + initial[c][2]);
        let off = distortion(&self, Moment::Start, &[position, velocity]);
        (self.sensor_fault, off)
    }

    /// Evaluates d1, f2 and the actuators at a moment of step number `step`, whose phases are half a step further each.
    #[inline(always)]
    pub(crate) fn evaluate(&mut self, step: u32, moment: Moment) {
        let advance = moment != Moment::Start;
        let half = L::number(0.5);
        self.disturbance = self.held_disturbance;
        self.sensor_fault = self.held_sensor;
        if moment == Moment::Start || !self.command_waves.is_empty() || self.carries() {
            self.actuator.gain = self.command_gain;
            self.actuator.bias = self.command_bias;
        }
        for sines in &mut self.sines {
            for c in 0..NC {
                let sine = turned(&mut sines[c], advance);
                self.disturbance[c] = sine.mul_add(sines[c].held, self.disturbance[c]);
            }
        }
        for gusts in &mut self.gusts {
            for c in 0..NC {
                let shape = turned(&mut gusts[c], advance).mul_add(half, half);
                self.disturbance[c] = shape.mul_add(gusts[c].held, self.disturbance[c]);
            }
        }
        for waves in &mut self.sensor_waves {
            for c in 0..NC {
                let sine = turned(&mut waves[c], advance);
                self.sensor_fault[c] = sine.mul_add(waves[c].held, self.sensor_fault[c]);
            }
        }
        for squares in &mut self.squares {
            for c in 0..NC {
                let sine = turned(&mut squares[c], advance);
                let shape = (sine * squares[c].inverse_smoothing).tanh();
                self.sensor_fault[c] = shape.mul_add(squares[c].held, self.sensor_fault[c]);
            }
        }
        for waves in &mut self.command_waves {
            for c in 0..NC {
                let sine = turned(&mut waves[c], advance);
                self.actuator.bias[c] = sine.mul_add(waves[c].held, self.actuator.bias[c]);
            }
        }
        if self.carries() {
            self.carry_command(step, moment);
        }
        if !self.rate_limits.is_empty() {
            self.limit_rate(step, moment);
        }
    }

    /// x and x' as they are measured at a moment of the step.
    #[inline(always)]
    pub(crate) fn measure(&self, c: usize, moment: Moment, motion: [L; 2]) -> [L; 2] {
        let [position, velocity] = motion;
        let scale = self.scale[c];
        let mut seen = [
            position.mul_add(scale, position),
            velocity.mul_add(scale, velocity),
        ];
        for ring in &self.sensor_rings {
            seen = ring.recall(c, moment, seen);
        }
        let [last_position, last_velocity] = self.last_measured[c];
        let half = L::number(0.5);
        [
            L::select_le(half, self.frozen[c], last_position, seen[0]),
            L::select_le(half, self.frozen[c], last_velocity, seen[1]),
        ]
    }

    /// Takes in what was wanted and what was at the start of step number `step`.
    #[inline(always)]
    pub(crate) fn remember(&mut self, c: usize, step: u32, wanted: L, motion: [L; 2]) {
        self.last_measured[c] = self.measure(c, Moment::Start, motion);
        self.last_command[c] = self.actuator.command(c, wanted);
        self.remember_command(c, step, wanted);
        let [position, velocity] = motion;
        let scale = self.scale[c];
        let mut seen = [
            position.mul_add(scale, position),
            velocity.mul_add(scale, velocity),
        ];
        for ring in &mut self.sensor_rings {
            let recalled = ring.recall(c, Moment::Start, seen);
            ring.record(c, step, seen);
            seen = recalled;
        }
    }
}

/// The sine of a wave's phase, half a step later if it is to `advance`.
#[inline(always)]
pub(crate) fn turned<L: Lane>(wave: &mut Oscillation<L>, advance: bool) -> L {
    if advance {
        wave.phase = L::turns_add(wave.phase, wave.advance);
    }
    L::turns_sin(wave.phase)
}
