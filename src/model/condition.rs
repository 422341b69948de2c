//! From draws to what acts on an agent: the numbers of the episode loop, in its precision and lanes.

use super::lanes::{Lane, MAX_WIDTH};
use super::plant_uav::inertia;
use super::signal::{Noise, Signals, Sine, Square, Switch};
use crate::campaign::{
    Agent, Campaign, Disturbance, DisturbanceKind, FIRST_ATTITUDE, Fault, FaultChannels, FaultKind,
    FaultTarget,
};
use crate::draw::{AgentDraw, Episode, FaultDraw, member};
use std::f64::consts::TAU;

/// A block of episodes, one per lane; lanes without one repeat the last.
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    pub(crate) campaign: &'a Campaign,
    pub(crate) episodes: &'a [Episode],
}

/// What the channels of one agent start from and meet.
pub(crate) struct Condition<L: Lane, const NC: usize> {
    /// int e, e and e' at t = 0.
    pub(crate) initial: [[L; 3]; NC],
    pub(crate) signals: Signals<L, NC>,
    /// 1 / true inertia.
    pub(crate) inverse_inertia: [L; NC],
    pub(crate) kappa: L,
    /// The step of the first fault that does not begin with the run; infinite if there is none.
    pub(crate) first_fault: L,
}

/// Which entries of the campaign get a signal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Entries {
    /// Those that act on these channels in some lane of the block: the others would only cost time.
    Acting,
    /// Those that may act on these channels in some episode: the same list for every block of a campaign.
    Possible,
}

impl Block<'_> {
    /// The episode numbers of the lanes.
    pub(crate) fn numbers(&self) -> [u32; MAX_WIDTH] {
        std::array::from_fn(|lane| self.episode(lane).index)
    }

    /// What the channels from `first` on of an agent start from and meet.
    pub(crate) fn condition<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        first: usize,
        entries: Entries,
    ) -> Condition<L, NC> {
        let campaign = self.campaign;
        let mut signals = Signals::none();
        for (index, disturbance) in campaign.disturbances.iter().enumerate() {
            self.add_disturbance(&mut signals, disturbance, index, agent, first, entries);
        }
        for (index, fault) in campaign.faults.iter().enumerate() {
            self.add_fault(&mut signals, fault, index, agent, first, entries);
        }
        // A biped's scale is that of M and H as a whole.
        let inertia = match &campaign.agent {
            Agent::Uav(uav) => inertia(uav).to_vec(),
            Agent::Biped(_) => vec![1.0; campaign.channels().len()],
        };
        let turns =
            |channel: usize| matches!(campaign.agent, Agent::Uav(_)) && channel >= FIRST_ATTITUDE;
        let channel = |pick: &dyn Fn(&AgentDraw) -> f64| -> L { self.load(agent, pick) };
        Condition {
            initial: std::array::from_fn(|c| {
                [
                    channel(&|draw| draw.error_integral[first + c]),
                    channel(&|draw| draw.error[first + c]),
                    channel(&|draw| draw.error_rate[first + c]),
                ]
            }),
            signals,
            inverse_inertia: std::array::from_fn(|c| {
                channel(&|draw| {
                    let scale = if turns(first + c) {
                        draw.inertia_scale
                    } else {
                        draw.mass_scale
                    };
                    1.0 / (inertia[first + c] * scale)
                })
            }),
            kappa: channel(&|draw| draw.kappa),
            first_fault: channel(&|draw| {
                later_onsets(campaign, draw)
                    .into_iter()
                    .map(f64::from)
                    .fold(f64::INFINITY, f64::min)
            }),
        }
    }

    fn episode(&self, lane: usize) -> &Episode {
        &self.episodes[lane.min(self.episodes.len() - 1)]
    }

    /// A number of each lane's draw; what lies beyond the lanes of `L` is not used.
    fn lanes<L: Lane>(&self, agent: usize, pick: impl Fn(&AgentDraw) -> f64) -> [f64; MAX_WIDTH] {
        std::array::from_fn(|lane| {
            if lane < L::WIDTH {
                pick(&self.episode(lane).agents[agent])
            } else {
                0.0
            }
        })
    }

    fn load<L: Lane>(&self, agent: usize, pick: impl Fn(&AgentDraw) -> f64) -> L {
        L::load(&self.lanes::<L>(agent, pick))
    }

    fn add_disturbance<L: Lane, const NC: usize>(
        &self,
        signals: &mut Signals<L, NC>,
        disturbance: &Disturbance,
        index: usize,
        agent: usize,
        first: usize,
        entries: Entries,
    ) {
        let values = |parameter: usize, c: usize| {
            self.lanes::<L>(agent, |draw| draw.disturbances[index][parameter][first + c])
        };
        match disturbance.kind {
            DisturbanceKind::Constant => {
                for (c, constant) in signals.constant.iter_mut().enumerate() {
                    *constant = *constant + L::load(&values(0, c));
                }
            }
            DisturbanceKind::GroundReaction => {
                for (c, ground) in signals.ground.iter_mut().enumerate() {
                    *ground = *ground + L::load(&values(0, c));
                }
            }
            DisturbanceKind::Sine => {
                let acts =
                    || (0..NC).any(|c| values(0, c).iter().any(|amplitude| *amplitude != 0.0));
                if entries == Entries::Possible || acts() {
                    signals.sines.push(std::array::from_fn(|c| Sine {
                        amplitude: L::load(&values(0, c)),
                        phase: L::turns(&values(2, c).map(|phase_rad| phase_rad / TAU)),
                        advance: self.advance::<L>(
                            values(1, c).map(|frequency_rad_s| frequency_rad_s / TAU),
                        ),
                    }));
                }
            }
        }
    }

    fn add_fault<L: Lane, const NC: usize>(
        &self,
        signals: &mut Signals<L, NC>,
        fault: &Fault,
        index: usize,
        agent: usize,
        first: usize,
        entries: Entries,
    ) {
        let campaign = self.campaign;
        let lanes = |pick: &dyn Fn(&FaultDraw) -> f64| {
            self.lanes::<L>(agent, |draw| pick(&draw.faults[index]))
        };
        let strikes = |c: usize| lanes(&|draw| f64::from(u8::from(draw.strikes[first + c])));
        let listed = match entries {
            Entries::Possible => may_strike(fault, first, NC),
            Entries::Acting => (0..NC).any(|c| strikes(c).contains(&1.0)),
        };
        if !listed {
            return;
        }
        let values =
            |parameter: usize, c: usize| lanes(&|draw| draw.parameters[parameter][first + c]);
        let switch = |c: usize| Switch {
            onset: L::load(&lanes(&|draw| {
                if draw.strikes[first + c] {
                    f64::from(campaign.time.onset_step(draw.onset_s))
                } else {
                    f64::INFINITY
                }
            })),
            value: L::load(&values(0, c)),
        };
        match (fault.kind, fault.target) {
            (FaultKind::LossOfEffectiveness, _) => signals.losses.push(std::array::from_fn(switch)),
            (FaultKind::Bias, FaultTarget::Actuator) => {
                signals.command_biases.push(std::array::from_fn(switch));
            }
            (FaultKind::Bias, FaultTarget::Sensor) => {
                signals.sensor_biases.push(std::array::from_fn(switch));
            }
            (FaultKind::SmoothedSquare, _) => {
                signals.squares.push(std::array::from_fn(|c| Square {
                    switch: switch(c),
                    inverse_smoothing: L::load(&values(2, c).map(f64::recip)),
                    phase: L::turns(&values(3, c).map(|phase_rad| phase_rad / TAU)),
                    advance: self.advance::<L>(values(1, c).map(f64::recip)),
                    held: L::number(0.0),
                }));
            }
            (FaultKind::Noise, _) => signals.noises.push(Noise {
                entry: u32::try_from(index).unwrap_or(u32::MAX),
                members: std::array::from_fn(|c| member(agent, first + c)),
                switch: std::array::from_fn(switch),
                samples: [[L::number(0.0); 4]; NC],
            }),
        }
    }

    /// Turns per half step of frequencies in Hz.
    fn advance<L: Lane>(&self, frequency_hz: [f64; MAX_WIDTH]) -> L::Turns {
        L::turns(&frequency_hz.map(|frequency| frequency * self.campaign.time.step_s / 2.0))
    }
}

/// Whether a fault strikes one of the `count` channels from `first` on in some episode.
fn may_strike(fault: &Fault, first: usize, count: usize) -> bool {
    match &fault.channels {
        FaultChannels::One => true,
        FaultChannels::These(channels) => channels
            .iter()
            .any(|channel| (first..first + count).contains(channel)),
    }
}

/// The steps at which an agent's faults begin, apart from those that begin with the run.
#[must_use]
pub(crate) fn later_onsets(campaign: &Campaign, draw: &AgentDraw) -> Vec<u32> {
    draw.faults
        .iter()
        .filter(|fault| fault.occurs())
        .map(|fault| campaign.time.onset_step(fault.onset_s))
        .filter(|&step| step > 0)
        .collect()
}
