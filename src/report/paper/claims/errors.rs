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

/// What is left of the initial errors, as a share of them: the flight beside that without them.
fn left(flights: &Scenarios, channel: usize, pick: fn(&ChannelSample) -> f64) -> Series {
    let with = flights.series(Scenario::Ftc, channel, pick);
    let without = flights.series(Scenario::OnCourse, channel, pick);
    let initial = flights.met.errors.get(channel).copied();
    with.less(&without).over(initial.unwrap_or(f64::NAN))
}

/// From where the paper has its errors settled to the first jump, s.
fn first_stretch(flights: &Scenarios) -> Range<f64> {
    let first_s = flights.jumps_s(SETTLED_S).first().copied();
    SETTLED_S..part(flights, first_s.unwrap_or_default(), PEAK).start
}

/// The largest error of the stretches between later jumps, in units of that before the first; on the worst channel.
fn growth(flights: &Scenarios, pick: impl Fn(&ChannelSample) -> f64) -> f64 {
    worst(flights, |channel| {
        let series = flights.series(Scenario::Ftc, channel, &pick);
        let before = series.largest(first_stretch(flights));
        let jumps = flights.jumps_s(SETTLED_S).into_iter();
        top(jumps.map(|jump_s| series.largest(part(flights, jump_s, STRETCH)))) / before
    })
}

/// How fast the rest of the initial errors decays, 1/s.
fn decay(flights: &Scenarios) -> f64 {
    let half_s = flights.met.half_period_s();
    let end_s = flights.end_s();
    let at = |from_s: f64| {
        worst(flights, |channel| {
            left(flights, channel, error).largest(from_s - 0.1 * half_s..from_s)
        })
    };
    (at(half_s) / at(end_s)).ln() / (end_s - half_s)
}

/// What is left of the initial tracking errors after a time, and whether the errors grow later.
pub(super) fn tracking(flights: &Scenarios, within_s: f64) -> Found {
    let whole = 0.0..f64::INFINITY;
    let share = worst(flights, |channel| {
        left(flights, channel, error).largest(within_s..f64::INFINITY)
    });
    let [wide_s, narrow_s] = BANDS.map(|band| {
        worst(flights, |channel| {
            left(flights, channel, error).last_above(band, whole.clone())
        })
    });
    let [wide, narrow] = BANDS;
    let growth = growth(flights, error);
    Found {
        measured: format!(
            "from {within_s} s on, up to {} of the initial error is left (must be at most {}): below {} after {wide_s:.2} s, below {} \
             only after {narrow_s:.2} s, for the rest decays with {:.2} 1/s; later stretches between jumps have up to {growth:.2} times \
             the error of the first (at most {STEADY})",
            percent(share),
            percent(narrow),
            percent(wide),
            percent(narrow),
            decay(flights),
        ),
        holds: Some(share <= narrow && growth <= STEADY),
        read: vec![share, growth],
    }
}

/// When the estimation errors are at their own calm level for the first time, and what the initial errors have to do
/// with them.
pub(super) fn estimation(flights: &Scenarios, within_s: f64) -> Found {
    let share = worst(flights, |channel| {
        left(flights, channel, estimation_error).largest(0.0..f64::INFINITY)
    });
    // What follows the start is like it: later stretches, where a robot stands still, would be too calm a measure of
    // its walk.
    let begin_s = worst(flights, |channel| {
        let series = flights.series(Scenario::Ftc, channel, estimation_error);
        let steady = series.largest(first_stretch(flights));
        series.last_above(BACK * steady, 0.0..SETTLED_S)
    });
    let peaks = worst_of_groups(flights, |channel| {
        let series = flights.series(Scenario::Ftc, channel, estimation_error);
        series.largest(0.0..SETTLED_S)
    });
    let growth = growth(flights, estimation_error);
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
fn peak(flights: &Scenarios, series: &Series) -> f64 {
    let jumps = flights.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| series.largest(part(flights, jump_s, PEAK))))
}

/// How large the errors become at the jumps, and how soon they are back.
pub(super) fn jitter(flights: &Scenarios) -> Found {
    let of = |channel: usize| flights.series(Scenario::Ftc, channel, error);
    let peaks = worst_of_groups(flights, |channel| peak(flights, &of(channel)));
    let back_s = worst(flights, |channel| back_s(flights, &of(channel)));
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
pub(super) fn kept(flights: &Scenarios, pick: fn(&ChannelSample) -> f64) -> Found {
    let of = |channel: usize| flights.series(Scenario::Ftc, channel, pick);
    let growth = growth(flights, pick);
    let peaks = worst_of_groups(flights, |channel| peak(flights, &of(channel)));
    let factor = worst(flights, |channel| {
        let series = of(channel);
        peak(flights, &series) / calm(flights, &series)
    });
    let back_s = worst(flights, |channel| back_s(flights, &of(channel)));
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
