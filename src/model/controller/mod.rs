//! Controllers: the law of one channel, from what is measured to the feedback.
//!
//! A channel's state is [int e, e, e', what its controller keeps]: errors are small numbers, so single precision keeps
//! their digits. A family of controllers is a file here: its gains, and its `Law`. [`kinds`] lists the families; the
//! loop asks them for nothing but their law.

pub mod kinds;
pub(crate) mod observer_feedback;
pub(crate) mod true_state;

use super::integrator::{Step, Stepped};
use super::lanes::Lane;

/// States of a channel before those of its controller.
pub const OBSERVER: usize = 3;

/// What becomes of the outputs before the controller sees them.
pub(crate) struct Measured<L> {
    /// f2, which enters through B20.
    pub(crate) sensor_fault: L,
    /// By how much x and x' are measured too large beside it.
    pub(crate) off: [L; 2],
    /// Whether the first output is the integral of what is measured, and not that of e.
    pub(crate) integral: bool,
}

/// The gains of one channel as a law; `NS` counts all states of the channel.
pub(crate) trait Law<L: Lane, const NS: usize>: Copy + Send + Sync {
    /// Sets the states of the controller from what is measured at t = 0; without it they start at zero.
    fn start(&self, state: &mut [L; NS], off: [L; 2], sensor_fault: L);

    /// u_fb, (21).
    fn feedback(&self, state: &[L; NS]) -> L;

    /// Takes one stage of the channel's step: its derivative [e, e', e'', what the controller keeps].
    /// `applied_feedback` is the feedback of which the controller learns that it was commanded, after filter and
    /// limits.
    fn step<const STAGE: usize>(
        &self,
        channel: &mut Stepped<L, NS>,
        error_acceleration: L,
        measured: &Measured<L>,
        applied_feedback: L,
        h: &Step<L::Real>,
    );

    /// The estimates of int e, e and e'.
    fn error_estimate(state: &[L; NS]) -> [L; 3];

    /// The estimates of f1 and f2; zero if there are none.
    fn fault_estimates(state: &[L; NS]) -> [L; 2];
}

/// The rows e and e' of a stage, which no controller changes.
#[inline(always)]
pub(crate) fn step_error<L: Lane, const NS: usize, const STAGE: usize>(
    channel: &mut Stepped<L, NS>,
    state: &[L; NS],
    error_acceleration: L,
    h: &Step<L::Real>,
) {
    channel.take::<STAGE>(1, state[2], h);
    channel.take::<STAGE>(2, error_acceleration, h);
}
