//! What an agent of a world meets, and the random state that it is in.

use super::numbers::Numbers;
use super::shapes::RING_STEPS;
use super::tracked::Tracked;
use super::world::{Flies, World};
use crate::backend::gpu::signals::Lists;
use crate::draw::member;
use crate::model::agent::Agent;
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::delay_line::DelayLine;
use crate::model::exogenous::friction::Friction;
use crate::model::exogenous::lists::Oscillation;
use crate::model::exogenous::noise::{Filter, Noise, Turbulence};
use crate::model::exogenous::vortex::Vortex;
use crate::model::exogenous::window::{IntermittentWindow, Window};
use crate::model::inputs::ChannelInputs;
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::model::metric::{Extremes, Sums};

/// Purposes of random numbers.
const CONDITION: u32 = 1;
const STATE: u32 = 2;

/// Random signals of an agent, in the order of the shape's lists.
struct Random<'s> {
    numbers: Numbers,
    lists: &'s Lists,
    /// Around which onsets and ends lie.
    step: u32,
    /// Its number in the campaign.
    agent: usize,
    first: usize,
    /// How many bursts and rings there are already.
    bursts: usize,
    rings: usize,
}

impl Random<'_> {
    fn count(&self, list: &str) -> usize {
        self.lists.count(list)
    }

    /// When something is there: around the scene's step, and in the world's span. A ramp's middle is never met by a
    /// hair: the numbers of steps are odd.
    fn switch<L: Lane<Real = f32>>(&mut self, low: f64, high: f64) -> Window<L> {
        let now = f64::from(self.step);
        let onsets = [0.0, now, now + 1.0, 254.0, 256.0, f64::INFINITY];
        let never = f64::INFINITY;
        let ends = [never, never, never, now, now + 1.0, 255.0, 257.0];
        let ramps: &[f64] = if self.lists.restless {
            &[1.0, 3.0, 7.0, 701.0]
        } else {
            &[1.0]
        };
        Window {
            onset: L::number(self.numbers.one_of(&onsets)),
            end: L::number(self.numbers.one_of(&ends)),
            inverse_ramp: L::number(1.0 / self.numbers.one_of(ramps)),
            value: L::number(self.numbers.between(low, high)),
        }
    }

    fn switches<L: Lane<Real = f32>, const NC: usize>(
        &mut self,
        low: f64,
        high: f64,
    ) -> [Window<L>; NC] {
        std::array::from_fn(|_| self.switch(low, high))
    }

    fn plain<L: Lane<Real = f32>, const NC: usize>(
        &mut self,
        list: &str,
        low: f64,
        high: f64,
    ) -> Vec<[Window<L>; NC]> {
        (0..self.count(list))
            .map(|_| self.switches(low, high))
            .collect()
    }

    fn burst<L: Lane<Real = f32>, const NC: usize>(
        &mut self,
        list: &str,
        low: f64,
        high: f64,
    ) -> Vec<IntermittentWindow<L, NC>> {
        let count = self.count(list);
        let bursts = (0..count).map(|_| {
            let (entry, together) = self.lists.bursts[self.bursts];
            self.bursts += 1;
            IntermittentWindow {
                entry,
                together,
                members: std::array::from_fn(|c| {
                    let channel = if together { 0 } else { self.first + c };
                    member(self.agent, channel)
                }),
                switch: self.switches(low, high),
                slot_steps: std::array::from_fn(|_| [self.numbers.one_of(&[1, 3, 50]); MAX_WIDTH]),
                threshold: std::array::from_fn(|_| [self.numbers.word(); MAX_WIDTH]),
            }
        });
        bursts.collect()
    }

    fn waves<L: Lane<Real = f32>, const NC: usize>(
        &mut self,
        list: &str,
    ) -> Vec<[Oscillation<L>; NC]> {
        let count = self.count(list);
        let mut wave = || Oscillation {
            switch: self.switch(-1.0, 1.0),
            inverse_smoothing: L::number(self.numbers.between(1.0, 50.0)),
            phase: L::turns_from_words(&[self.numbers.word()]),
            advance: L::turns_from_words(&[self.numbers.word()]),
            held: L::number(0.0),
        };
        (0..count)
            .map(|_| std::array::from_fn(|_| wave()))
            .collect()
    }

    fn ring<L: Lane<Real = f32>, const NC: usize, const NV: usize>(
        &mut self,
        list: &str,
    ) -> Vec<DelayLine<L, NC, NV>> {
        let count = self.count(list);
        let lengths: [u32; RING_STEPS] = std::array::from_fn(|k| k as u32 + 1);
        let rings = (0..count).map(|_| {
            let records = self.lists.rings[self.rings];
            self.rings += 1;
            let length = std::array::from_fn(|_| [self.numbers.one_of(&lengths); MAX_WIDTH]);
            DelayLine::new(records, self.switches(1.0, 1.0), length)
        });
        rings.collect()
    }

    fn noises<L: Lane<Real = f32>, const NC: usize>(&mut self) -> Vec<Noise<L, NC>> {
        let members = std::array::from_fn(|c| member(self.agent, self.first + c));
        let entries = self.lists.noise_entries.iter();
        let noises = entries.map(|&entry| Noise {
            entry,
            members,
            switch: self.switches(0.1, 0.5),
            samples: [[L::number(0.0); 4]; NC],
        });
        noises.collect()
    }

    fn turbulences<L: Lane<Real = f32>, const NC: usize>(&mut self) -> Vec<Turbulence<L, NC>> {
        let members = std::array::from_fn(|c| member(self.agent, self.first + c));
        let mut some = || L::number(self.numbers.around(1.0));
        let entries = self.lists.turbulence_entries.iter();
        let turbulences = entries.map(|&entry| Turbulence {
            entry,
            members,
            filter: std::array::from_fn(|_| Filter {
                keep: some(),
                cross: some(),
                noise: std::array::from_fn(|_| some()),
                output: std::array::from_fn(|_| some()),
            }),
            state: std::array::from_fn(|_| [some(), some()]),
        });
        turbulences.collect()
    }

    fn frictions<L: Lane<Real = f32>, const NC: usize>(&mut self) -> Vec<[Friction<L>; NC]> {
        let mut some = |low, high| L::number(self.numbers.between(low, high));
        let mut friction = || Friction {
            coulomb: some(0.1, 2.0),
            inverse_smoothing: some(1.0, 100.0),
            viscous: some(0.05, 0.5),
        };
        let each = (0..self.lists.frictions).map(|_| std::array::from_fn(|_| friction()));
        each.collect()
    }
}

impl<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize> World<P, NC, NS, NX> {
    /// What an agent meets: signals of every kind that the shape has, switching around the scene's step and in its
    /// span.
    pub(super) fn condition<L: Lane<Real = f32>>(
        &self,
        scene: usize,
        agent: usize,
    ) -> ChannelInputs<L, NC> {
        let lists = &self.shape.lists;
        let mut random = Random {
            numbers: Numbers::new(CONDITION, scene, agent),
            lists,
            step: Self::step(scene),
            agent: self.shape.first_agent + agent,
            first: self.first,
            bursts: 0,
            rings: 0,
        };
        let mut signals = ExogenousInputs::none();
        signals.hold_steps = lists.hold_steps;
        signals.rises = lists.restless;
        signals.lists.losses = random.plain("losses", 0.0, 0.9);
        signals.lists.hard_overs = random.plain("hard_overs", -2.0, 2.0);
        signals.lists.command_biases = random.plain("command_biases", -0.5, 0.5);
        signals.lists.leaks = random.plain("leaks", 0.0, 0.3);
        signals.lists.rate_limits = random.plain("rate_limits", 0.0, 0.5);
        signals.lists.dead_zones = random.plain("dead_zones", 0.0, 0.5);
        signals.lists.scales = random.plain("scales", -0.3, 0.3);
        signals.lists.sensor_biases = random.plain("sensor_biases", -0.5, 0.5);
        signals.lists.inertias = random.plain("inertias", 0.0, 0.5);
        signals.lists.weights = random.plain("weights", -0.5, 0.5);
        signals.lists.noises = random.noises();
        signals.lists.intermittents = random.burst("intermittents", 0.0, 0.9);
        signals.lists.command_holds = random.burst("command_holds", 1.0, 1.0);
        signals.lists.sensor_holds = random.burst("sensor_holds", 1.0, 1.0);
        signals.lists.outliers = random.burst("outliers", 1.0, 3.0);
        signals.lists.sines = random.waves("sines");
        signals.lists.gusts = random.waves("gusts");
        signals.lists.command_waves = random.waves("command_waves");
        signals.lists.sensor_waves = random.waves("sensor_waves");
        signals.lists.squares = random.waves("squares");
        signals.lists.command_rings = random.ring("command_rings");
        signals.lists.sensor_rings = random.ring("sensor_rings");
        signals.turbulences = random.turbulences();
        signals.frictions = random.frictions();
        let first_fault = random.switch::<L>(0.0, 0.0).onset;
        let numbers = &mut random.numbers;
        let mut some = |low, high| L::number(numbers.between(low, high));
        signals.constant = std::array::from_fn(|_| some(-0.5, 0.5));
        signals.ground = std::array::from_fn(|_| some(-1.0, 1.0));
        signals.first_inverse_inertia = std::array::from_fn(|_| some(0.3, 3.0));
        assert_eq!(
            Lists::of(&signals, lists.vortices, lists.ring_steps),
            *lists,
            "the flags are those of the model"
        );
        ChannelInputs {
            initial: std::array::from_fn(|_| std::array::from_fn(|_| some(-1.0, 1.0))),
            signals,
            kappa: some(-0.1, 0.1),
            vortices: (0..lists.vortices)
                .map(|_| Vortex {
                    force: some(0.5, 3.0),
                    inverse_radius: some(0.3, 2.0),
                    inverse_length: some(0.5, 4.0),
                })
                .collect(),
            first_fault,
        }
    }

    /// An agent in a random state.
    pub(super) fn agent(&self, scene: usize, agent: usize) -> Agent<Tracked, NC, NS, NX> {
        let mut numbers = Numbers::new(STATE, scene, agent);
        let mut some = |size: f64| Tracked::number(numbers.around(size));
        let mut made = Agent::new(
            std::array::from_fn(|_| std::array::from_fn(|_| some(1.0))),
            self.condition(scene, agent),
        );
        for channel in &mut made.channels {
            channel.point = channel.point.map(|_| some(1.0));
            channel.sum = channel.sum.map(|_| some(1.0));
        }
        let extra = &mut made.extra;
        for states in [&mut extra.start, &mut extra.point, &mut extra.sum] {
            *states = states.map(|_| some(0.8));
        }
        for metrics in &mut made.metrics {
            for sums in [&mut metrics.recent, &mut metrics.total] {
                // Counts of steps are whole.
                *sums = Sums::from_fn(|k| match Sums::<Tracked>::NAMES[k] {
                    "limited" => some(200.0).abs().floor(),
                    _ => some(9.0).abs(),
                });
            }
            metrics.largest = Extremes::from_fn(|_| some(1.0).abs());
            metrics.outside = some(250.0).floor().max(Tracked::exact(-1.0));
            metrics.outside_before_fault = some(250.0).floor().max(Tracked::exact(-1.0));
        }
        made.held_feedback = made.held_feedback.map(|_| some(1.0));
        made.failed = Tracked::number(numbers.one_of(&[0.0, 100.0, 900.0, f64::INFINITY]));
        remembered(&mut made.signals, &mut numbers);
        if self.lost && scene.is_multiple_of(2) {
            let place = [
                1e30,
                -1e30,
                1e15,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::NAN,
            ];
            for (c, channel) in made.channels.iter_mut().enumerate() {
                channel.start[1] = Tracked::number(numbers.one_of(&place));
                channel.point[1] = Tracked::number(numbers.one_of(&place));
                made.signals.last_command[c] = Tracked::number(numbers.one_of(&place));
            }
        }
        made
    }
}

/// What an agent's signals hold and remember.
fn remembered<const NC: usize>(signals: &mut ExogenousInputs<Tracked, NC>, numbers: &mut Numbers) {
    let mut some = |size: f64| Tracked::number(numbers.around(size));
    for held in [
        &mut signals.held_disturbance,
        &mut signals.held_sensor,
        &mut signals.command.gain,
        &mut signals.command.bias,
        &mut signals.scale,
        &mut signals.last_sent,
        &mut signals.last_arrived,
        &mut signals.last_command,
        &mut signals.disturbance,
        &mut signals.sensor_fault,
        &mut signals.actuator.gain,
        &mut signals.actuator.bias,
    ] {
        *held = held.map(|_| some(1.0));
    }
    signals.command.slew = signals.command.slew.map(|_| some(0.5).abs());
    if !signals.lists.dead_zones.is_empty() {
        signals.actuator.dead_zone = Some([(); NC].map(|()| some(0.5).abs()));
    }
    signals.last_measured = signals.last_measured.map(|last| last.map(|_| some(1.0)));
    signals.inverse_inertia = signals
        .inverse_inertia
        .map(|_| some(1.3).abs() + Tracked::exact(0.3));
    // As the shader is given it, it is exact.
    signals.inverse_inertia = signals.inverse_inertia.map(|one| Tracked::exact(one.value));
    let waves = signals.lists.waves_mut();
    for wave in waves.into_iter().flatten().flatten() {
        wave.held = some(1.0);
    }
    for noise in &mut signals.lists.noises {
        noise.samples = noise.samples.map(|samples| samples.map(|_| some(2.0)));
    }
    for turbulence in &mut signals.turbulences {
        turbulence.state = turbulence.state.map(|state| state.map(|_| some(2.0)));
    }
    for c in 0..NC {
        signals.frozen[c] = Tracked::number(numbers.one_of(&[0.0, 1.0]));
        signals.command.blocked[c] = Tracked::number(numbers.one_of(&[0.0, 1.0]));
        let far = f64::from(f32::MAX);
        let (low, high) = (numbers.between(-1.0, 0.0), numbers.between(0.0, 1.0));
        let [low, high] = numbers.one_of(&[[-far, far], [low, high], [low, low]]);
        signals.actuator.low[c] = Tracked::number(low);
        signals.actuator.high[c] = Tracked::number(high);
    }
    signals
        .lists
        .command_rings
        .iter_mut()
        .for_each(|ring| fill(ring, numbers));
    signals
        .lists
        .sensor_rings
        .iter_mut()
        .for_each(|ring| fill(ring, numbers));
}

/// Fills a ring with samples.
fn fill<const NC: usize, const NV: usize>(
    ring: &mut DelayLine<Tracked, NC, NV>,
    numbers: &mut Numbers,
) {
    for c in 0..NC {
        ring.plays[c] = Tracked::exact(0.0);
        for place in 0..ring.length[c][0] {
            let sample = std::array::from_fn(|_| Tracked::number(numbers.around(1.0)));
            ring.record(c, place, sample);
        }
        ring.plays[c] = Tracked::number(numbers.one_of(&[0.0, 0.3, 0.7, 1.0]));
        for past in ring.past[c].as_flattened_mut() {
            *past = Tracked::number(numbers.around(1.0));
        }
    }
}
