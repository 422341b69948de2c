//! One agent's channels of a group: how they answer, what is seen of them, and what a step leaves to the next.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::controller::Law;
use super::exogenous::delay_line::Moment;
use super::exogenous::evaluation::HasSignals;
use super::exogenous::vortex::Vortex;
use super::exogenous::{ExogenousInputs, kernels};
use super::inputs::ChannelInputs;
use super::integrator::Stepped;
use super::lanes::Lane;
use super::metric::{Limits, Metrics, Sample};
use super::plant::{Inputs, Plant, ReferenceRow, Response};
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use crate::campaign::{AgentGroup, CouplingCoordinates};

/// Constants of a group: plant, controller and limits of its channels.
pub(crate) struct GroupParameters<'t, P, C, R, const NC: usize> {
    pub(crate) plant: P,
    /// The law of each channel.
    pub(crate) controller: [C; NC],
    pub(crate) limits: [Limits<R>; NC],
    pub(crate) coupling: Coupling,
    /// Whether the first output is the integral of what is measured, and not that of e.
    pub(crate) measured_integral: bool,
    pub(crate) step_s: f64,
    pub(crate) settle_step: u32,
    pub(crate) seed: u64,
    /// Reference at every half step, `[half step][agent][channel][row]`.
    pub(crate) table: &'t [ReferenceRow<R>],
}

/// How agents act on each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coupling {
    /// Not at all.
    None,
    /// (10) as printed.
    Absolute,
    /// (10) with the team's centroid as the origin.
    Centroid,
}

impl Coupling {
    /// That of a campaign.
    pub(crate) fn of(group: &AgentGroup) -> Self {
        match group.coordinates {
            _ if !group.is_coupled() => Self::None,
            CouplingCoordinates::Absolute => Self::Absolute,
            CouplingCoordinates::Centroid => Self::Centroid,
        }
    }
}

/// What an agent meets of its team at a stage.
pub(crate) struct Team<'a, L, const NC: usize> {
    /// The sum of x, where the coupling needs it.
    pub(crate) sum: [L; NC],
    /// x, y and z of each agent, where vortices need them; else nothing.
    pub(crate) places: &'a [[L; FIRST_ATTITUDE]],
    /// Agents.
    pub(crate) size: usize,
}

/// One agent's channels of the group.
pub(crate) struct Agent<L: Lane, const NC: usize, const NS: usize, const NX: usize> {
    pub(crate) channels: [Stepped<L, NS>; NC],
    pub(crate) extra: Stepped<L, NX>,
    pub(crate) signals: ExogenousInputs<L, NC>,
    pub(crate) kappa: L,
    pub(crate) vortices: Vec<Vortex<L>>,
    /// u_fb as it is held by a sampled controller.
    pub(crate) held_feedback: [L; NC],
    pub(crate) first_fault: L,
    pub(crate) metrics: [Metrics<L>; NC],
    /// The first step that failed; infinite if none did.
    pub(crate) failed: L,
}

impl<L: Lane, const NC: usize, const NS: usize, const NX: usize> HasSignals<L, NC>
    for Agent<L, NC, NS, NX>
{
    #[inline(always)]
    fn signals(&mut self) -> &mut ExogenousInputs<L, NC> {
        &mut self.signals
    }
}

impl<L: Lane, const NC: usize, const NS: usize, const NX: usize> Agent<L, NC, NS, NX> {
    /// An agent at step 0, from its channels' states and what it meets.
    pub(crate) fn new(channels: [[L; NS]; NC], condition: ChannelInputs<L, NC>) -> Self {
        Self {
            channels: channels.map(Stepped::new),
            extra: Stepped::new([L::number(0.0); NX]),
            signals: condition.signals,
            kappa: condition.kappa,
            vortices: condition.vortices,
            held_feedback: [L::number(0.0); NC],
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

    /// u_fb at the state of stage `STAGE` of step number `step`: a sampled controller holds it from one of its ticks to
    /// the next.
    #[inline(always)]
    pub(crate) fn feedback<P, C: Law<L, NS>, const STAGE: usize>(
        &self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        step: u32,
    ) -> [L; NC] {
        if self.signals.hold_steps > 1 && (STAGE > 0 || !self.signals.ticks(step)) {
            return self.held_feedback;
        }
        // A closure would be compiled without the lanes' instructions.
        let mut sent = [L::number(0.0); NC];
        for c in 0..NC {
            sent[c] = setting.controller[c].feedback(self.channels[c].at::<STAGE>());
        }
        sent
    }

    /// The answer of the plant at the state of stage `STAGE` of agent number `own` of its team.
    #[inline(always)]
    pub(crate) fn respond<P: Plant<L, NC, NX>, C: Law<L, NS>, const STAGE: usize>(
        &self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
        team: &Team<'_, L, NC>,
        own: usize,
        step: u32,
    ) -> Response<L, NC, NX> {
        let [position, velocity] = self.motion::<P, STAGE>(&setting.plant, rows);
        let mut force = self.signals.disturbance;
        match setting.coupling {
            Coupling::None => {}
            Coupling::Absolute => {
                for c in 0..NC {
                    // (10): c = kappa x o sum of the other agents' x.
                    let others = team.sum[c] - position[c];
                    force[c] = (others * self.kappa).mul_add(position[c], force[c]);
                }
            }
            Coupling::Centroid => {
                let share = L::number(1.0 / team.size as f64);
                for c in 0..NC {
                    // The same with x counted from the centroid, where all sum up to zero: the others' are minus one's
                    // own.
                    let from_centroid = team.sum[c].mul_add(-share, position[c]);
                    force[c] = (from_centroid * -self.kappa).mul_add(from_centroid, force[c]);
                }
            }
        }
        if !self.signals.frictions.is_empty() {
            let slowed = kernels::friction_forces(&self.signals.frictions, &velocity);
            for c in 0..NC {
                force[c] = force[c] + slowed[c];
            }
        }
        // An axis on its own has no vortices, and no channel of this number.
        if NC > HEIGHT && !self.vortices.is_empty() {
            let pushed = kernels::vortex_force(&self.vortices, own, team.places);
            force[HEIGHT] = force[HEIGHT] + pushed;
        }
        let inputs = Inputs {
            reference: rows,
            feedback: self.feedback::<P, C, STAGE>(setting, step),
            position,
            velocity,
            force,
            ground: &self.signals.ground,
            actuator: &self.signals.actuator,
            inverse_inertia: &self.signals.inverse_inertia,
        };
        setting.plant.respond(&inputs, self.extra.at::<STAGE>())
    }

    /// By how much x and x' are measured too large at the state of stage `STAGE`, beside f2.
    #[inline(always)]
    pub(crate) fn distortion<P: Plant<L, NC, NX>, const STAGE: usize>(
        &self,
        plant: &P,
        rows: &[ReferenceRow<L::Real>],
    ) -> [[L; 2]; NC] {
        if !self.signals.distorts() {
            return [[L::number(0.0); 2]; NC];
        }
        let moment = match STAGE {
            0 => Moment::Start,
            3 => Moment::End,
            _ => Moment::Middle,
        };
        kernels::distortion(&self.signals, moment, &self.motion::<P, STAGE>(plant, rows))
    }

    /// Keeps what the next step needs of the start of this one.
    #[inline(always)]
    pub(crate) fn remember<P: Plant<L, NC, NX>, C: Law<L, NS>>(
        &mut self,
        setting: &GroupParameters<'_, P, C, L::Real, NC>,
        rows: &[ReferenceRow<L::Real>],
        response: &Response<L, NC, NX>,
        step: u32,
    ) {
        self.held_feedback = self.feedback::<P, C, 0>(setting, step);
        let motion = self.motion::<P, 0>(&setting.plant, rows);
        kernels::remember(&mut self.signals, step, &response.sent, &motion);
    }

    #[inline(always)]
    pub(crate) fn observe<P: Plant<L, NC, NX>, C: Law<L, NS>, const SETTLED: bool>(
        &mut self,
        limits: &[Limits<L::Real>; NC],
        response: &Response<L, NC, NX>,
        off: &[[L; 2]; NC],
        step: u32,
    ) {
        let (never, now) = (L::number(f64::INFINITY), L::number(f64::from(step)));
        for c in 0..NC {
            let state = self.channels[c].at::<0>();
            let [f1_hat, f2_hat] = C::fault_estimates(state);
            let f1 = response.error_acceleration[c] - response.applied_feedback[c];
            let sample = Sample {
                error: state[1],
                error_rate: state[2],
                command: response.command[c],
                excess: response.excess[c],
                actuator_fault_error: f1_hat - f1,
                sensor_fault_error: f2_hat - (self.signals.sensor_fault[c] + off[c][1]),
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
