//! A group of channels of a whole team, integrated for a block of episodes.
//!
//! Groups are the parts of an episode that never act on each other (see the plants), so each is integrated from start
//! to end on its own, while all it needs stays in the first-level cache.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::agent::{Agent, Coupling, GroupParameters, Team};
use super::controller::{Law, Measured, OBSERVER};
use super::exogenous::delay_line::Moment;
use super::exogenous::{ExogenousInputs, kernels};
use super::integrator::Step;
use super::lanes::{Kernel, Lane, MAX_WIDTH};
use super::metric::ChannelOutcome;
use super::plant::{Plant, ReferenceRow};
use super::sample::{ChannelSample, ObserverState};
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use crate::synthesis::LOOP_STATES;

/// Steps between two flushes of the metrics, counted from step 0.
pub(crate) const FLUSH_STEPS: u32 = 256;
/// Where an agent that diverged is seen by the others, m or rad.
pub(crate) const FAR_AWAY: f64 = 1e15;

/// Two numbers per agent that say how it ended, beside its channels' outcomes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ending {
    /// The first step that broke a limit of the verdict or was not finite.
    pub(crate) failed_step: Option<u32>,
    /// Whether the state is finite at the end.
    pub(crate) finite: bool,
}

/// What the channels of an agent show and hold at one instant.
pub(crate) type Shown<T, const NC: usize> = [(ChannelSample<T>, ObserverState<T>); NC];

/// The state of a group between two steps.
pub(crate) struct TeamState<L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) agents: Vec<Agent<L, NC, NS, NX>>,
    episodes: [u32; MAX_WIDTH],
    /// Steps at which a fault switches, ascending.
    pub(crate) changes: Vec<u32>,
    pub(crate) next_change: usize,
    /// Whether what is held differs from step to step.
    restless: bool,
    /// Whether anything of a step matters to the next.
    remembers: bool,
    /// Where the agents show themselves to be at a stage, if some agent feels the others' jets; else nothing.
    pub(crate) places: Vec<[L; FIRST_ATTITUDE]>,
    pub(crate) step: u32,
}

impl<L: Lane, const NC: usize, const NS: usize, const NX: usize> TeamState<L, NC, NS, NX> {
    /// The group at step 0; `changes` are the steps at which a fault switches, in any order.
    pub(crate) fn new(
        agents: Vec<Agent<L, NC, NS, NX>>,
        episodes: [u32; MAX_WIDTH],
        mut changes: Vec<u32>,
    ) -> Self {
        changes.push(0);
        changes.sort_unstable();
        changes.dedup();
        let any =
            |is: fn(&ExogenousInputs<L, NC>) -> bool| agents.iter().any(|agent| is(&agent.signals));
        let (restless, remembers) = (
            any(ExogenousInputs::is_restless),
            any(ExogenousInputs::remembers),
        );
        let shown = if agents.iter().any(|agent| !agent.vortices.is_empty()) {
            agents.len()
        } else {
            0
        };
        Self {
            agents,
            episodes,
            changes,
            next_change: 0,
            restless,
            remembers,
            places: vec![[L::number(0.0); FIRST_ATTITUDE]; shown],
            step: 0,
        }
    }

    /// Sets what is held over the coming step, if it differs from the last.
    #[inline(always)]
    pub(crate) fn begin_step(&mut self, seed: u64) {
        let change = self.changes.get(self.next_change) == Some(&self.step);
        if change {
            self.next_change += 1;
        }
        if change || self.restless {
            self.hold(seed);
        }
    }

    #[inline(always)]
    pub(crate) fn hold(&mut self, seed: u64) {
        let now = L::number(f64::from(self.step));
        let team = self.team_commands();
        for agent in &mut self.agents {
            kernels::hold(&mut agent.signals, self.step, &team, seed, &self.episodes);
            for metrics in &mut agent.metrics {
                metrics.before_fault(agent.first_fault, now);
            }
        }
    }

    /// The sum of the team's last commands, of which some may leak into others.
    #[inline(always)]
    pub(crate) fn team_commands(&self) -> [L; NC] {
        let mut sum = [L::number(0.0); NC];
        if self.remembers {
            for agent in &self.agents {
                for c in 0..NC {
                    sum[c] = sum[c] + agent.signals.last_command[c];
                }
            }
            finite(&mut sum);
        }
        sum
    }

    /// The sum of x over the team, which the coupling needs.
    #[inline(always)]
    pub(crate) fn team_sum<P: Plant<L, NC, NX>, C, const STAGE: usize>(
        &self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
    ) -> [L; NC] {
        let mut sum = [L::number(0.0); NC];
        if setting.coupling != Coupling::None {
            for (agent, rows) in self.agents.iter().zip(rows.chunks_exact(NC * P::ROWS)) {
                let [position, _] = agent.motion::<P, STAGE>(&setting.plant, rows);
                for c in 0..NC {
                    sum[c] = sum[c] + position[c];
                }
            }
            finite(&mut sum);
        }
        sum
    }

    /// Sets where the agents show themselves to be.
    #[inline(always)]
    pub(crate) fn place_agents<P: Plant<L, NC, NX>, C, const STAGE: usize>(
        &mut self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
    ) {
        if NC > HEIGHT && !self.places.is_empty() {
            let rows = rows.chunks_exact(NC * P::ROWS);
            for ((agent, place), rows) in self.agents.iter().zip(&mut self.places).zip(rows) {
                let [position, _] = agent.motion::<P, STAGE>(&setting.plant, rows);
                place.copy_from_slice(&position[..FIRST_ATTITUDE]);
                finite(place);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn stage<
        P: Plant<L, NC, NX>,
        C: Law<L, NS>,
        const STAGE: usize,
        const SETTLED: bool,
    >(
        &mut self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
        h: &Step<L::Real>,
    ) {
        let sum = self.team_sum::<P, C, STAGE>(setting, rows);
        self.place_agents::<P, C, STAGE>(setting, rows);
        let team = Team {
            sum,
            places: &self.places,
            size: self.agents.len(),
        };
        let (step, remembers) = (self.step, self.remembers);
        let rows = rows.chunks_exact(NC * P::ROWS);
        for ((own, agent), rows) in self.agents.iter_mut().enumerate().zip(rows) {
            let response = agent.respond::<P, C, STAGE>(setting, rows, &team, own, step);
            let off = agent.distortion::<P, STAGE>(&setting.plant, rows);
            if STAGE == 0 {
                agent.observe::<P, C, SETTLED>(&setting.limits, &response, &off, step);
                if remembers {
                    agent.remember(setting, rows, &response, step);
                }
            }
            for c in 0..NC {
                setting.controller[c].step::<STAGE>(
                    &mut agent.channels[c],
                    response.error_acceleration[c],
                    &Measured {
                        sensor_fault: agent.signals.sensor_fault[c],
                        off: off[c],
                        integral: setting.measured_integral,
                    },
                    response.applied_feedback[c],
                    h,
                );
            }
            for k in 0..NX {
                agent.extra.take::<STAGE>(k, response.extra_rate[k], h);
            }
        }
    }

    #[inline(always)]
    fn evaluate(&mut self, moment: Moment) {
        kernels::evaluate(&mut self.agents, self.step, moment);
    }

    /// Ends a step for what follows a law of its own.
    #[inline(always)]
    pub(crate) fn end_step(&mut self, seed: u64) {
        for agent in &mut self.agents {
            kernels::end_step(&mut agent.signals, self.step, seed, &self.episodes);
        }
    }

    /// Integrates up to step number `until`.
    #[inline(always)]
    pub(crate) fn advance<P: Plant<L, NC, NX>, C: Law<L, NS>>(
        &mut self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        until: u32,
    ) {
        let h = Step::new(setting.step_s);
        let stride = self.agents.len() * NC * P::ROWS;
        while self.step < until {
            self.begin_step(setting.seed);
            let first = 2 * self.step as usize * stride;
            let rows = &setting.table[first..first + 3 * stride];
            let (start, rest) = rows.split_at(stride);
            let (middle, end) = rest.split_at(stride);
            if self.step >= setting.settle_step {
                self.stage::<P, C, 0, true>(setting, start, &h);
            } else {
                self.stage::<P, C, 0, false>(setting, start, &h);
            }
            self.evaluate(Moment::Middle);
            self.stage::<P, C, 1, false>(setting, middle, &h);
            self.stage::<P, C, 2, false>(setting, middle, &h);
            self.evaluate(Moment::End);
            self.stage::<P, C, 3, false>(setting, end, &h);
            self.end_step(setting.seed);
            self.step += 1;
            if self.step.is_multiple_of(FLUSH_STEPS) {
                self.flush();
            }
        }
    }

    #[inline(always)]
    pub(crate) fn flush(&mut self) {
        for agent in &mut self.agents {
            for metrics in &mut agent.metrics {
                metrics.flush();
            }
        }
    }

    /// What the lanes show and hold at the current step, `[agent][channel]`.
    #[inline(always)]
    pub(crate) fn show<P: Plant<L, NC, NX>, C: Law<L, NS>>(
        &mut self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
    ) -> Vec<Shown<L, NC>> {
        // Repeating this is harmless: what is held depends on the step alone.
        self.hold(setting.seed);
        let stride = self.agents.len() * NC * P::ROWS;
        let first = 2 * self.step as usize * stride;
        let rows = &setting.table[first..first + stride];
        let sum = self.team_sum::<P, C, 0>(setting, rows);
        self.place_agents::<P, C, 0>(setting, rows);
        let team = Team {
            sum,
            places: &self.places,
            size: self.agents.len(),
        };
        let mut shown = Vec::with_capacity(team.size);
        for ((own, agent), rows) in self
            .agents
            .iter()
            .enumerate()
            .zip(rows.chunks_exact(NC * P::ROWS))
        {
            let response = agent.respond::<P, C, 0>(setting, rows, &team, own, self.step);
            let off = agent.distortion::<P, 0>(&setting.plant, rows);
            let [position, _] = agent.motion::<P, 0>(&setting.plant, rows);
            shown.push(std::array::from_fn(|c| {
                let state = agent.channels[c].at::<0>();
                let [f1_hat, f2_hat] = C::fault_estimates(state);
                let f1 = response.error_acceleration[c] - response.applied_feedback[c];
                let seen = ChannelSample {
                    r: position[c] - state[1],
                    x: position[c],
                    e: state[1],
                    e_rate: state[2],
                    e_hat: C::error_estimate(state)[1],
                    f1,
                    f1_hat,
                    f2: agent.signals.sensor_fault[c] + off[c][1],
                    f2_hat,
                    u: response.command[c],
                };
                let mut held = ObserverState {
                    integral: state[0],
                    observer: [L::number(0.0); LOOP_STATES],
                    applied_feedback: response.applied_feedback[c],
                };
                for (held, &state) in held.observer.iter_mut().zip(state.iter().skip(OBSERVER)) {
                    *held = state;
                }
                (seen, held)
            }));
        }
        shown
    }

    /// How each agent ended, and the outcomes of its channels: `[agent]`, then `[lane]` or `[channel][lane]`.
    pub(crate) fn outcomes(
        &mut self,
        settle_step: u32,
        step_s: f64,
    ) -> Vec<([Ending; MAX_WIDTH], [[ChannelOutcome; MAX_WIDTH]; NC])> {
        self.flush();
        let settled = self.step.saturating_sub(settle_step);
        self.agents
            .iter()
            .map(|agent| {
                let mut failed = [0.0; MAX_WIDTH];
                agent.failed.store(&mut failed);
                let mut endings = failed.map(|step| Ending {
                    failed_step: finite_step(step),
                    finite: true,
                });
                for state in &agent.channels {
                    for value in state.at::<0>() {
                        let mut stored = [0.0; MAX_WIDTH];
                        value.store(&mut stored);
                        for (ending, value) in endings.iter_mut().zip(stored) {
                            ending.finite &= value.is_finite();
                        }
                    }
                }
                let blank = [ChannelOutcome::default(); MAX_WIDTH];
                let mut outcomes = [blank; NC];
                for (metrics, outcomes) in agent.metrics.iter().zip(&mut outcomes) {
                    metrics.outcomes(self.step, settled, step_s, &mut outcomes[..L::WIDTH]);
                }
                (endings, outcomes)
            })
            .collect()
    }
}

/// Makes sums over a team, or an agent's place, finite, so that an agent that diverged leaves those alone on whom it
/// acts with a strength of zero.
#[inline(always)]
pub(crate) fn finite<L: Lane, const NC: usize>(sums: &mut [L; NC]) {
    let (low, high) = (L::number(-FAR_AWAY), L::number(FAR_AWAY));
    for sum in sums {
        *sum = sum.min(high).max(low);
    }
}

/// The value of one of the lanes.
#[inline(always)]
fn of_lane<L: Lane>(value: L, lane: usize) -> f64 {
    let mut stored = [0.0; MAX_WIDTH];
    value.store(&mut stored);
    stored[lane]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step number"
)]
fn finite_step(step: f64) -> Option<u32> {
    step.is_finite().then_some(step as u32)
}

/// [`TeamState::advance`] as a kernel.
pub(crate) struct Advance<'a, P, C, L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) team: &'a mut TeamState<L, NC, NS, NX>,
    pub(crate) setting: &'a GroupParameters<'a, P, C, L::Real, NC>,
    pub(crate) until: u32,
}

impl<P: Plant<L, NC, NX>, C: Law<L, NS>, L: Lane, const NC: usize, const NS: usize, const NX: usize>
    Kernel for Advance<'_, P, C, L, NC, NS, NX>
{
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.team.advance(self.setting, self.until);
    }
}

/// [`TeamState::show`] as a kernel.
pub(crate) struct Show<'a, P, C, L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) team: &'a mut TeamState<L, NC, NS, NX>,
    pub(crate) setting: &'a GroupParameters<'a, P, C, L::Real, NC>,
    /// How many of the lanes have an episode.
    pub(crate) lanes: usize,
}

impl<P: Plant<L, NC, NX>, C: Law<L, NS>, L: Lane, const NC: usize, const NS: usize, const NX: usize>
    Kernel for Show<'_, P, C, L, NC, NS, NX>
{
    /// `[lane][agent][channel]`.
    type Output = Vec<Vec<Shown<f64, NC>>>;
    #[inline(always)]
    fn run(self) -> Self::Output {
        let shown = self.team.show(self.setting);
        let mut in_lanes = Vec::with_capacity(self.lanes);
        for lane in 0..self.lanes {
            let of_lane = |value| of_lane(value, lane);
            let mut agents = Vec::with_capacity(shown.len());
            for channels in &shown {
                agents.push(channels.map(|(seen, held)| (seen.map(of_lane), held.map(of_lane))));
            }
            in_lanes.push(agents);
        }
        in_lanes
    }
}
