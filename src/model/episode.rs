//! Episodes: from draws to groups of channels, and from their ends to outcomes.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders to come"
)]

use super::controller::{ChannelGains, FTC_STATES, OBSERVER, PID_STATES};
use super::group::{Advance, Agent, Group, Setting, Show, Shown};
use super::lanes::{Lane, MAX_WIDTH, Real};
use super::metric::{ChannelOutcome, Limits};
use super::plant_uav::{Attitude, Axis, Plant, ReferenceRow, Thrust, inertia, non_inertial};
use super::signal::{Noise, Signals, Sine, Square, Switch};
use crate::campaign::{
    ActuationKind, Campaign, Disturbance, DisturbanceKind, FIRST_ATTITUDE, FaultKind, FaultTarget,
    ObserverStart,
};
use crate::draw::{AgentDraw, Episode, FaultDraw, member};
use crate::synthesis::LoopGains;
use std::f64::consts::TAU;
use std::ops::Range;

/// Channels of a UAV.
const CHANNELS: usize = 6;

/// The episode loop of a campaign in one precision: what all its episodes and controllers share.
pub struct Model<R> {
    campaign: Campaign,
    parts: Vec<Part<R>>,
}

/// A group of channels and its reference table.
struct Part<R> {
    channels: Range<usize>,
    table: Vec<ReferenceRow<R>>,
}

/// A controller in the precision of the loop: its gains on the position and on the attitude channels.
#[derive(Debug, Clone, Copy)]
pub struct Controller<R> {
    gains: [ChannelGains<R>; 2],
    ftc: bool,
}

/// How an agent fared in an episode under one controller.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentOutcome {
    /// The first step that broke `max_error` (from settle_s on) or was not finite (at any time).
    pub failed_step: Option<u32>,
    /// Whether its state or a metric left the numbers.
    pub diverged: bool,
    /// Metrics of each channel.
    pub channels: Vec<ChannelOutcome>,
}

/// What every agent and channel of an episode shows at one instant.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Step number; the time is this times the step.
    pub step: u32,
    /// `[agent][channel]`.
    pub agents: Vec<Vec<Shown>>,
}

impl<R: Real> Controller<R> {
    /// A controller from its gains on the position and on the attitude channels, both of one kind (reading a gains file
    /// refuses others).
    #[must_use]
    pub fn new([position, attitude]: &[LoopGains; 2]) -> Self {
        Self {
            gains: [ChannelGains::new(position), ChannelGains::new(attitude)],
            ftc: position.states + OBSERVER == FTC_STATES,
        }
    }
}

impl<R: Real> Model<R> {
    /// Tabulates the references of a campaign.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        let ends: &[usize] = match campaign.uav.actuation {
            ActuationKind::Full => &[0, 1, 2, 3, CHANNELS],
            ActuationKind::Thrust => &[0, CHANNELS],
        };
        let parts = ends
            .windows(2)
            .map(|ends| ends[0]..ends[1])
            .map(|channels| Part {
                channels: channels.clone(),
                table: Vec::new(),
            })
            .collect();
        let mut model = Self {
            campaign: campaign.clone(),
            parts,
        };
        for half_step in 0..=2 * campaign.time.steps {
            let t_s = f64::from(half_step) * campaign.time.step_s / 2.0;
            for agent in 0..campaign.team {
                let rows = reference_rows(campaign, agent, t_s);
                for part in &mut model.parts {
                    part.table.extend(&rows[part.channels.clone()]);
                }
            }
        }
        model
    }

    /// Flies at most `L::WIDTH` episodes under a controller: `[episode][agent]`.
    #[must_use]
    pub fn simulate<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episodes: &[Episode],
    ) -> Vec<Vec<AgentOutcome>> {
        self.fly::<L>(controller, episodes, None).0
    }

    /// Flies one episode and shows it every `every` steps, from the start to the end.
    #[must_use]
    pub fn trace<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episode: &Episode,
        every: u32,
    ) -> (Vec<AgentOutcome>, Vec<Snapshot>) {
        let (mut outcomes, snapshots) = self.fly::<L>(
            controller,
            std::slice::from_ref(episode),
            Some(every.max(1)),
        );
        (outcomes.pop().unwrap_or_default(), snapshots)
    }

    fn fly<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episodes: &[Episode],
        every: Option<u32>,
    ) -> (Vec<Vec<AgentOutcome>>, Vec<Snapshot>) {
        let blank = AgentOutcome {
            failed_step: None,
            diverged: false,
            channels: vec![ChannelOutcome::default(); CHANNELS],
        };
        let mut flight = Flight {
            model: self,
            controller,
            episodes,
            every,
            outcomes: vec![vec![blank; self.campaign.team]; episodes.len()],
            snapshots: Vec::new(),
        };
        for part in &self.parts {
            if controller.ftc {
                flight.part::<L, FTC_STATES>(part);
            } else {
                flight.part::<L, PID_STATES>(part);
            }
        }
        (flight.outcomes, flight.snapshots)
    }
}

/// The reference rows of an agent's channels at one instant. Under thrust, roll and pitch have none: they follow from the
/// force, and the feedforward of the attitude is worked out in the loop.
fn reference_rows<R: Real>(
    campaign: &Campaign,
    agent: usize,
    t_s: f64,
) -> [ReferenceRow<R>; CHANNELS] {
    let points = campaign.reference.at(agent, t_s);
    let inertia = inertia(&campaign.uav);
    let non_inertial = non_inertial(&campaign.uav, points.map(|point| point.rate));
    std::array::from_fn(|c| {
        let point = points[c];
        [
            point.value,
            point.rate,
            point.acceleration,
            inertia[c] * point.acceleration + non_inertial[c],
        ]
        .map(R::from_f64)
    })
}

/// A block of episodes under one controller.
struct Flight<'a, R> {
    model: &'a Model<R>,
    controller: &'a Controller<R>,
    episodes: &'a [Episode],
    /// Steps between two snapshots, if any are taken.
    every: Option<u32>,
    outcomes: Vec<Vec<AgentOutcome>>,
    snapshots: Vec<Snapshot>,
}

impl<R: Real> Flight<'_, R> {
    fn part<L: Lane<Real = R>, const NS: usize>(&mut self, part: &Part<R>) {
        let uav = &self.model.campaign.uav;
        match (uav.actuation, part.channels.start) {
            (ActuationKind::Thrust, _) => self.group::<L, _, 6, NS, 4>(Thrust::new(uav), part),
            (ActuationKind::Full, FIRST_ATTITUDE) => {
                self.group::<L, _, 3, NS, 0>(Attitude::new(uav), part)
            }
            (ActuationKind::Full, axis) => self.group::<L, _, 1, NS, 0>(Axis::new(uav, axis), part),
        }
    }

    fn group<L, P, const NC: usize, const NS: usize, const NX: usize>(
        &mut self,
        plant: P,
        part: &Part<R>,
    ) where
        L: Lane<Real = R>,
        P: Plant<L, NC, NX>,
    {
        let campaign = &self.model.campaign;
        let first = part.channels.start;
        let verdict = &campaign.verdict;
        let setting = Setting {
            plant,
            gains: std::array::from_fn(|c| {
                self.controller.gains[usize::from(first + c >= FIRST_ATTITUDE)]
            }),
            limits: std::array::from_fn(|c| {
                Limits::new(
                    verdict.max_error[first + c],
                    verdict.settled_error[first + c],
                )
            }),
            coupled: campaign.team > 1 && !campaign.kappa.is_zero(),
            step_s: campaign.time.step_s,
            settle_step: campaign.time.settle_step,
            seed: campaign.seed,
            table: &part.table,
        };
        let agents = (0..campaign.team)
            .map(|agent| self.agent::<L, NC, NS, NX>(&setting.gains, agent, first))
            .collect();
        let numbers = std::array::from_fn(|lane| self.lane_episode(lane).index);
        let changes = (0..campaign.team)
            .flat_map(|agent| {
                self.episodes
                    .iter()
                    .flat_map(move |episode| later_onsets(campaign, &episode.agents[agent]))
            })
            .collect();
        let mut group: Group<L, NC, NS, NX> = Group::new(agents, numbers, changes);

        let (steps, mut step, mut snapshot) = (campaign.time.steps, 0, 0);
        loop {
            if self.every.is_some() {
                let shown = L::dispatch(Show {
                    group: &mut group,
                    setting: &setting,
                });
                self.keep(snapshot, step, first, &shown);
                snapshot += 1;
            }
            if step == steps {
                break;
            }
            step = self
                .every
                .map_or(steps, |every| step.saturating_add(every).min(steps));
            L::dispatch(Advance {
                group: &mut group,
                setting: &setting,
                until: step,
            });
        }
        self.collect(&mut group, first);
    }

    /// The episode of a lane; lanes without one repeat the last.
    fn lane_episode(&self, lane: usize) -> &Episode {
        &self.episodes[lane.min(self.episodes.len() - 1)]
    }

    /// A number of each lane's draw.
    fn lanes(&self, agent: usize, pick: impl Fn(&AgentDraw) -> f64) -> [f64; MAX_WIDTH] {
        std::array::from_fn(|lane| pick(&self.lane_episode(lane).agents[agent]))
    }

    /// The initial state of an agent and what will act on it.
    fn agent<L: Lane<Real = R>, const NC: usize, const NS: usize, const NX: usize>(
        &self,
        gains: &[ChannelGains<R>; NC],
        agent: usize,
        first: usize,
    ) -> Agent<L, NC, NS, NX> {
        let campaign = &self.model.campaign;
        let mut signals = Signals::none();
        for (index, disturbance) in campaign.disturbances.iter().enumerate() {
            self.add_disturbance(&mut signals, disturbance, index, agent, first);
        }
        for index in 0..campaign.faults.len() {
            self.add_fault(&mut signals, index, agent, first);
        }
        let first_sensor_fault = signals.clone().at_start(
            campaign.seed,
            &std::array::from_fn(|lane| self.lane_episode(lane).index),
        );
        let inertia = inertia(&campaign.uav);
        let channels = std::array::from_fn(|c| {
            let channel = first + c;
            let integral = L::load(&self.lanes(agent, |draw| draw.error_integral[channel]));
            let error = L::load(&self.lanes(agent, |draw| draw.error[channel]));
            let rate = L::load(&self.lanes(agent, |draw| draw.error_rate[channel]));
            let mut state = [L::number(0.0); NS];
            state[..3].copy_from_slice(&[integral, error, rate]);
            if campaign.initial.observer == ObserverStart::Measured {
                state[OBSERVER..OBSERVER + 3].copy_from_slice(&gains[c].measured(
                    integral,
                    error,
                    rate,
                    first_sensor_fault[c],
                ));
            }
            state
        });
        let inverse_inertia = std::array::from_fn(|c| {
            L::load(&self.lanes(agent, |draw| {
                let scale = if first + c < FIRST_ATTITUDE {
                    draw.mass_scale
                } else {
                    draw.inertia_scale
                };
                1.0 / (inertia[first + c] * scale)
            }))
        });
        let first_fault = self.lanes(agent, |draw| {
            later_onsets(campaign, draw)
                .into_iter()
                .map(f64::from)
                .fold(f64::INFINITY, f64::min)
        });
        let kappa = L::load(&self.lanes(agent, |draw| draw.kappa));
        Agent::new(
            channels,
            signals,
            inverse_inertia,
            kappa,
            L::load(&first_fault),
        )
    }

    fn add_disturbance<L: Lane<Real = R>, const NC: usize>(
        &self,
        signals: &mut Signals<L, NC>,
        disturbance: &Disturbance,
        index: usize,
        agent: usize,
        first: usize,
    ) {
        let values = |parameter: usize, c: usize| {
            self.lanes(agent, |draw| draw.disturbances[index][parameter][first + c])
        };
        match disturbance.kind {
            DisturbanceKind::Constant => {
                for (c, constant) in signals.constant.iter_mut().enumerate() {
                    *constant = *constant + L::load(&values(0, c));
                }
            }
            DisturbanceKind::Sine => {
                let sine: [Sine<L>; NC] = std::array::from_fn(|c| Sine {
                    amplitude: L::load(&values(0, c)),
                    phase: L::turns(&values(2, c).map(|phase_rad| phase_rad / TAU)),
                    advance: self
                        .advance::<L>(values(1, c).map(|frequency_rad_s| frequency_rad_s / TAU)),
                });
                if (0..NC).any(|c| values(0, c).iter().any(|amplitude| *amplitude != 0.0)) {
                    signals.sines.push(sine);
                }
            }
        }
    }

    fn add_fault<L: Lane<Real = R>, const NC: usize>(
        &self,
        signals: &mut Signals<L, NC>,
        index: usize,
        agent: usize,
        first: usize,
    ) {
        let campaign = &self.model.campaign;
        let fault = &campaign.faults[index];
        let lanes =
            |pick: &dyn Fn(&FaultDraw) -> f64| self.lanes(agent, |draw| pick(&draw.faults[index]));
        if !(0..NC)
            .any(|c| lanes(&|draw| f64::from(u8::from(draw.strikes[first + c]))).contains(&1.0))
        {
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
                signals.command_biases.push(std::array::from_fn(switch))
            }
            (FaultKind::Bias, FaultTarget::Sensor) => {
                signals.sensor_biases.push(std::array::from_fn(switch))
            }
            (FaultKind::SmoothedSquare, _) => {
                signals.squares.push(std::array::from_fn(|c| Square {
                    switch: switch(c),
                    inverse_smoothing: L::load(&values(2, c).map(f64::recip)),
                    phase: L::turns(&values(3, c).map(|phase_rad| phase_rad / TAU)),
                    advance: self.advance::<L>(values(1, c).map(f64::recip)),
                    active: L::number(0.0),
                }))
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
    fn advance<L: Lane<Real = R>>(&self, frequency_hz: [f64; MAX_WIDTH]) -> L::Turns {
        L::turns(&frequency_hz.map(|frequency| frequency * self.model.campaign.time.step_s / 2.0))
    }

    fn keep<const NC: usize>(
        &mut self,
        snapshot: usize,
        step: u32,
        first: usize,
        shown: &[[Shown; NC]],
    ) {
        if snapshot == self.snapshots.len() {
            let agents = vec![vec![Shown::default(); CHANNELS]; shown.len()];
            self.snapshots.push(Snapshot { step, agents });
        }
        for (agent, shown) in self.snapshots[snapshot].agents.iter_mut().zip(shown) {
            agent[first..first + NC].copy_from_slice(shown);
        }
    }

    fn collect<L: Lane, const NC: usize, const NS: usize, const NX: usize>(
        &mut self,
        group: &mut Group<L, NC, NS, NX>,
        first: usize,
    ) {
        let time = self.model.campaign.time;
        for (agent, (endings, channels)) in group
            .outcomes(time.settle_step, time.step_s)
            .into_iter()
            .enumerate()
        {
            for (lane, episode) in self.outcomes.iter_mut().enumerate() {
                let outcome = &mut episode[agent];
                for c in 0..NC {
                    outcome.channels[first + c] = channels[c][lane];
                    outcome.diverged |= !channels[c][lane].is_finite();
                }
                outcome.diverged |= !endings[lane].finite;
                outcome.failed_step = outcome
                    .failed_step
                    .into_iter()
                    .chain(endings[lane].failed_step)
                    .min();
            }
        }
    }
}

/// The steps at which an agent's faults begin, apart from those that begin with the run.
#[must_use]
pub fn later_onsets(campaign: &Campaign, draw: &AgentDraw) -> Vec<u32> {
    draw.faults
        .iter()
        .filter(|fault| fault.occurs())
        .map(|fault| campaign.time.onset_step(fault.onset_s))
        .filter(|&step| step > 0)
        .collect()
}
