//! Episodes: from draws to groups of channels, and from their ends to outcomes.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::agent::{Agent, Coupling, GroupParameters};
use super::controller::Law;
use super::controller::kinds::{Controller, Family, with_family};
use super::controller::observer_feedback::{FTC_STATES, PID_STATES};
use super::controller::true_state::TRUE_STATES;
use super::inputs::{ChannelInputs, LaneBlock, Selection, changes};
use super::lanes::{Lane, Real};
use super::metric::{ChannelOutcome, Limits};
use super::plant::Plant;
use super::plant::kinds::{AnyPlant, with_plant};
use super::sample::{ChannelSample, ObserverState};
use super::subsystem::{Subsystem, parts};
use super::team::{Advance, Ending, Show, Shown, TeamState};
use crate::campaign::{AgentGroup, IntegralKind, ObserverStart};
use crate::draw::Episode;

/// The episode loop of a group of agents in one precision: what all its episodes and controllers share.
pub struct Model<R> {
    pub(crate) group: AgentGroup,
    pub(crate) parts: Vec<Subsystem<R>>,
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
    pub agents: Vec<Vec<ChannelSample>>,
    /// What the loops hold, `[agent][channel]`; empty where a GPU simulated, which does not send it back.
    pub internals: Vec<Vec<ObserverState>>,
}

/// How the agents of an episode fared, and what it showed from the start to the end.
pub type Trace = (Vec<AgentOutcome>, Vec<Snapshot>);

impl AgentOutcome {
    /// The outcome before anything is known of it.
    pub(crate) fn blank(channels: usize) -> Self {
        Self {
            failed_step: None,
            diverged: false,
            channels: vec![ChannelOutcome::default(); channels],
        }
    }

    /// Takes in the outcome of a channel, and how the agent ended as far as its group of channels tells.
    pub(crate) fn take(&mut self, channel: usize, ending: Ending, outcome: ChannelOutcome) {
        self.channels[channel] = outcome;
        self.diverged |= !outcome.is_finite() || !ending.finite;
        self.failed_step = self.failed_step.into_iter().chain(ending.failed_step).min();
    }
}

impl<R: Real> Model<R> {
    /// Tabulates the references of a group of agents.
    #[must_use]
    pub fn new(group: &AgentGroup) -> Self {
        Self {
            group: group.clone(),
            parts: parts(group),
        }
    }

    /// Simulates at most `L::WIDTH` episodes under a controller: `[episode][agent]`.
    #[must_use]
    pub fn simulate<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episodes: &[Episode],
    ) -> Vec<Vec<AgentOutcome>> {
        self.run_loop::<L>(controller, episodes, None).0
    }

    /// Simulates at most `L::WIDTH` episodes and shows them every `every` steps, from the start to the end.
    #[must_use]
    pub fn trace<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episodes: &[Episode],
        every: u32,
    ) -> Vec<Trace> {
        let (outcomes, snapshots) = self.run_loop::<L>(controller, episodes, Some(every.max(1)));
        outcomes.into_iter().zip(snapshots).collect()
    }

    fn run_loop<L: Lane<Real = R>>(
        &self,
        controller: &Controller<R>,
        episodes: &[Episode],
        every: Option<u32>,
    ) -> (Vec<Vec<AgentOutcome>>, Vec<Vec<Snapshot>>) {
        let blank = AgentOutcome::blank(self.group.channels().len());
        let mut running = EpisodeLoop {
            model: self,
            block: LaneBlock {
                group: &self.group,
                episodes,
            },
            every,
            outcomes: vec![vec![blank; self.group.team]; episodes.len()],
            snapshots: vec![Vec::new(); episodes.len()],
        };
        for part in &self.parts {
            with_family!(R, &controller.family, |laws, NS| {
                running.part::<L, _, NS>(part, laws);
            });
        }
        (running.outcomes, running.snapshots)
    }
}

/// A block of episodes under one controller.
struct EpisodeLoop<'a, R> {
    model: &'a Model<R>,
    block: LaneBlock<'a>,
    /// Steps between two snapshots, if any are taken.
    every: Option<u32>,
    outcomes: Vec<Vec<AgentOutcome>>,
    /// Of each episode.
    snapshots: Vec<Vec<Snapshot>>,
}

impl<R: Real> EpisodeLoop<'_, R> {
    fn part<L, C, const NS: usize>(&mut self, part: &Subsystem<R>, laws: &[C])
    where
        L: Lane<Real = R>,
        C: Law<L, NS>,
    {
        with_plant!(part.plant, |plant, NC, NX| {
            self.subsystem::<L, _, _, NC, NS, NX>(plant, part, laws);
        });
    }

    fn subsystem<L, P, C, const NC: usize, const NS: usize, const NX: usize>(
        &mut self,
        plant: P,
        part: &Subsystem<R>,
        laws: &[C],
    ) where
        L: Lane<Real = R>,
        P: Plant<L, NC, NX>,
        C: Law<L, NS>,
    {
        let group = &self.model.group;
        let first = part.channels.start;
        let verdict = &group.verdict;
        let setting = GroupParameters {
            plant,
            controller: std::array::from_fn(|c| laws[group.group_of(first + c)]),
            limits: std::array::from_fn(|c| {
                Limits::new(
                    verdict.max_error[first + c],
                    verdict.settled_error[first + c],
                )
            }),
            coupling: Coupling::of(group),
            measured_integral: group.control.integral == IntegralKind::Sensor,
            step_s: group.time.step_s,
            settle_step: group.time.settle_step,
            seed: group.seed,
            table: &part.table,
        };
        let agents = (0..group.team)
            .map(|agent| self.agent(&setting, agent, first))
            .collect();
        let numbers = self.block.numbers();
        let changes = (0..group.team)
            .flat_map(|agent| {
                self.block
                    .episodes
                    .iter()
                    .flat_map(move |episode| changes(group, &episode.agents[agent]))
            })
            .collect();
        let mut team: TeamState<L, NC, NS, NX> = TeamState::new(agents, numbers, changes);

        let (steps, mut step, mut snapshot) = (group.time.steps, 0, 0);
        loop {
            if self.every.is_some() {
                let shown = L::dispatch(Show {
                    team: &mut team,
                    setting: &setting,
                    lanes: self.block.episodes.len(),
                });
                for (lane, shown) in shown.iter().enumerate() {
                    self.keep(lane, snapshot, step, first, shown);
                }
                snapshot += 1;
            }
            if step == steps {
                break;
            }
            step = self
                .every
                .map_or(steps, |every| step.saturating_add(every).min(steps));
            L::dispatch(Advance {
                team: &mut team,
                setting: &setting,
                until: step,
            });
        }
        self.collect(&mut team, first);
    }

    /// The initial state of an agent and what will act on it.
    fn agent<L, P, C, const NC: usize, const NS: usize, const NX: usize>(
        &self,
        setting: &GroupParameters<'_, P, C, R, NC>,
        agent: usize,
        first: usize,
    ) -> Agent<L, NC, NS, NX>
    where
        L: Lane<Real = R>,
        P: Plant<L, NC, NX>,
        C: Law<L, NS>,
    {
        let group = &self.model.group;
        let condition: ChannelInputs<L, NC> = self.block.condition(agent, first, Selection::Acting);
        let at_rest = [L::number(0.0); NX];
        let rows = &setting.table[agent * NC * P::ROWS..][..NC * P::ROWS];
        let reference = setting.plant.reference(rows, &at_rest);
        let (sensor_fault, off) = condition.signals.clone().at_start(
            reference,
            &condition.initial,
            group.seed,
            &self.block.numbers(),
        );
        let channels = std::array::from_fn(|c| {
            let [integral, error, rate] = condition.initial[c];
            let mut state = [L::number(0.0); NS];
            state[..3].copy_from_slice(&[integral, error, rate]);
            if group.initial.observer == ObserverStart::Measured {
                setting.controller[c].start(&mut state, off[c], sensor_fault[c]);
            }
            state
        });
        Agent::new(channels, condition)
    }

    /// Keeps what a group of channels of an episode, from `first` on, shows at its snapshot of this number.
    fn keep<const NC: usize>(
        &mut self,
        lane: usize,
        snapshot: usize,
        step: u32,
        first: usize,
        shown: &[Shown<f64, NC>],
    ) {
        let snapshots = &mut self.snapshots[lane];
        if snapshot == snapshots.len() {
            let channels = self.model.group.channels().len();
            snapshots.push(Snapshot {
                step,
                agents: vec![vec![ChannelSample::default(); channels]; shown.len()],
                internals: vec![vec![ObserverState::default(); channels]; shown.len()],
            });
        }
        let snapshot = &mut snapshots[snapshot];
        let agents = snapshot.agents.iter_mut().zip(&mut snapshot.internals);
        for ((agent, internals), shown) in agents.zip(shown) {
            for (c, &(seen, held)) in (first..).zip(shown) {
                (agent[c], internals[c]) = (seen, held);
            }
        }
    }

    fn collect<L: Lane, const NC: usize, const NS: usize, const NX: usize>(
        &mut self,
        team: &mut TeamState<L, NC, NS, NX>,
        first: usize,
    ) {
        let time = self.model.group.time;
        for (agent, (endings, channels)) in team
            .outcomes(time.settle_step, time.step_s)
            .into_iter()
            .enumerate()
        {
            for (lane, episode) in self.outcomes.iter_mut().enumerate() {
                for c in 0..NC {
                    episode[agent].take(first + c, endings[lane], channels[c][lane]);
                }
            }
        }
    }
}
