//! The time of an episode in steps.

use crate::util::format::without_dust;

/// Duration and step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// Integration step, s.
    pub step_s: f64,
    /// Steps of an episode.
    pub steps: u32,
    /// First step of the metrics.
    pub settle_step: u32,
}

/// What steps make of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// Nothing: it is no time, or one that need not be whole steps.
    AsDrawn,
    /// A time at which something begins: that of a step.
    Onset,
    /// How long something lasts or lags: whole steps, at least one.
    Length,
}

impl Time {
    /// The step at which a fault of this onset begins; t = k dt is never accumulated, and a hair below a step belongs
    /// to it.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "onsets are validated to lie in the run"
    )]
    pub fn onset_step(&self, onset_s: f64) -> u32 {
        (onset_s / self.step_s - 1e-9).ceil().max(0.0) as u32
    }

    /// The time of a step's beginning, s, as people write it: 0.3, not 0.30000000000000004.
    #[must_use]
    pub fn shown_s(&self, step: u32) -> f64 {
        without_dust(f64::from(step) * self.step_s)
    }

    /// A length of time in steps: the nearest number of them, at least one.
    #[must_use]
    pub fn whole_steps(&self, length_s: f64) -> f64 {
        (length_s / self.step_s).round().max(1.0)
    }

    /// A value as it acts.
    #[must_use]
    pub fn applied(&self, timing: Timing, value: f64) -> f64 {
        match timing {
            Timing::AsDrawn => value,
            Timing::Onset => f64::from(self.onset_step(value)) * self.step_s,
            Timing::Length => self.whole_steps(value) * self.step_s,
        }
    }
}
