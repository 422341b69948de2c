//! Figures 11 and 15: tracking errors and the errors of their estimates under the FTC.

use super::found::{Found, SETTLED_S};
use super::groups::{own, with_units, worst, worst_of_groups};
use super::jumps::{BACK, PEAK, STRETCH, back_s, calm, part};
use crate::model::ChannelSample;
use crate::report::paper::measures::{Series, percent, top};
use crate::report::paper::scenarios::{Scenario, Scenarios};
use std::ops::Range;

/// Bands of settling, as shares of the initial error; the claim is judged by the narrower.
const BANDS: [f64; 2] = [0.10, 0.05];
/// A steady state may vary by this factor.
const STEADY: f64 = 1.5;

fn error(shown: &ChannelSample) -> f64 {
    shown.e
}

fn estimation_error(shown: &ChannelSample) -> f64 {
    shown.e - shown.e_hat
}

/// What is left of the initial errors, as a share of them: the episode beside that without them.
fn left(scenarios: &Scenarios, channel: usize, pick: fn(&ChannelSample) -> f64) -> Series {
    let with = scenarios.series(Scenario::Ftc, channel, pick);
    let without = scenarios.series(Scenario::OnCourse, channel, pick);
    let initial = scenarios.met.errors.get(channel).copied();
    with.less(&without).over(initial.unwrap_or(f64::NAN))
}

/// From where the paper has its errors settled to the first jump, s.
fn first_stretch(scenarios: &Scenarios) -> Range<f64> {
    let first_s = scenarios.jumps_s(SETTLED_S).first().copied();
    SETTLED_S..part(scenarios, first_s.unwrap_or_default(), PEAK).start
}

/// The largest error of the stretches between later jumps, in units of that before the first; on the worst channel.
fn growth(scenarios: &Scenarios, pick: impl Fn(&ChannelSample) -> f64) -> f64 {
    worst(scenarios, |channel| {
        let series = scenarios.series(Scenario::Ftc, channel, &pick);
        let before = series.largest(first_stretch(scenarios));
        let jumps = scenarios.jumps_s(SETTLED_S).into_iter();
        top(jumps.map(|jump_s| series.largest(part(scenarios, jump_s, STRETCH)))) / before
    })
}

/// How fast the rest of the initial errors decays, 1/s.
fn decay(scenarios: &Scenarios) -> f64 {
    let half_s = scenarios.met.half_period_s();
    let end_s = scenarios.end_s();
    let at = |from_s: f64| {
        worst(scenarios, |channel| {
            left(scenarios, channel, error).largest(from_s - 0.1 * half_s..from_s)
        })
    };
    (at(half_s) / at(end_s)).ln() / (end_s - half_s)
}

/// What is left of the initial tracking errors after a time, and whether the errors grow later.
pub(super) fn tracking(scenarios: &Scenarios, within_s: f64) -> Found {
    let whole = 0.0..f64::INFINITY;
    let share = worst(scenarios, |channel| {
        left(scenarios, channel, error).largest(within_s..f64::INFINITY)
    });
    let [wide_s, narrow_s] = BANDS.map(|band| {
        worst(scenarios, |channel| {
            left(scenarios, channel, error).last_above(band, whole.clone())
        })
    });
    let [wide, narrow] = BANDS;
    let growth = growth(scenarios, error);
    Found {
        measured: format!(
            "from {within_s} s on, up to {} of the initial error is left (must be at most {}): below {} after {wide_s:.2} s, below {} \
             only after {narrow_s:.2} s, for the rest decays with {:.2} 1/s; later stretches between jumps have up to {growth:.2} times \
             the error of the first (at most {STEADY})",
            percent(share),
            percent(narrow),
            percent(wide),
            percent(narrow),
            decay(scenarios),
        ),
        holds: Some(share <= narrow && growth <= STEADY),
        read: vec![share, growth],
    }
}

/// When the estimation errors are at their own calm level for the first time, and what the initial errors have to do
/// with them.
pub(super) fn estimation(scenarios: &Scenarios, within_s: f64) -> Found {
    let share = worst(scenarios, |channel| {
        left(scenarios, channel, estimation_error).largest(0.0..f64::INFINITY)
    });
    // What follows the start is like it: later stretches, where a robot stands still, would be too calm a measure of
    // its walk.
    let begin_s = worst(scenarios, |channel| {
        let series = scenarios.series(Scenario::Ftc, channel, estimation_error);
        let steady = series.largest(first_stretch(scenarios));
        series.last_above(BACK * steady, 0.0..SETTLED_S)
    });
    let peaks = worst_of_groups(scenarios, |channel| {
        let series = scenarios.series(Scenario::Ftc, channel, estimation_error);
        series.largest(0.0..SETTLED_S)
    });
    let growth = growth(scenarios, estimation_error);
    Found {
        measured: format!(
            "|e - e_hat| starts from zero, is up to {} before the observer knows the faults, and stays within {BACK} times its steady \
             level after {begin_s:.2} s (must be within {within_s} s); at most {} of the initial error is ever in it; later stretches between \
             jumps have up to {growth:.2} times the error of the first (at most {STEADY})",
            with_units(&peaks, own),
            percent(share),
        ),
        holds: Some(begin_s <= within_s && share <= BANDS[1] && growth <= STEADY),
        read: vec![share, begin_s, growth],
    }
}

/// The peaks of a curve around the jumps of the sensor fault.
fn peak(scenarios: &Scenarios, series: &Series) -> f64 {
    let jumps = scenarios.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| series.largest(part(scenarios, jump_s, PEAK))))
}

/// How large the errors become at the jumps, and how soon they are back.
pub(super) fn jitter(scenarios: &Scenarios) -> Found {
    let of = |channel: usize| scenarios.series(Scenario::Ftc, channel, error);
    let peaks = worst_of_groups(scenarios, |channel| peak(scenarios, &of(channel)));
    let back_s = worst(scenarios, |channel| back_s(scenarios, &of(channel)));
    Found {
        measured: format!(
            "|e| up to {} around the jumps; within {BACK} times its calm level again after {back_s:.2} s (must be within {SETTLED_S} \
             s)",
            with_units(&peaks, own),
        ),
        holds: Some(back_s <= SETTLED_S),
        read: vec![back_s],
    }
}

/// Whether errors stay at their calm level, between the jumps and at them.
pub(super) fn kept(scenarios: &Scenarios, pick: fn(&ChannelSample) -> f64) -> Found {
    let of = |channel: usize| scenarios.series(Scenario::Ftc, channel, pick);
    let growth = growth(scenarios, pick);
    let peaks = worst_of_groups(scenarios, |channel| peak(scenarios, &of(channel)));
    let factor = worst(scenarios, |channel| {
        let series = of(channel);
        peak(scenarios, &series) / calm(scenarios, &series)
    });
    let back_s = worst(scenarios, |channel| back_s(scenarios, &of(channel)));
    Found {
        measured: format!(
            "stretches between jumps have up to {growth:.2} times the error of the first; at the jumps it is up to {}, on the worst \
             channel {factor:.1} times its calm level, for {back_s:.2} s (must be at most {STEADY} times)",
            with_units(&peaks, own),
        ),
        holds: Some(growth <= STEADY && factor <= STEADY),
        read: vec![growth, factor],
    }
}
