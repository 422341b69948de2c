//! How much of an axis is shown: all there is, unless something ran away.

use std::ops::RangeInclusive;

/// Share of the values at either end that may be peaks, which do not decide on the frame.
const TAIL: f64 = 0.01;
/// Parts of a frame's height that cannot be told apart: a tenth of a pixel.
const FINE: f64 = 1600.0;
/// Room around what is shown.
const ROOM: f64 = 0.05;

/// The ends of an axis, and whether something lies outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) cut: bool,
}

impl Frame {
    /// The frame of some values: of all that lie within `room` times the range of those that are no peaks; none without
    /// values.
    pub(super) fn of(mut values: Vec<f64>, room: f64) -> Option<Self> {
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        let (&low, &high) = (values.first()?, values.last()?);
        let tail = (values.len() as f64 * TAIL).floor();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a part of a length"
        )]
        let tail = tail as usize;
        let (from, to) = (values[tail], values[values.len() - 1 - tail]);
        let beyond = match room * (to - from) {
            none if none > 0.0 => none,
            _ => f64::INFINITY,
        };
        let (least, most) = (from - beyond, to + beyond);
        let cut = low < least || high > most;
        Some(Self::around(low.max(least), high.min(most), cut))
    }

    fn around(low: f64, high: f64, cut: bool) -> Self {
        let room = match ROOM * (high - low) {
            room if room > 1e-9 * low.abs().max(high.abs()) => room,
            _ => (ROOM * high.abs()).max(1e-9),
        };
        Self {
            low: low - room,
            high: high + room,
            cut,
        }
    }

    pub(super) fn range(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// The same with values that are to be seen at any rate.
    pub(super) fn with(self, values: &[f64]) -> Self {
        let low = values.iter().copied().fold(self.low, f64::min);
        let high = values.iter().copied().fold(self.high, f64::max);
        match low < self.low || high > self.high {
            true => Self::around(low, high, self.cut),
            false => self,
        }
    }

    /// What cannot be seen.
    pub(super) fn fine(&self) -> f64 {
        (self.high - self.low) / FINE
    }

    /// The frame with as much again below and above.
    fn surroundings(&self) -> RangeInclusive<f64> {
        let height = self.high - self.low;
        self.low - height..=self.high + height
    }

    /// A value brought near the frame, so that the line that leaves it is short.
    pub(super) fn near(&self, value: f64) -> f64 {
        let around = self.surroundings();
        value.clamp(*around.start(), *around.end())
    }

    /// Whether a value lies in the frame or near it.
    pub(super) fn is_near(&self, value: f64) -> bool {
        self.surroundings().contains(&value)
    }
}
