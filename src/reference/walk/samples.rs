//! Counting samples: how many there may be, and numbers of them as sizes and as reals.

/// Bounds memory and time: 33 minutes at 10 ms.
pub(super) const MAX_SAMPLES: u32 = 200_000;

/// Relative rounding of lengths and times: a line of five steps has five.
pub(super) const ROUNDING: f64 = 1e-6;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small count that is not negative; the cast saturates"
)]
pub(super) fn floor(x: f64) -> usize {
    x as usize
}

#[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
pub(super) fn count(n: usize) -> f64 {
    n as f64
}
