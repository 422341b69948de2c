//! From the draws of a fault to what it does to an agent's channels: the one place that says what each kind means.

use super::block::{LaneBlock, Selection, small};
use crate::agent::{Agent, FIRST_ATTITUDE, Uav};
use crate::campaign::kinds::{
    AMPLITUDE, DELAY, DRIFT_RATE, FREQUENCY, GROWTH, HALF_WIDTH, LARGEST_RATE, LOST_SHARE,
    MAGNITUDE, OFFSET_X, OFFSET_Y, PAYLOAD_MASS, PERIOD, PHASE, SHARE, SLOT, SMOOTHING, STD,
    WINDOW,
};
use crate::campaign::{Fault, FaultChannels, FaultKind, FaultTarget, Link, Parameter};
use crate::draw::{AgentDraw, FaultDraw, member};
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::delay_line::DelayLine;
use crate::model::exogenous::lists::{Oscillation, SignalLists};
use crate::model::exogenous::noise::Noise;
use crate::model::exogenous::window::{IntermittentWindow, Window};
use crate::model::lanes::{Lane, MAX_WIDTH};
use std::f64::consts::TAU;

/// A fault of one agent in the lanes of a block, and the channels from `first` on.
#[derive(Clone, Copy)]
pub(super) struct FaultLanes<'a> {
    pub(super) block: &'a LaneBlock<'a>,
    pub(super) fault: &'a Fault,
    /// Which fault of the campaign.
    pub(super) index: usize,
    pub(super) agent: usize,
    pub(super) first: usize,
}

/// What a changed mass does to a channel: by what share of it the inertia grows, and which force comes with it.
#[derive(Clone, Copy, Default)]
struct PlantChange {
    inertia: f64,
    force: f64,
}

impl FaultLanes<'_> {
    /// Adds what the fault does, if it may strike (or does) in some lane.
    pub(super) fn add<L: Lane, const NC: usize>(
        &self,
        signals: &mut ExogenousInputs<L, NC>,
        entries: Selection,
    ) {
        let fault = self.fault;
        let listed = match entries {
            Selection::Possible => may_strike(fault, self.first, NC),
            Selection::Acting => (0..NC).any(|c| self.strikes::<L>(c)),
        };
        if !listed {
            return;
        }
        let step_s = self.block.group.time.step_s;
        signals.rises |= fault.ramp_s.is_some() || fault.kind == FaultKind::Drift;
        let lists = &mut signals.lists;
        let values = |parameter: &Parameter, c: usize| self.values::<L>(parameter, c);
        let windows = |parameter: &Parameter| self.switches(&|c| values(parameter, c));
        let bursts = |value: &Parameter, slot_s: Option<&Parameter>| {
            self.bursts(&|c| values(value, c), slot_s, Some(&SHARE))
        };
        let one = [1.0; MAX_WIDTH];
        let held = |slot_s, share| self.bursts(&|_| one, slot_s, share);
        match fault.kind {
            FaultKind::LossOfEffectiveness => lists.losses.push(windows(&LOST_SHARE)),
            FaultKind::Float => lists.losses.push(self.switches(&|_| one)),
            FaultKind::Intermittent => lists.intermittents.push(bursts(&LOST_SHARE, Some(&SLOT))),
            FaultKind::HardOver => lists.hard_overs.push(windows(&MAGNITUDE)),
            FaultKind::Bias | FaultKind::FalseData | FaultKind::Drift => {
                let added = match fault.kind {
                    FaultKind::Drift => self.switches(&|c| self.drifted::<L>(c)),
                    _ => windows(&MAGNITUDE),
                };
                match fault.link {
                    Link::Measurement => lists.sensor_biases.push(added),
                    Link::Command => lists.command_biases.push(added),
                }
            }
            FaultKind::Stuck => lists.rate_limits.push(self.switches(&|_| [0.0; MAX_WIDTH])),
            FaultKind::RateLimit => {
                let limit = |c| values(&LARGEST_RATE, c).map(|rate| rate * step_s);
                lists.rate_limits.push(self.switches(&limit));
            }
            FaultKind::DeadZone => lists.dead_zones.push(windows(&HALF_WIDTH)),
            FaultKind::Oscillatory => {
                let waves = self.waves(&|c| values(&FREQUENCY, c).map(|w| w / TAU), None);
                match fault.link {
                    Link::Measurement => lists.sensor_waves.push(waves),
                    Link::Command => lists.command_waves.push(waves),
                }
            }
            FaultKind::SmoothedSquare => {
                let frequency_hz = |c| values(&PERIOD, c).map(f64::recip);
                lists
                    .squares
                    .push(self.waves(&frequency_hz, Some(&SMOOTHING)));
            }
            FaultKind::Delay | FaultKind::Replay => self.add_delay_line(lists),
            FaultKind::Scale => lists.scales.push(windows(&MAGNITUDE)),
            FaultKind::Noise => lists.noises.push(self.noise()),
            FaultKind::Outlier => lists.outliers.push(bursts(&AMPLITUDE, None)),
            FaultKind::Freeze => lists.sensor_holds.push(held(None, None)),
            FaultKind::Dropout => lists.sensor_holds.push(held(Some(&SLOT), Some(&SHARE))),
            FaultKind::DenialOfService => {
                let holds = held(Some(&SLOT), Some(&SHARE));
                match fault.link {
                    Link::Measurement => lists.sensor_holds.push(holds),
                    Link::Command => lists.command_holds.push(holds),
                }
            }
            FaultKind::Interference => lists.leaks.push(windows(&MAGNITUDE)),
            FaultKind::Mass | FaultKind::Inertia | FaultKind::CenterOfMass | FaultKind::Payload => {
                self.add_plant_change(lists);
            }
        }
    }

    /// A delay or a replay of what is commanded or measured.
    fn add_delay_line<L: Lane, const NC: usize>(&self, lists: &mut SignalLists<L, NC>) {
        let records = self.fault.kind == FaultKind::Delay;
        let switches = self.switches(&|_| [1.0; MAX_WIDTH]);
        let lengths = std::array::from_fn(|c| self.ring_steps::<L>(c));
        if self.fault.link == Link::Measurement {
            let line = DelayLine::new(records, switches, lengths);
            lists.sensor_rings.push(line);
        } else {
            let line = DelayLine::new(records, switches, lengths);
            lists.command_rings.push(line);
        }
    }

    /// A changed mass: by what share the inertia grows, and which force comes with it.
    fn add_plant_change<L: Lane, const NC: usize>(&self, lists: &mut SignalLists<L, NC>) {
        let changed = |c: usize| self.plant_change::<L>(c);
        let inertias = self.switches(&|c| changed(c).map(|change| change.inertia));
        lists.inertias.push(inertias);
        let weights = self.switches(&|c| changed(c).map(|change| change.force));
        lists.weights.push(weights);
    }

    fn noise<L: Lane, const NC: usize>(&self) -> Noise<L, NC> {
        Noise {
            entry: self.entry(),
            members: self.members(),
            switch: self.switches(&|c| self.values::<L>(&STD, c)),
            samples: [[L::number(0.0); 4]; NC],
        }
    }

    /// A number of each lane's draw.
    fn lanes<L: Lane>(&self, pick: &dyn Fn(&FaultDraw) -> f64) -> [f64; MAX_WIDTH] {
        self.block
            .lanes::<L>(self.agent, |draw| pick(&draw.faults[self.index]))
    }

    /// Whether it strikes a channel in some lane.
    fn strikes<L: Lane>(&self, c: usize) -> bool {
        let struck = |draw: &FaultDraw| f64::from(u8::from(draw.strikes[self.first + c]));
        self.lanes::<L>(&struck).contains(&1.0)
    }

    fn values<L: Lane>(&self, parameter: &Parameter, c: usize) -> [f64; MAX_WIDTH] {
        self.lanes::<L>(&|draw| self.value(draw, parameter, self.first + c))
    }

    fn value(&self, draw: &FaultDraw, parameter: &Parameter, channel: usize) -> f64 {
        parameter.value(self.fault.kind.parameters(), &draw.parameters, channel)
    }

    /// A value from the fault's onset to its end, along its ramp.
    fn switch<L: Lane>(&self, c: usize, value: [f64; MAX_WIDTH]) -> Window<L> {
        let time = self.block.group.time;
        let struck = |pick: &dyn Fn(&FaultDraw) -> f64| -> L {
            let of_lanes = self.lanes::<L>(&|draw| {
                if draw.strikes[self.first + c] {
                    pick(draw)
                } else {
                    f64::INFINITY
                }
            });
            L::load(&of_lanes)
        };
        let ramp_steps = |draw: &FaultDraw| match self.fault.kind {
            FaultKind::Drift => self.steps_left(draw),
            _ if draw.ramp_s > 0.0 => time.whole_steps(draw.ramp_s),
            _ => 1.0,
        };
        Window {
            onset: struck(&|draw| f64::from(time.onset_step(draw.onset_s))),
            end: struck(&|draw| {
                if draw.duration_s.is_finite() {
                    f64::from(draw.end_step(time))
                } else {
                    f64::INFINITY
                }
            }),
            inverse_ramp: L::load(&self.lanes::<L>(&|draw| ramp_steps(draw).recip())),
            value: L::load(&value),
        }
    }

    fn switches<L: Lane, const NC: usize>(
        &self,
        value: &dyn Fn(usize) -> [f64; MAX_WIDTH],
    ) -> [Window<L>; NC] {
        std::array::from_fn(|c| self.switch(c, value(c)))
    }

    /// What a drift amounts to at the end of the run, if nothing ends it before.
    fn drifted<L: Lane>(&self, c: usize) -> [f64; MAX_WIDTH] {
        let step_s = self.block.group.time.step_s;
        self.lanes::<L>(&|draw| {
            self.value(draw, &DRIFT_RATE, self.first + c) * self.steps_left(draw) * step_s
        })
    }

    /// Steps from the onset to the end of the run, both of which are shown.
    fn steps_left(&self, draw: &FaultDraw) -> f64 {
        let time = self.block.group.time;
        f64::from(time.steps - time.onset_step(draw.onset_s) + 1)
    }

    fn entry(&self) -> u32 {
        u32::try_from(self.index).unwrap_or(u32::MAX)
    }

    fn is_link(&self) -> bool {
        self.fault.target == FaultTarget::Network
    }

    /// Addresses of the channels; a link fails as a whole.
    fn members<const NC: usize>(&self) -> [u32; NC] {
        let agent = self.block.group.first_agent + self.agent;
        std::array::from_fn(|c| {
            if self.is_link() {
                member(agent, 0)
            } else {
                member(agent, self.first + c)
            }
        })
    }

    /// A value that is there in some slots of time: slots of so many seconds, or of one step without; all of them are
    /// hit where there is no share.
    fn bursts<L: Lane, const NC: usize>(
        &self,
        value: &dyn Fn(usize) -> [f64; MAX_WIDTH],
        slot_s: Option<&Parameter>,
        share: Option<&Parameter>,
    ) -> IntermittentWindow<L, NC> {
        let time = self.block.group.time;
        IntermittentWindow {
            entry: self.entry(),
            together: self.is_link(),
            members: self.members(),
            switch: self.switches(value),
            slot_steps: std::array::from_fn(|c| match slot_s {
                Some(slot_s) => self
                    .values::<L>(slot_s, c)
                    .map(|slot_s| small(time.whole_steps(slot_s))),
                None => [1; MAX_WIDTH],
            }),
            threshold: std::array::from_fn(|c| match share {
                // Hit with this probability, to within 2^-32.
                Some(share) => self
                    .values::<L>(share, c)
                    .map(|share| small(share * 4_294_967_296.0 - 1.0)),
                None => [u32::MAX; MAX_WIDTH],
            }),
        }
    }

    fn waves<L: Lane, const NC: usize>(
        &self,
        frequency_hz: &dyn Fn(usize) -> [f64; MAX_WIDTH],
        smoothing: Option<&Parameter>,
    ) -> [Oscillation<L>; NC] {
        std::array::from_fn(|c| Oscillation {
            switch: self.switch(c, self.values::<L>(&AMPLITUDE, c)),
            inverse_smoothing: match smoothing {
                Some(smoothing) => L::load(&self.values::<L>(smoothing, c).map(f64::recip)),
                None => L::number(0.0),
            },
            phase: L::turns(&self.values::<L>(&PHASE, c).map(|phase| phase / TAU)),
            advance: self.block.advance::<L>(frequency_hz(c)),
            held: L::number(0.0),
        })
    }

    /// Samples that a delay or a replay keeps; a replay has recorded nothing before the start.
    fn ring_steps<L: Lane>(&self, c: usize) -> [u32; MAX_WIDTH] {
        let time = self.block.group.time;
        let steps = self.lanes::<L>(&|draw| {
            let steps =
                |length_s: &Parameter| time.whole_steps(self.value(draw, length_s, self.first + c));
            match self.fault.kind {
                FaultKind::Replay => steps(&WINDOW).min(f64::from(time.onset_step(draw.onset_s))),
                _ => steps(&DELAY),
            }
        });
        steps.map(|steps| small(steps).max(1))
    }

    fn plant_change<L: Lane>(&self, c: usize) -> [PlantChange; MAX_WIDTH] {
        let channel = self.first + c;
        let agent = &self.block.group.agent;
        let change = |draw: &AgentDraw| {
            let of =
                |parameter: &Parameter| self.value(&draw.faults[self.index], parameter, channel);
            match (self.fault.kind, agent) {
                (FaultKind::Mass, Agent::Uav(_)) if channel >= FIRST_ATTITUDE => {
                    PlantChange::default()
                }
                (FaultKind::Inertia, Agent::Uav(_)) if channel < FIRST_ATTITUDE => {
                    PlantChange::default()
                }
                (FaultKind::Mass | FaultKind::Inertia, _) => PlantChange {
                    inertia: of(&GROWTH),
                    force: 0.0,
                },
                (FaultKind::CenterOfMass, Agent::Uav(uav)) => PlantChange {
                    inertia: 0.0,
                    force: tilting(
                        uav,
                        channel,
                        uav.mass_kg * draw.mass_scale,
                        [of(&OFFSET_X), of(&OFFSET_Y)],
                    ),
                },
                (FaultKind::Payload, Agent::Uav(uav)) => loaded(
                    uav,
                    draw,
                    channel,
                    of(&PAYLOAD_MASS),
                    [of(&OFFSET_X), of(&OFFSET_Y)],
                ),
                _ => PlantChange::default(),
            }
        };
        std::array::from_fn(|lane| {
            if lane < L::WIDTH {
                change(&self.block.episode(lane).agents[self.agent])
            } else {
                PlantChange::default()
            }
        })
    }
}

/// The torque with which a weight beside the centre of thrust tilts a UAV that hovers: (x, y, 0) x (0, 0, -m g).
fn tilting(uav: &Uav, channel: usize, mass_kg: f64, [x_m, y_m]: [f64; 2]) -> f64 {
    let weight_n = mass_kg * uav.gravity_m_s2;
    match channel.checked_sub(FIRST_ATTITUDE) {
        Some(0) => -y_m * weight_n,
        Some(1) => x_m * weight_n,
        _ => 0.0,
    }
}

/// A point mass that is hung on a UAV. Its own part of the gyroscopic torque is left out.
fn loaded(
    uav: &Uav,
    draw: &AgentDraw,
    channel: usize,
    mass_kg: f64,
    offset_m: [f64; 2],
) -> PlantChange {
    let [x2, y2] = offset_m.map(|offset| offset * offset);
    let inertia = match channel.checked_sub(FIRST_ATTITUDE) {
        None => mass_kg / (uav.mass_kg * draw.mass_scale),
        Some(axis) => {
            let arm2 = [y2, x2, x2 + y2][axis];
            mass_kg * arm2 / (uav.inertia_kg_m2[axis] * draw.inertia_scale)
        }
    };
    PlantChange {
        inertia,
        force: tilting(uav, channel, mass_kg, offset_m),
    }
}

/// Whether a fault strikes one of the `count` channels from `first` on in some episode.
fn may_strike(fault: &Fault, first: usize, count: usize) -> bool {
    let within = |channels: &FaultChannels| match channels {
        FaultChannels::One => true,
        FaultChannels::These(channels) => channels
            .iter()
            .any(|channel| (first..first + count).contains(channel)),
    };
    let mut of_agents = fault.probability.iter().zip(&fault.channels);
    of_agents.any(|(probability, channels)| *probability > 0.0 && within(channels))
}
