//! The time between two jumps of the sensor fault, and what a curve does in it.

use super::found::SETTLED_S;
use crate::report::paper::measures::{Series, top};
use crate::report::paper::scenarios::Scenarios;

/// What is read of the time between two jumps of the sensor fault, as shares of it: the peak around the jump, from
/// before it; the calm part, clear of this jump and of the next; what a stretch between jumps is.
pub(super) const PEAK: [f64; 2] = [-0.1, 0.3];
pub(super) const CALM: [f64; 2] = [0.6, 0.9];
pub(super) const STRETCH: [f64; 2] = [0.4, 0.9];
/// An error is back where it stays within so many times its own calm error.
pub(super) const BACK: f64 = 1.5;

/// A part of the time after a jump, s.
pub(super) fn part(scenarios: &Scenarios, jump_s: f64, shares: [f64; 2]) -> std::ops::Range<f64> {
    let [from_s, until_s] = shares.map(|share| jump_s + share * scenarios.met.half_period_s());
    from_s..until_s
}

/// A curve's calm level: its largest size in the calm parts.
pub(super) fn calm(scenarios: &Scenarios, series: &Series) -> f64 {
    let jumps = scenarios.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| series.largest(part(scenarios, jump_s, CALM))))
}

/// How soon after the jumps a curve is back at its calm level, s; the longest.
pub(super) fn back_s(scenarios: &Scenarios, series: &Series) -> f64 {
    let bound = BACK * calm(scenarios, series);
    let jumps = scenarios.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| {
        let until_calm = part(scenarios, jump_s, [0.0, CALM[0]]);
        series.last_above(bound, until_calm) - jump_s
    }))
}
