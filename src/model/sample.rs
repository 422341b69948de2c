//! What one channel shows at one instant.

use crate::synthesis::LOOP_STATES;

/// What one channel shows at one instant; of a block of episodes, in lanes.
#[derive(Debug, Clone, Copy, Default)]
pub struct ChannelSample<T = f64> {
    /// Reference.
    pub r: T,
    /// State.
    pub x: T,
    /// Tracking error.
    pub e: T,
    /// Its rate.
    pub e_rate: T,
    /// Its estimate.
    pub e_hat: T,
    /// Actuator fault signal, (14).
    pub f1: T,
    /// Its estimate.
    pub f1_hat: T,
    /// Sensor fault signal, (16), and what else the rate is measured too large by.
    pub f2: T,
    /// Its estimate.
    pub f2_hat: T,
    /// The command that acts: u of (9) after limits and faults; under thrust, x, y and z are the force demanded.
    pub u: T,
}

/// What the loop of one channel holds at one instant beside what it shows: what inequality (24) weighs.
#[derive(Debug, Clone, Copy, Default)]
pub struct ObserverState<T = f64> {
    /// int e.
    pub integral: T,
    /// The observer's states `[int e, e, e', F1 (2), F2 (2)]`, zero beyond those that it has.
    pub observer: [T; LOOP_STATES],
    /// The feedback that was applied, of which the observer knows.
    pub applied_feedback: T,
}

impl<T: Copy> ChannelSample<T> {
    /// The same of something of each number.
    #[inline(always)]
    pub(crate) fn map<U>(&self, of: impl Fn(T) -> U) -> ChannelSample<U> {
        ChannelSample {
            r: of(self.r),
            x: of(self.x),
            e: of(self.e),
            e_rate: of(self.e_rate),
            e_hat: of(self.e_hat),
            f1: of(self.f1),
            f1_hat: of(self.f1_hat),
            f2: of(self.f2),
            f2_hat: of(self.f2_hat),
            u: of(self.u),
        }
    }
}

impl<T: Copy> ObserverState<T> {
    /// The same of something of each number.
    #[inline(always)]
    pub(crate) fn map<U>(&self, of: impl Fn(T) -> U) -> ObserverState<U> {
        ObserverState {
            integral: of(self.integral),
            observer: self.observer.map(&of),
            applied_feedback: of(self.applied_feedback),
        }
    }
}
