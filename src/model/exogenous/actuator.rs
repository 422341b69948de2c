//! What faults make of a command: what of it is held over a step, and what acts at a stage.

use crate::model::lanes::math::clamp;
use crate::model::lanes::{Lane, Real};

/// What faults do to the commands in a step.
#[derive(Clone)]
pub(crate) struct HeldCommand<L, const NC: usize> {
    /// What they leave of a command, and what they add to it.
    pub(crate) gain: [L; NC],
    pub(crate) bias: [L; NC],
    /// By how much the acting command may change in a step.
    pub(crate) slew: [L; NC],
    /// Whether the link brings no new command (1 or 0).
    pub(crate) blocked: [L; NC],
}

impl<L: Lane, const NC: usize> HeldCommand<L, NC> {
    /// No fault.
    pub(crate) fn sound() -> Self {
        let zero = [L::number(0.0); NC];
        Self {
            gain: [L::number(1.0); NC],
            bias: zero,
            slew: [L::splat(L::Real::MAX); NC],
            blocked: zero,
        }
    }
}

/// What is between the command that is demanded and the one that acts: clamp(gain demanded + bias, low, high), where
/// what is within the dead zone, if there is one, gives nothing.
#[derive(Clone)]
pub(crate) struct Actuator<L, const NC: usize> {
    pub(crate) gain: [L; NC],
    pub(crate) bias: [L; NC],
    pub(crate) low: [L; NC],
    pub(crate) high: [L; NC],
    /// Up to which size a command gives nothing in this step, if the campaign has such faults.
    pub(crate) dead_zone: Option<[L; NC]>,
}

impl<L: Lane, const NC: usize> Actuator<L, NC> {
    /// One that obeys.
    pub(crate) fn sound() -> Self {
        let (zero, one) = (L::number(0.0), L::number(1.0));
        let far = L::splat(L::Real::MAX);
        Self {
            gain: [one; NC],
            bias: [zero; NC],
            low: [-far; NC],
            high: [far; NC],
            dead_zone: None,
        }
    }

    /// The command that acts on a channel.
    #[inline(always)]
    pub(crate) fn command(&self, c: usize, sent: L) -> L {
        let mut arrived = sent.mul_add(self.gain[c], self.bias[c]);
        if let Some(dead_zone) = &self.dead_zone {
            arrived = beyond_dead_zone(arrived, dead_zone[c]);
        }
        clamp(arrived, self.low[c], self.high[c])
    }
}

/// What of a command goes beyond a dead zone of this half width.
#[inline(always)]
pub(crate) fn beyond_dead_zone<L: Lane>(command: L, half_width: L) -> L {
    command - clamp(command, -half_width, half_width)
}
