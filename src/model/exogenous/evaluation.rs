//! What acts on one agent's channels, as a step goes on: what switches, rises or is drawn is held over each step, and
//! periodic parts are evaluated at each stage's time.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::delay_line::Moment;
use super::inputs::ExogenousInputs;
use super::lists::turned;
use crate::model::lanes::{Lane, MAX_WIDTH};

/// What has signals: they themselves, or an agent.
pub(crate) trait HasSignals<L: Lane, const NC: usize> {
    /// Its signals.
    fn signals(&mut self) -> &mut ExogenousInputs<L, NC>;
}

impl<L: Lane, const NC: usize> HasSignals<L, NC> for ExogenousInputs<L, NC> {
    #[inline(always)]
    fn signals(&mut self) -> &mut Self {
        self
    }
}

/// Evaluates d1, f2 and the actuators of all agents at a moment of step number `step`, whose phases are half a step
/// further each. List by list: a sine takes long, but the next agent's need not wait for it.
#[inline(always)]
pub(crate) fn evaluate<L: Lane, S: HasSignals<L, NC>, const NC: usize>(
    all: &mut [S],
    step: u32,
    moment: Moment,
) {
    let advance = moment != Moment::Start;
    let half = L::number(0.5);
    // Agents that faults spare have shorter lists.
    let (mut sines, mut gusts, mut sensor_waves, mut squares) = (0, 0, 0, 0);
    for own in all.iter_mut() {
        let own = own.signals();
        sines = sines.max(own.lists.sines.len());
        gusts = gusts.max(own.lists.gusts.len());
        sensor_waves = sensor_waves.max(own.lists.sensor_waves.len());
        squares = squares.max(own.lists.squares.len());
        own.disturbance = own.held_disturbance;
        own.sensor_fault = own.held_sensor;
    }
    for k in 0..sines {
        for own in all.iter_mut() {
            let own = own.signals();
            let Some(sines) = own.lists.sines.get_mut(k) else {
                continue;
            };
            for c in 0..NC {
                let sine = turned(&mut sines[c], advance);
                own.disturbance[c] = sine.mul_add(sines[c].held, own.disturbance[c]);
            }
        }
    }
    for k in 0..gusts {
        for own in all.iter_mut() {
            let own = own.signals();
            let Some(gusts) = own.lists.gusts.get_mut(k) else {
                continue;
            };
            for c in 0..NC {
                let shape = turned(&mut gusts[c], advance).mul_add(half, half);
                own.disturbance[c] = shape.mul_add(gusts[c].held, own.disturbance[c]);
            }
        }
    }
    for k in 0..sensor_waves {
        for own in all.iter_mut() {
            let own = own.signals();
            let Some(waves) = own.lists.sensor_waves.get_mut(k) else {
                continue;
            };
            for c in 0..NC {
                let sine = turned(&mut waves[c], advance);
                own.sensor_fault[c] = sine.mul_add(waves[c].held, own.sensor_fault[c]);
            }
        }
    }
    for k in 0..squares {
        for own in all.iter_mut() {
            let own = own.signals();
            let Some(squares) = own.lists.squares.get_mut(k) else {
                continue;
            };
            for c in 0..NC {
                let sine = turned(&mut squares[c], advance);
                let shape = (sine * squares[c].inverse_smoothing).tanh();
                own.sensor_fault[c] = shape.mul_add(squares[c].held, own.sensor_fault[c]);
            }
        }
    }
    for own in all {
        own.signals().evaluate_command(step, moment);
    }
}

impl<L: Lane, const NC: usize> ExogenousInputs<L, NC> {
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
            for weight in &self.lists.weights {
                force = force + weight[c].at(now);
            }
            for turbulence in &self.turbulences {
                force = force + turbulence.force(c);
            }
            self.held_disturbance[c] = force;
            let mut grown = one;
            for inertia in &self.lists.inertias {
                grown = grown + inertia[c].at(now);
            }
            self.inverse_inertia[c] = self.first_inverse_inertia[c];
            if !self.lists.inertias.is_empty() {
                self.inverse_inertia[c] = self.first_inverse_inertia[c] / grown;
            }
            for waves in self.lists.waves_mut() {
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
        for added in &self.lists.sensor_biases {
            sensor = sensor + added[c].at(now);
        }
        for noise in &mut self.lists.noises {
            if step.is_multiple_of(4) {
                noise.draw(c, step / 4, seed, episodes);
            }
            let sample = noise.samples[c][(step % 4) as usize];
            sensor = sample.mul_add(noise.switch[c].at(now), sensor);
        }
        for outlier in &self.lists.outliers {
            let [size, sign] = outlier.at(c, step, seed, episodes);
            sensor = size.mul_add(sign, sensor);
        }
        self.held_sensor[c] = sensor;
        let mut scale = zero;
        for added in &self.lists.scales {
            scale = scale + added[c].at(now);
        }
        self.scale[c] = scale;
        let mut frozen = zero;
        for hold in &self.lists.sensor_holds {
            let [holds, _] = hold.at(c, step, seed, episodes);
            frozen = frozen.max(holds);
        }
        self.frozen[c] = if step == 0 { zero } else { frozen };
        for ring in &mut self.lists.sensor_rings {
            ring.hold(c, step);
        }
    }

    /// [`evaluate`] for these alone.
    #[inline(always)]
    pub(crate) fn evaluate(&mut self, step: u32, moment: Moment) {
        evaluate(std::slice::from_mut(self), step, moment);
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
        for ring in &self.lists.sensor_rings {
            seen = ring.recall(c, moment, seen);
        }
        let [last_position, last_velocity] = self.last_measured[c];
        let half = L::number(0.5);
        [
            L::select_le(half, self.frozen[c], last_position, seen[0]),
            L::select_le(half, self.frozen[c], last_velocity, seen[1]),
        ]
    }

    /// Takes in what was demanded and what was at the start of step number `step`.
    #[inline(always)]
    pub(crate) fn remember(&mut self, c: usize, step: u32, sent: L, motion: [L; 2]) {
        self.last_measured[c] = self.measure(c, Moment::Start, motion);
        self.last_command[c] = self.actuator.command(c, sent);
        self.remember_command(c, step, sent);
        let [position, velocity] = motion;
        let scale = self.scale[c];
        let mut seen = [
            position.mul_add(scale, position),
            velocity.mul_add(scale, velocity),
        ];
        for ring in &mut self.lists.sensor_rings {
            let recalled = ring.recall(c, Moment::Start, seen);
            ring.record(c, step, seen);
            seen = recalled;
        }
    }
}
