//! A controller that measures without error: u_fb = K [int e, e, e']'. It shows the plant apart from any observer.

use super::{Law, Measured, step_error};
use crate::model::integrator::{Step, Stepped};
use crate::model::lanes::{Lane, Real};

/// States of a channel under it: none beside those of the error.
pub(crate) const TRUE_STATES: usize = 3;

/// K on [int e, e, e'].
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrueState<R> {
    feedback: [R; 3],
}

impl<R: Real> TrueState<R> {
    pub(crate) fn new(feedback: [f64; 3]) -> Self {
        Self {
            feedback: feedback.map(R::from_f64),
        }
    }
}

impl<L: Lane> Law<L, TRUE_STATES> for TrueState<L::Real> {
    fn start(&self, _state: &mut [L; TRUE_STATES], _off: [L; 2], _sensor_fault: L) {}

    #[inline(always)]
    fn feedback(&self, [integral, error, rate]: &[L; TRUE_STATES]) -> L {
        let k = &self.feedback;
        let mut sum = *integral * L::splat(k[0]);
        sum = error.mul_add(L::splat(k[1]), sum);
        rate.mul_add(L::splat(k[2]), sum)
    }

    #[inline(always)]
    fn step<const STAGE: usize>(
        &self,
        channel: &mut Stepped<L, TRUE_STATES>,
        error_acceleration: L,
        _measured: &Measured<L>,
        _applied_feedback: L,
        h: &Step<L::Real>,
    ) {
        let state = *channel.at::<STAGE>();
        channel.take::<STAGE>(0, state[1], h);
        step_error::<L, TRUE_STATES, STAGE>(channel, &state, error_acceleration, h);
    }

    #[inline(always)]
    fn error_estimate(state: &[L; TRUE_STATES]) -> [L; 3] {
        *state
    }

    #[inline(always)]
    fn fault_estimates(_state: &[L; TRUE_STATES]) -> [L; 2] {
        [L::number(0.0); 2]
    }
}
