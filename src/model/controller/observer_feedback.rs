//! Feedback of what an observer estimates: observer (20) and feedback (21) of one channel, in the form that is
//! integrated.
//!
//! The observer of the FTC has 7 states, [ehat (3), F1 (2), F2 (2)], an exact reduction of the 12 of (19): the taps
//! beyond the second are a delay line that never feeds back. The observer of a PID has the 3 states ehat.

use super::{Law, Measured, OBSERVER, step_error};
use crate::model::integrator::{Step, Stepped};
use crate::model::lanes::{Lane, Real};
use crate::synthesis::LoopGains;

/// States of a channel under the FTC.
pub(crate) const FTC_STATES: usize = 10;
/// States of a channel under a PID.
pub(crate) const PID_STATES: usize = 6;

/// Gains of one channel in the precision of the loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChannelGains<R> {
    /// K of (21).
    pub(crate) feedback: [R; 7],
    /// -L of (20).
    pub(crate) injection: [[R; 3]; 7],
    /// Smoothing model (18): F_0' = a F_0 + b F_1, F_1' = c (F_0 - F_1).
    pub(crate) smoothing: [R; 3],
    /// Second and third entry of B20, (34); the first is zero, since the integral is computed and not sensed.
    pub(crate) sensor_fault_input: [R; 2],
}

impl<R: Real> ChannelGains<R> {
    /// The gains rounded to this precision.
    #[must_use]
    pub(crate) fn new(gains: &LoopGains) -> Self {
        Self {
            feedback: gains.k.map(R::from_f64),
            injection: gains.l.map(|row| row.map(|entry| R::from_f64(-entry))),
            smoothing: gains.smoothing.map(R::from_f64),
            sensor_fault_input: [1, 2].map(|row| R::from_f64(gains.sensor_fault_input[row])),
        }
    }

    /// What the observer starts from: ehat = y(0) - C0 r(0) and no faults.
    pub(crate) fn measured<L: Lane<Real = R>>(
        &self,
        integral: L,
        error: L,
        rate: L,
        fault: L,
    ) -> [L; 3] {
        let [b1, b2] = self.sensor_fault_input.map(L::splat);
        [integral, fault.mul_add(b1, error), fault.mul_add(b2, rate)]
    }
}

impl<L: Lane, const NS: usize> Law<L, NS> for ChannelGains<L::Real> {
    fn start(&self, state: &mut [L; NS], off: [L; 2], sensor_fault: L) {
        let [error, rate] = [state[1] + off[0], state[2] + off[1]];
        let estimates = self.measured(state[0], error, rate, sensor_fault);
        state[OBSERVER..OBSERVER + 3].copy_from_slice(&estimates);
    }

    // u_fb = K ehat, (21).
    #[inline(always)]
    fn feedback(&self, state: &[L; NS]) -> L {
        let k = &self.feedback;
        let mut sum = state[OBSERVER] * L::splat(k[0]);
        sum = state[OBSERVER + 1].mul_add(L::splat(k[1]), sum);
        sum = state[OBSERVER + 2].mul_add(L::splat(k[2]), sum);
        if NS == FTC_STATES {
            sum = state[OBSERVER + 3].mul_add(L::splat(k[3]), sum);
            sum = state[OBSERVER + 4].mul_add(L::splat(k[4]), sum);
        }
        sum
    }

    // Each row is taken as soon as it is known, so that few values live at once.
    #[inline(always)]
    fn step<const STAGE: usize>(
        &self,
        channel: &mut Stepped<L, NS>,
        error_acceleration: L,
        measured: &Measured<L>,
        applied_feedback: L,
        h: &Step<L::Real>,
    ) {
        let [b1, b2] = [
            L::splat(self.sensor_fault_input[0]),
            L::splat(self.sensor_fault_input[1]),
        ];
        let [a, b, c] = [
            L::splat(self.smoothing[0]),
            L::splat(self.smoothing[1]),
            L::splat(self.smoothing[2]),
        ];
        let state = *channel.at::<STAGE>();
        let unexplained = if NS == FTC_STATES {
            measured.sensor_fault - state[OBSERVER + 5]
        } else {
            measured.sensor_fault
        };
        let [error, rate] = [state[1] + measured.off[0], state[2] + measured.off[1]];
        // y - yhat of (20); C0 r cancels.
        let innovation = [
            state[0] - state[OBSERVER],
            unexplained.mul_add(b1, error - state[OBSERVER + 1]),
            unexplained.mul_add(b2, rate - state[OBSERVER + 2]),
        ];
        let integrand = if measured.integral {
            measured.sensor_fault.mul_add(b1, error)
        } else {
            state[1]
        };
        channel.take::<STAGE>(0, integrand, h);
        step_error::<L, NS, STAGE>(channel, &state, error_acceleration, h);
        let rows = &self.injection;
        let mut row = injected(&rows[0], &innovation, state[OBSERVER + 1]);
        channel.take::<STAGE>(OBSERVER, row, h);
        row = injected(&rows[1], &innovation, state[OBSERVER + 2]);
        channel.take::<STAGE>(OBSERVER + 1, row, h);
        if NS == FTC_STATES {
            let [f1, f1_before] = [state[OBSERVER + 3], state[OBSERVER + 4]];
            row = injected(&rows[2], &innovation, f1) + applied_feedback;
            channel.take::<STAGE>(OBSERVER + 2, row, h);
            row = injected(&rows[3], &innovation, f1.mul_add(a, f1_before * b));
            channel.take::<STAGE>(OBSERVER + 3, row, h);
            row = injected(&rows[4], &innovation, (f1 - f1_before) * c);
            channel.take::<STAGE>(OBSERVER + 4, row, h);
            let [f2, f2_before] = [state[OBSERVER + 5], state[OBSERVER + 6]];
            row = injected(&rows[5], &innovation, f2.mul_add(a, f2_before * b));
            channel.take::<STAGE>(OBSERVER + 5, row, h);
            row = injected(&rows[6], &innovation, (f2 - f2_before) * c);
            channel.take::<STAGE>(OBSERVER + 6, row, h);
        } else {
            row = injected(&rows[2], &innovation, applied_feedback);
            channel.take::<STAGE>(OBSERVER + 2, row, h);
        }
    }

    #[inline(always)]
    fn error_estimate(state: &[L; NS]) -> [L; 3] {
        [state[OBSERVER], state[OBSERVER + 1], state[OBSERVER + 2]]
    }

    // A PID has no estimates and is taken to estimate zero.
    #[inline(always)]
    fn fault_estimates(state: &[L; NS]) -> [L; 2] {
        if NS == FTC_STATES {
            [state[OBSERVER + 3], state[OBSERVER + 5]]
        } else {
            [L::number(0.0); 2]
        }
    }
}

/// base - L (y - yhat), one row.
#[inline(always)]
pub(crate) fn injected<L: Lane>(row: &[L::Real; 3], innovation: &[L; 3], base: L) -> L {
    let mut sum = innovation[0].mul_add(L::splat(row[0]), base);
    sum = innovation[1].mul_add(L::splat(row[1]), sum);
    innovation[2].mul_add(L::splat(row[2]), sum)
}
