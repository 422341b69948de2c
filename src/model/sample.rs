//! What one channel shows at one instant.

use crate::synthesis::LOOP_STATES;

/// What one channel shows at one instant, `[lane]`.
#[derive(Debug, Clone, Copy, Default)]
pub struct ChannelSample {
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
    /// Sensor fault signal, (16), and what else the rate is measured too large by.
    pub f2: f64,
    /// Its estimate.
    pub f2_hat: f64,
    /// The command that acts: u of (9) after limits and faults; under thrust, x, y and z are the force demanded.
    pub u: f64,
}

/// What the loop of one channel holds at one instant beside what it shows, `[lane]`: what inequality (24) weighs.
#[derive(Debug, Clone, Copy, Default)]
pub struct ObserverState {
    /// int e.
    pub integral: f64,
    /// The observer's states `[int e, e, e', F1 (2), F2 (2)]`, zero beyond those that it has.
    pub observer: [f64; LOOP_STATES],
    /// The feedback that was applied, of which the observer knows.
    pub applied_feedback: f64,
}
