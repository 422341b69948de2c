//! From draws to what acts on an agent: the numbers of the episode loop, in its precision and lanes.

pub(crate) mod fault;

use super::exogenous::delay_line::DelayLine;
use super::exogenous::dryden::{Dryden, at_rest};
use super::exogenous::noise::{Filter, Turbulence};
use super::exogenous::vortex::Vortex;
use super::exogenous::window::Window;
use super::exogenous::{ExogenousInputs, Oscillation};
use super::lanes::{Lane, MAX_WIDTH};
use super::plant::uav::inertia;
use crate::agent::{Agent, FIRST_ATTITUDE, HEIGHT};
use crate::campaign::{Campaign, Disturbance, DisturbanceKind};
use crate::draw::{AgentDraw, Episode, member};
use crate::random::philox::{Address, Stream};
use fault::{FaultLanes, small};
use std::f64::consts::TAU;

/// A block of episodes, one per lane; lanes without one repeat the last.
#[derive(Clone, Copy)]
pub(crate) struct LaneBlock<'a> {
    pub(crate) campaign: &'a Campaign,
    pub(crate) episodes: &'a [Episode],
}

/// What the channels of one agent start from and meet.
pub(crate) struct ChannelInputs<L: Lane, const NC: usize> {
    /// int e, e and e' at t = 0.
    pub(crate) initial: [[L; 3]; NC],
    pub(crate) signals: ExogenousInputs<L, NC>,
    pub(crate) kappa: L,
    pub(crate) vortices: Vec<Vortex<L>>,
    /// The step of the first fault that does not begin with the run; infinite if there is none.
    pub(crate) first_fault: L,
}

/// Which entries of the campaign get a signal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Selection {
    /// Those that act on these channels in some lane of the block: the others would only cost time.
    Acting,
    /// Those that may act on these channels in some episode: the same list for every block of a campaign.
    Possible,
}

impl LaneBlock<'_> {
    /// The episode numbers of the lanes.
    pub(crate) fn numbers(&self) -> [u32; MAX_WIDTH] {
        std::array::from_fn(|lane| self.episode(lane).index)
    }

    /// What the channels from `first` on of an agent start from and meet.
    pub(crate) fn condition<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        first: usize,
        entries: Selection,
    ) -> ChannelInputs<L, NC> {
        let campaign = self.campaign;
        let mut signals = ExogenousInputs::none();
        signals.hold_steps = campaign.control.hold_steps;
        if campaign.control.delay_s.is_some() {
            signals.command_rings.push(self.control_delay(agent));
        }
        for (index, disturbance) in campaign.disturbances.iter().enumerate() {
            self.add_disturbance(&mut signals, disturbance, index, agent, first, entries);
        }
        for (index, fault) in campaign.faults.iter().enumerate() {
            let lanes = FaultLanes {
                block: self,
                fault,
                index,
                agent,
                first,
            };
            lanes.add(&mut signals, entries);
        }
        // A biped's scale is that of M and H as a whole.
        let inertia = match &campaign.agent {
            Agent::Uav(uav) => inertia(uav).to_vec(),
            Agent::Biped(_) => vec![1.0; campaign.channels().len()],
        };
        let turns =
            |channel: usize| matches!(campaign.agent, Agent::Uav(_)) && channel >= FIRST_ATTITUDE;
        let channel = |pick: &dyn Fn(&AgentDraw) -> f64| -> L { self.load(agent, pick) };
        signals.first_inverse_inertia = std::array::from_fn(|c| {
            channel(&|draw| {
                let scale = if turns(first + c) {
                    draw.inertia_scale
                } else {
                    draw.mass_scale
                };
                1.0 / (inertia[first + c] * scale)
            })
        });
        ChannelInputs {
            initial: std::array::from_fn(|c| {
                [
                    channel(&|draw| draw.error_integral[first + c]),
                    channel(&|draw| draw.error[first + c]),
                    channel(&|draw| draw.error_rate[first + c]),
                ]
            }),
            signals,
            kappa: channel(&|draw| draw.kappa),
            vortices: self.vortices::<L, NC>(agent, first, entries),
            first_fault: channel(&|draw| {
                later_onsets(campaign, draw)
                    .into_iter()
                    .map(f64::from)
                    .fold(f64::INFINITY, f64::min)
            }),
        }
    }

    pub(super) fn episode(&self, lane: usize) -> &Episode {
        &self.episodes[lane.min(self.episodes.len() - 1)]
    }

    /// A number of each lane's draw; what lies beyond the lanes of `L` is not used.
    pub(super) fn lanes<L: Lane>(
        &self,
        agent: usize,
        pick: impl Fn(&AgentDraw) -> f64,
    ) -> [f64; MAX_WIDTH] {
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
        signals: &mut ExogenousInputs<L, NC>,
        disturbance: &Disturbance,
        index: usize,
        agent: usize,
        first: usize,
        entries: Selection,
    ) {
        let values = |parameter: usize, c: usize| {
            self.lanes::<L>(agent, |draw| draw.disturbances[index][parameter][first + c])
        };
        let acts = |force: &dyn Fn(usize) -> [f64; MAX_WIDTH]| {
            let acting = || (0..NC).any(|c| force(c).iter().any(|force| *force != 0.0));
            entries == Selection::Possible || acting()
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
            DisturbanceKind::Sine if acts(&|c| values(0, c)) => {
                signals.sines.push(std::array::from_fn(|c| Oscillation {
                    switch: Window::always(L::load(&values(0, c))),
                    inverse_smoothing: L::number(0.0),
                    phase: L::turns(&values(2, c).map(|phase_rad| phase_rad / TAU)),
                    advance: self
                        .advance::<L>(values(1, c).map(|frequency_rad_s| frequency_rad_s / TAU)),
                    held: L::number(0.0),
                }));
            }
            DisturbanceKind::Gust1Cosine => {
                let blows = |c: usize| disturbance.kind.acts_on(first + c);
                let force = |c: usize| {
                    let (speed_m_s, gain_n_s_m) = (values(0, c), values(1, c));
                    std::array::from_fn(|lane| {
                        if blows(c) {
                            speed_m_s[lane] * gain_n_s_m[lane]
                        } else {
                            0.0
                        }
                    })
                };
                if acts(&force) {
                    let waves =
                        std::array::from_fn(|c| self.gust(force(c), values(2, c), values(3, c)));
                    signals.gusts.push(waves);
                }
            }
            DisturbanceKind::Dryden => {
                let blows = |c: usize| disturbance.kind.acts_on(first + c);
                if (0..NC).any(blows) {
                    signals
                        .turbulences
                        .push(self.turbulence(agent, index, first));
                }
            }
            DisturbanceKind::Sine | DisturbanceKind::RotorVortex => {}
        }
    }

    /// What an agent feels of the others' jets, where its channels are those of a place.
    fn vortices<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        first: usize,
        entries: Selection,
    ) -> Vec<Vortex<L>> {
        if first > 0 || NC <= HEIGHT {
            return Vec::new();
        }
        let all = self.campaign.disturbances.iter().enumerate();
        let felt = all.filter(|(_, disturbance)| disturbance.kind == DisturbanceKind::RotorVortex);
        felt.filter_map(|(index, _)| {
            let of = |parameter: usize, pick: fn(f64) -> f64| {
                self.lanes::<L>(agent, |draw| {
                    pick(draw.disturbances[index][parameter][HEIGHT])
                })
            };
            let force_n = of(0, |force_n| force_n);
            let acts = force_n.iter().any(|force_n| *force_n != 0.0);
            (acts || entries == Selection::Possible).then(|| Vortex {
                force: L::load(&force_n),
                inverse_radius: L::load(&of(1, f64::recip)),
                inverse_length: L::load(&of(2, |length_m| 2.0 / length_m)),
            })
        })
        .collect()
    }

    /// One turn of 1 - cos from an onset on.
    fn gust<L: Lane>(
        &self,
        force_n: [f64; MAX_WIDTH],
        onset_s: [f64; MAX_WIDTH],
        duration_s: [f64; MAX_WIDTH],
    ) -> Oscillation<L> {
        let time = self.campaign.time;
        let onsets = onset_s.map(|onset_s| f64::from(time.onset_step(onset_s)));
        let steps = duration_s.map(|duration_s| time.whole_steps(duration_s));
        // A quarter turn back, the sine is at its bottom.
        let phases: [f64; MAX_WIDTH] =
            std::array::from_fn(|lane| -onsets[lane] / steps[lane] - 0.25);
        let ends: [f64; MAX_WIDTH] = std::array::from_fn(|lane| onsets[lane] + steps[lane]);
        Oscillation {
            switch: Window {
                onset: L::load(&onsets),
                end: L::load(&ends),
                inverse_ramp: L::number(1.0),
                value: L::load(&force_n),
            },
            inverse_smoothing: L::number(0.0),
            phase: L::turns(&phases),
            advance: L::turns(&steps.map(|steps| 0.5 / steps)),
            held: L::number(0.0),
        }
    }

    /// Turbulence along the axes of translation; nothing about the others.
    fn turbulence<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        index: usize,
        first: usize,
    ) -> Turbulence<L, NC> {
        let campaign = self.campaign;
        let entry = u32::try_from(index).unwrap_or(u32::MAX);
        let members = std::array::from_fn(|c| member(agent, first + c));
        let filter = |c: usize, draw: &AgentDraw| {
            let of = |parameter: usize| draw.disturbances[index][parameter][first + c];
            if first + c < FIRST_ATTITUDE {
                let wind = Dryden {
                    wind_m_s: of(0),
                    altitude_m: of(1),
                    airspeed_m_s: of(2),
                };
                wind.filter(first + c, of(3), campaign.time.step_s)
            } else {
                Filter::still()
            }
        };
        let at_start: [[[f64; MAX_WIDTH]; 2]; NC] = std::array::from_fn(|c| {
            let mut state = [[0.0; MAX_WIDTH]; 2];
            for lane in 0..L::WIDTH {
                let address = Address {
                    episode: self.episode(lane).index,
                    stream: Stream::Turbulence,
                    entry,
                    member: members[c],
                    index: u32::MAX,
                };
                for (state, own) in state.iter_mut().zip(at_rest(address, campaign.seed)) {
                    state[lane] = own;
                }
            }
            state
        });
        Turbulence {
            entry,
            members,
            filter: std::array::from_fn(|c| {
                let number = |pick: &dyn Fn(Filter<f64>) -> f64| {
                    self.load(agent, |draw| pick(filter(c, draw)))
                };
                Filter {
                    keep: number(&|filter| filter.keep),
                    cross: number(&|filter| filter.cross),
                    noise: std::array::from_fn(|k| number(&|filter| filter.noise[k])),
                    output: std::array::from_fn(|k| number(&|filter| filter.output[k])),
                }
            }),
            state: at_start.map(|state| state.map(|values| L::load(&values))),
        }
    }

    /// The delay of a control loop, which is there from the start to the end.
    fn control_delay<L: Lane, const NC: usize>(&self, agent: usize) -> DelayLine<L, NC, 1> {
        let steps = |draw: &AgentDraw| self.campaign.time.whole_steps(draw.control_delay_s);
        let lengths = self.lanes::<L>(agent, steps).map(small);
        DelayLine::new(true, [Window::always(L::number(1.0)); NC], [lengths; NC])
    }

    /// Turns per half step of frequencies in Hz.
    pub(super) fn advance<L: Lane>(&self, frequency_hz: [f64; MAX_WIDTH]) -> L::Turns {
        L::turns(&frequency_hz.map(|frequency| frequency * self.campaign.time.step_s / 2.0))
    }
}

/// The steps at which what an agent meets begins or ends.
#[must_use]
pub(crate) fn changes(campaign: &Campaign, draw: &AgentDraw) -> Vec<u32> {
    let time = campaign.time;
    let faults = draw.faults.iter().filter(|fault| fault.occurs());
    let ends = faults
        .filter(|fault| fault.duration_s.is_finite())
        .map(|fault| fault.end_step(time));
    let gusts = campaign.disturbances.iter().zip(&draw.disturbances);
    let gusts = gusts.filter(|(gust, _)| gust.kind == DisturbanceKind::Gust1Cosine);
    let gusts = gusts.flat_map(|(_, values)| {
        let spans = values[2].iter().zip(&values[3]);
        spans.flat_map(move |(&onset_s, &duration_s)| {
            let onset = time.onset_step(onset_s);
            [
                onset,
                onset.saturating_add(small(time.whole_steps(duration_s))),
            ]
        })
    });
    let begins = later_onsets(campaign, draw);
    begins.into_iter().chain(ends).chain(gusts).collect()
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
