//! Disturbances and faults of one agent's channels: what is held over a step, and what varies within it.
//!
//! Switches are evaluated at the start of a step and held through its stages, or the method would lose its order; noise is
//! drawn once per step. The periodic parts are evaluated at each stage's time, from phases that count in fixed point.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::lanes::{Lane, MAX_WIDTH};
use super::rng::{Address, Stream};

/// amplitude sin(phase).
#[derive(Clone, Copy)]
pub(crate) struct Sine<L: Lane> {
    pub(crate) amplitude: L,
    pub(crate) phase: L::Turns,
    /// Turns per half step.
    pub(crate) advance: L::Turns,
}

/// amplitude tanh(sin(phase) / smoothing), from its onset on.
#[derive(Clone, Copy)]
pub(crate) struct Square<L: Lane> {
    pub(crate) switch: Switch<L>,
    pub(crate) inverse_smoothing: L,
    pub(crate) phase: L::Turns,
    /// Turns per half step.
    pub(crate) advance: L::Turns,
    /// The amplitude of this step: zero before the onset.
    pub(crate) held: L,
}

/// A value that is there from a step on.
#[derive(Clone, Copy)]
pub(crate) struct Switch<L> {
    /// First step.
    pub(crate) onset: L,
    /// The value.
    pub(crate) value: L,
}

/// Normal noise of one agent, held over each step.
#[derive(Clone)]
pub(crate) struct Noise<L, const NC: usize> {
    /// Which fault of the campaign.
    pub(crate) entry: u32,
    /// Address of each channel.
    pub(crate) members: [u32; NC],
    /// Standard deviation, from the onset on.
    pub(crate) switch: [Switch<L>; NC],
    /// The samples of four steps: one counter gives them all.
    pub(crate) samples: [[L; 4]; NC],
}

/// Everything that acts on one agent's channels from outside. Each list has an item per campaign entry that strikes these
/// channels, so what a campaign does not use is not there.
#[derive(Clone)]
pub(crate) struct Signals<L: Lane, const NC: usize> {
    pub(crate) sines: Vec<[Sine<L>; NC]>,
    pub(crate) squares: Vec<[Square<L>; NC]>,
    pub(crate) constant: [L; NC],
    /// Scale of the ground's reaction: the sum of all that the campaign names.
    pub(crate) ground: [L; NC],
    pub(crate) losses: Vec<[Switch<L>; NC]>,
    pub(crate) command_biases: Vec<[Switch<L>; NC]>,
    pub(crate) sensor_biases: Vec<[Switch<L>; NC]>,
    pub(crate) noises: Vec<Noise<L, NC>>,
    /// Sensor bias and noise of this step.
    pub(crate) held_sensor: [L; NC],
    /// What actuator faults leave of the command in this step.
    pub(crate) command_gain: [L; NC],
    /// What actuator faults add to the command in this step.
    pub(crate) command_bias: [L; NC],
    /// d1 at the current stage's time.
    pub(crate) disturbance: [L; NC],
    /// f2 at the current stage's time.
    pub(crate) sensor_fault: [L; NC],
}

impl<L: Lane> Switch<L> {
    #[inline(always)]
    pub(crate) fn at(self, step: L, before: L) -> L {
        L::select_le(self.onset, step, self.value, before)
    }
}

impl<L: Lane, const NC: usize> Signals<L, NC> {
    /// No signal at all.
    pub(crate) fn none() -> Self {
        let (zero, one) = ([L::number(0.0); NC], [L::number(1.0); NC]);
        Self {
            sines: Vec::new(),
            squares: Vec::new(),
            constant: zero,
            ground: zero,
            losses: Vec::new(),
            command_biases: Vec::new(),
            sensor_biases: Vec::new(),
            noises: Vec::new(),
            held_sensor: zero,
            command_gain: one,
            command_bias: zero,
            disturbance: zero,
            sensor_fault: zero,
        }
    }

    /// Sets what is held over step number `step`.
    #[inline(always)]
    pub(crate) fn hold(&mut self, step: u32, seed: u64, episodes: &[u32; MAX_WIDTH]) {
        let (zero, one) = (L::number(0.0), L::number(1.0));
        let now = L::number(f64::from(step));
        for c in 0..NC {
            let mut gain = one;
            for loss in &self.losses {
                gain = gain * (one - loss[c].at(now, zero));
            }
            self.command_gain[c] = gain;
            let mut bias = zero;
            for added in &self.command_biases {
                bias = bias + added[c].at(now, zero);
            }
            self.command_bias[c] = bias;
            let mut sensor = zero;
            for added in &self.sensor_biases {
                sensor = sensor + added[c].at(now, zero);
            }
            for noise in &mut self.noises {
                if step.is_multiple_of(4) {
                    noise.draw(c, step / 4, seed, episodes);
                }
                let sample = noise.samples[c][(step % 4) as usize];
                sensor = sample.mul_add(noise.switch[c].at(now, zero), sensor);
            }
            self.held_sensor[c] = sensor;
            for square in &mut self.squares {
                square[c].held = square[c].switch.at(now, zero);
            }
        }
    }

    /// f2 at t = 0, which the observers' first measurement includes.
    pub(crate) fn at_start(mut self, seed: u64, episodes: &[u32; MAX_WIDTH]) -> [L; NC] {
        self.hold(0, seed, episodes);
        self.evaluate::<false>();
        self.sensor_fault
    }

    /// Evaluates d1 and f2 at the phases of the signals, after moving them on by half a step if `ADVANCE`.
    #[inline(always)]
    pub(crate) fn evaluate<const ADVANCE: bool>(&mut self) {
        self.disturbance = self.constant;
        self.sensor_fault = self.held_sensor;
        for sines in &mut self.sines {
            for c in 0..NC {
                let sine = &mut sines[c];
                if ADVANCE {
                    sine.phase = L::turns_add(sine.phase, sine.advance);
                }
                self.disturbance[c] =
                    L::turns_sin(sine.phase).mul_add(sine.amplitude, self.disturbance[c]);
            }
        }
        for squares in &mut self.squares {
            for c in 0..NC {
                let square = &mut squares[c];
                if ADVANCE {
                    square.phase = L::turns_add(square.phase, square.advance);
                }
                let shape = (L::turns_sin(square.phase) * square.inverse_smoothing).tanh();
                self.sensor_fault[c] = shape.mul_add(square.held, self.sensor_fault[c]);
            }
        }
    }
}

impl<L: Lane, const NC: usize> Noise<L, NC> {
    /// Draws the four samples of a channel that block number `index` holds (Box and Muller's transform, twice).
    #[inline(always)]
    pub(crate) fn draw(
        &mut self,
        channel: usize,
        index: u32,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let mut words = [[0; MAX_WIDTH]; 4];
        for lane in 0..L::WIDTH {
            let address = Address {
                episode: episodes[lane],
                stream: Stream::Noise,
                entry: self.entry,
                member: self.members[channel],
                index,
            };
            let drawn = address.words(seed);
            for k in 0..4 {
                words[k][lane] = drawn[k];
            }
        }
        for pair in 0..2 {
            let unit = L::unit_from_words(&words[2 * pair]);
            let radius = (unit.ln() * L::number(-2.0)).sqrt();
            let turn = L::turns_from_words(&words[2 * pair + 1]);
            let quarter = L::turns(&[0.25; MAX_WIDTH]);
            self.samples[channel][2 * pair] = radius * L::turns_sin(turn);
            self.samples[channel][2 * pair + 1] =
                radius * L::turns_sin(L::turns_add(turn, quarter));
        }
    }
}
