//! A group of channels of a whole team, integrated for a block of episodes.
//!
//! Groups are the parts of an episode that never act on each other (see the plants), so each is integrated from start to end
//! on its own, while all it needs stays in the first-level cache.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::condition::Condition;
use super::controller::{ChannelGains, error_estimate, fault_estimates, feedback, step_channel};
use super::integrator::{Step, Stepped};
use super::lanes::{Kernel, Lane, MAX_WIDTH};
use super::metric::{ChannelOutcome, Limits, Metrics, Sample};
use super::plant::{Inputs, Plant, ReferenceRow, Response};
use super::signal::Signals;

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

/// Constants of a group: plant, gains and limits of its channels.
pub(crate) struct Setting<'t, P, R, const NC: usize> {
    pub(crate) plant: P,
    pub(crate) gains: [ChannelGains<R>; NC],
    pub(crate) limits: [Limits<R>; NC],
    pub(crate) coupled: bool,
    pub(crate) step_s: f64,
    pub(crate) settle_step: u32,
    pub(crate) seed: u64,
    /// Reference at every half step, `[half step][agent][channel][row]`.
    pub(crate) table: &'t [ReferenceRow<R>],
}

/// One agent's channels of the group.
pub(crate) struct Agent<L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) channels: [Stepped<L, NS>; NC],
    pub(crate) extra: Stepped<L, NX>,
    pub(crate) signals: Signals<L, NC>,
    pub(crate) inverse_inertia: [L; NC],
    pub(crate) kappa: L,
    pub(crate) first_fault: L,
    pub(crate) metrics: [Metrics<L>; NC],
    /// The first step that failed; infinite if none did.
    pub(crate) failed: L,
}

/// The state of a group between two steps.
pub(crate) struct Group<L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) agents: Vec<Agent<L, NC, NS, NX>>,
    episodes: [u32; MAX_WIDTH],
    /// Steps at which a fault switches, ascending.
    pub(crate) changes: Vec<u32>,
    pub(crate) next_change: usize,
    noisy: bool,
    pub(crate) step: u32,
}

/// What one channel shows at one instant, `[lane]`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Shown {
    /// Reference.
    pub r: f64,
    /// State.
    pub x: f64,
    /// Tracking error.
    pub e: f64,
    /// Its rate.
    pub e_rate: f64,
    /// Its estimate.
    pub e_hat: f64,
    /// Actuator fault signal, (14).
    pub f1: f64,
    /// Its estimate.
    pub f1_hat: f64,
    /// Sensor fault signal, (16).
    pub f2: f64,
    /// Its estimate.
    pub f2_hat: f64,
    /// Command after faults: u of (9), and torques after their limits; under thrust, x, y and z are the force demanded.
    pub u: f64,
}

impl<L: Lane, const NC: usize, const NS: usize, const NX: usize> Agent<L, NC, NS, NX> {
    /// An agent at step 0, from its channels' states and what it meets.
    pub(crate) fn new(channels: [[L; NS]; NC], condition: Condition<L, NC>) -> Self {
        Self {
            channels: channels.map(Stepped::new),
            extra: Stepped::new([L::number(0.0); NX]),
            signals: condition.signals,
            inverse_inertia: condition.inverse_inertia,
            kappa: condition.kappa,
            first_fault: condition.first_fault,
            metrics: [Metrics::new(); NC],
            failed: L::number(f64::INFINITY),
        }
    }

    /// x and x' of the channels at the state of stage `STAGE`.
    #[inline(always)]
    pub(crate) fn motion<P: Plant<L, NC, NX>, const STAGE: usize>(
        &self,
        plant: &P,
        rows: &[ReferenceRow<L::Real>],
    ) -> [[L; NC]; 2] {
        let [mut position, mut velocity] = plant.reference(rows, self.extra.at::<STAGE>());
        for c in 0..NC {
            let state = self.channels[c].at::<STAGE>();
            position[c] = position[c] + state[1];
            velocity[c] = velocity[c] + state[2];
        }
        [position, velocity]
    }

    /// The answer of the plant at the state of stage `STAGE`; `team` is the sum of x over the team.
    #[inline(always)]
    pub(crate) fn respond<P: Plant<L, NC, NX>, const STAGE: usize>(
        &self,
        setting: &Setting<'_, P, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
        team: &[L; NC],
    ) -> Response<L, NC, NX> {
        let [position, velocity] = self.motion::<P, STAGE>(&setting.plant, rows);
        let mut wanted = [L::number(0.0); NC];
        let mut force = self.signals.disturbance;
        for c in 0..NC {
            wanted[c] = feedback(&setting.gains[c], self.channels[c].at::<STAGE>());
        }
        if setting.coupled {
            for c in 0..NC {
                // (10): c = kappa x o sum of the other agents' x.
                let others = team[c] - position[c];
                force[c] = (others * self.kappa).mul_add(position[c], force[c]);
            }
        }
        let inputs = Inputs {
            reference: rows,
            feedback: wanted,
            position,
            velocity,
            force,
            ground: &self.signals.ground,
            command_gain: &self.signals.command_gain,
            command_bias: &self.signals.command_bias,
            inverse_inertia: &self.inverse_inertia,
        };
        setting.plant.respond(&inputs, self.extra.at::<STAGE>())
    }

    #[inline(always)]
    pub(crate) fn observe<P: Plant<L, NC, NX>, const SETTLED: bool>(
        &mut self,
        limits: &[Limits<L::Real>; NC],
        response: &Response<L, NC, NX>,
        now: L,
    ) {
        let never = L::number(f64::INFINITY);
        for c in 0..NC {
            let state = self.channels[c].at::<0>();
            let [f1_hat, f2_hat] = fault_estimates(state);
            let f1 = response.error_acceleration[c] - response.told[c];
            let sample = Sample {
                error: state[1],
                command: response.command[c],
                excess: response.excess[c],
                actuator_fault_error: f1_hat - f1,
                sensor_fault_error: f2_hat - self.signals.sensor_fault[c],
            };
            let limit = if SETTLED {
                L::splat(limits[c].max_error)
            } else {
                L::splat(<L::Real as super::lanes::Real>::MAX)
            };
            self.failed = self
                .failed
                .min(L::select_le(sample.error.abs(), limit, never, now));
            if P::LIMITED {
                self.metrics[c].take::<SETTLED, true>(&sample, limits[c].settled_error, now);
            } else {
                self.metrics[c].take::<SETTLED, false>(&sample, limits[c].settled_error, now);
            }
        }
    }
}

impl<L: Lane, const NC: usize, const NS: usize, const NX: usize> Group<L, NC, NS, NX> {
    /// The group at step 0; `changes` are the steps at which a fault switches, in any order.
    pub(crate) fn new(
        agents: Vec<Agent<L, NC, NS, NX>>,
        episodes: [u32; MAX_WIDTH],
        mut changes: Vec<u32>,
    ) -> Self {
        changes.push(0);
        changes.sort_unstable();
        changes.dedup();
        let noisy = agents.iter().any(|agent| !agent.signals.noises.is_empty());
        Self {
            agents,
            episodes,
            changes,
            next_change: 0,
            noisy,
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
        if change || self.noisy {
            self.hold(seed);
        }
    }

    #[inline(always)]
    pub(crate) fn hold(&mut self, seed: u64) {
        let now = L::number(f64::from(self.step));
        for agent in &mut self.agents {
            agent.signals.hold(self.step, seed, &self.episodes);
            agent.signals.evaluate::<false>();
            for metrics in &mut agent.metrics {
                metrics.before_fault(agent.first_fault, now);
            }
        }
    }

    /// The sum of x over the team, which the coupling needs.
    #[inline(always)]
    pub(crate) fn team_sum<P: Plant<L, NC, NX>, const STAGE: usize>(
        &self,
        setting: &Setting<'_, P, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
    ) -> [L; NC] {
        let mut sum = [L::number(0.0); NC];
        if setting.coupled {
            for (agent, rows) in self.agents.iter().zip(rows.chunks_exact(NC * P::ROWS)) {
                let [position, _] = agent.motion::<P, STAGE>(&setting.plant, rows);
                for c in 0..NC {
                    sum[c] = sum[c] + position[c];
                }
            }
            // Finite, so that an agent that diverged leaves those alone to whom it is coupled with kappa = 0.
            let (low, high) = (L::number(-FAR_AWAY), L::number(FAR_AWAY));
            for c in 0..NC {
                sum[c] = sum[c].min(high).max(low);
            }
        }
        sum
    }

    #[inline(always)]
    pub(crate) fn stage<P: Plant<L, NC, NX>, const STAGE: usize, const SETTLED: bool>(
        &mut self,
        setting: &Setting<'_, P, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
        h: &Step<L::Real>,
    ) {
        let team = self.team_sum::<P, STAGE>(setting, rows);
        let now = L::number(f64::from(self.step));
        for (agent, rows) in self.agents.iter_mut().zip(rows.chunks_exact(NC * P::ROWS)) {
            let response = agent.respond::<P, STAGE>(setting, rows, &team);
            if STAGE == 0 {
                agent.observe::<P, SETTLED>(&setting.limits, &response, now);
            }
            for c in 0..NC {
                step_channel::<L, NS, STAGE>(
                    &setting.gains[c],
                    &mut agent.channels[c],
                    response.error_acceleration[c],
                    agent.signals.sensor_fault[c],
                    response.told[c],
                    h,
                );
            }
            for k in 0..NX {
                agent.extra.take::<STAGE>(k, response.extra_rate[k], h);
            }
        }
    }

    #[inline(always)]
    fn evaluate_ahead(&mut self) {
        for agent in &mut self.agents {
            agent.signals.evaluate::<true>();
        }
    }

    /// Integrates up to step number `until`.
    #[inline(always)]
    pub(crate) fn advance<P: Plant<L, NC, NX>>(
        &mut self,
        setting: &Setting<'_, P, L::Real, NC>,
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
                self.stage::<P, 0, true>(setting, start, &h);
            } else {
                self.stage::<P, 0, false>(setting, start, &h);
            }
            self.evaluate_ahead();
            self.stage::<P, 1, false>(setting, middle, &h);
            self.stage::<P, 2, false>(setting, middle, &h);
            self.evaluate_ahead();
            self.stage::<P, 3, false>(setting, end, &h);
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

    /// What the first lane shows at the current step, `[agent][channel]`.
    #[inline(always)]
    pub(crate) fn show<P: Plant<L, NC, NX>>(
        &mut self,
        setting: &Setting<'_, P, L::Real, NC>,
    ) -> Vec<[Shown; NC]> {
        // Repeating this is harmless: what is held depends on the step alone.
        self.hold(setting.seed);
        let stride = self.agents.len() * NC * P::ROWS;
        let first = 2 * self.step as usize * stride;
        let rows = &setting.table[first..first + stride];
        let team = self.team_sum::<P, 0>(setting, rows);
        let mut shown = vec![[Shown::default(); NC]; self.agents.len()];
        for ((agent, rows), shown) in self
            .agents
            .iter()
            .zip(rows.chunks_exact(NC * P::ROWS))
            .zip(&mut shown)
        {
            let response = agent.respond::<P, 0>(setting, rows, &team);
            let [position, _] = agent.motion::<P, 0>(&setting.plant, rows);
            for c in 0..NC {
                let state = agent.channels[c].at::<0>();
                let [f1_hat, f2_hat] = fault_estimates(state);
                let f1 = response.error_acceleration[c] - response.told[c];
                shown[c] = Shown {
                    r: first_lane(position[c] - state[1]),
                    x: first_lane(position[c]),
                    e: first_lane(state[1]),
                    e_rate: first_lane(state[2]),
                    e_hat: first_lane(error_estimate(state)[1]),
                    f1: first_lane(f1),
                    f1_hat: first_lane(f1_hat),
                    f2: first_lane(agent.signals.sensor_fault[c]),
                    f2_hat: first_lane(f2_hat),
                    u: first_lane(response.command[c]),
                };
            }
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

fn first_lane<L: Lane>(value: L) -> f64 {
    let mut stored = [0.0; MAX_WIDTH];
    value.store(&mut stored);
    stored[0]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step number"
)]
fn finite_step(step: f64) -> Option<u32> {
    step.is_finite().then_some(step as u32)
}

/// [`Group::advance`] as a kernel.
pub(crate) struct Advance<'a, P, L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) group: &'a mut Group<L, NC, NS, NX>,
    pub(crate) setting: &'a Setting<'a, P, L::Real, NC>,
    pub(crate) until: u32,
}

impl<P: Plant<L, NC, NX>, L: Lane, const NC: usize, const NS: usize, const NX: usize> Kernel
    for Advance<'_, P, L, NC, NS, NX>
{
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.group.advance(self.setting, self.until);
    }
}

/// [`Group::show`] as a kernel.
pub(crate) struct Show<'a, P, L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) group: &'a mut Group<L, NC, NS, NX>,
    pub(crate) setting: &'a Setting<'a, P, L::Real, NC>,
}

impl<P: Plant<L, NC, NX>, L: Lane, const NC: usize, const NS: usize, const NX: usize> Kernel
    for Show<'_, P, L, NC, NS, NX>
{
    type Output = Vec<[Shown; NC]>;
    #[inline(always)]
    fn run(self) -> Self::Output {
        self.group.show(self.setting)
    }
}
