//! Figures 12 to 14 and 16 to 18: estimates of the faults, and the control.

use super::found::{Found, SETTLED_S};
use super::groups::{channels, grouped, quotients, with_units, worst, worst_of_groups};
use super::jumps::{BACK, CALM, PEAK, back_s, calm, part};
use crate::agent::Agent;
use crate::report::paper::measures::{Series, bottom, percent, top};
use crate::report::paper::scenarios::{Scenario, Scenarios};
use crate::statistics::rms;
use crate::util::format::number;

/// An estimate may be wrong by this share of what it estimates.
const WRONG: f64 = 0.15;
/// The initial instant, s: the loop's fast poles are over by then, the disturbance is not yet near its first peak.
const START_S: f64 = 0.2;
/// A frequency is high if it is so many times that of later.
const HIGH: f64 = 2.0;
/// A sine explains this share of the variance, and has the amplitude of what it cancels up to a tenth.
const SINE: f64 = 0.9;
/// A constant force may vary by this share.
const CONSTANT: f64 = 0.1;

/// The unit of the control in a channel of m or rad of an agent.
fn effort(scenarios: &Scenarios) -> impl Fn(&str) -> String {
    let robot = matches!(scenarios.group.agent, Agent::Biped(_));
    move |unit| if unit == "m" && !robot { "N" } else { "N m" }.into()
}

fn control(scenarios: &Scenarios, channel: usize) -> Series {
    scenarios.series(Scenario::Ftc, channel, |shown| shown.u)
}

/// How wrong the estimate of f1 is.
pub(super) fn estimated(scenarios: &Scenarios) -> Found {
    let share = worst(scenarios, |channel| {
        let truth = scenarios.series(Scenario::Ftc, channel, |shown| shown.f1);
        let wrong = scenarios.series(Scenario::Ftc, channel, |shown| shown.f1_hat - shown.f1);
        rms(wrong.after(SETTLED_S)) / rms(truth.after(SETTLED_S))
    });
    Found {
        measured: format!(
            "RMS error of the estimate from {SETTLED_S} s on: {} of the RMS of the fault, on the worst channel (must be at most {})",
            percent(share),
            percent(WRONG)
        ),
        holds: Some(share <= WRONG),
        read: vec![share],
    }
}

/// How far the estimate of f2 overshoots where f2 jumps, and how soon its error is at its own calm level again.
pub(super) fn overshoot(scenarios: &Scenarios) -> Found {
    let size = scenarios.met.fault.abs();
    let over = worst(scenarios, |channel| {
        let estimate = scenarios.series(Scenario::Ftc, channel, |shown| shown.f2_hat);
        let jumps = scenarios.jumps_s(SETTLED_S).into_iter();
        top(jumps.map(|jump_s| {
            estimate.largest(part(scenarios, jump_s, [PEAK[0], CALM[0]])) / size - 1.0
        }))
    });
    let wrong =
        |channel: usize| scenarios.series(Scenario::Ftc, channel, |shown| shown.f2_hat - shown.f2);
    let calm = worst(scenarios, |channel| calm(scenarios, &wrong(channel))) / size;
    let back_s = worst(scenarios, |channel| back_s(scenarios, &wrong(channel)));
    Found {
        measured: format!(
            "overshoots by up to {}; its error is within {BACK} times its calm level (up to {} of the fault) again after {back_s:.2} s \
             (must be within {SETTLED_S} s)",
            percent(over),
            percent(calm)
        ),
        holds: Some(over > 0.0 && back_s <= SETTLED_S),
        read: vec![over, back_s],
    }
}

/// How the control starts, beside how it goes on.
pub(super) fn start(scenarios: &Scenarios) -> Found {
    let largest = |from_s: f64, until_s: f64| {
        worst_of_groups(scenarios, |channel| {
            control(scenarios, channel).largest(from_s..until_s)
        })
    };
    let (first, later) = (largest(0.0, START_S), largest(SETTLED_S, f64::INFINITY));
    let pace = |from_s: f64, until_s: f64| {
        grouped(scenarios, |channels| {
            let controls: Vec<Series> = channels
                .iter()
                .map(|channel| control(scenarios, *channel))
                .collect();
            let slopes: Vec<Series> = controls.iter().map(Series::slopes).collect();
            let size = |all: &[Series]| {
                rms(all
                    .iter()
                    .flat_map(|series| series.within(from_s..until_s).collect::<Vec<_>>()))
            };
            size(&slopes) / size(&controls)
        })
    };
    let (fast, slow) = (pace(0.0, START_S), pace(SETTLED_S, f64::INFINITY));
    let amplitudes = quotients(&first, &later);
    let frequencies = quotients(&fast, &slow);
    let higher = channels(scenarios).filter(|channel| {
        let series = control(scenarios, *channel);
        series.largest(0.0..START_S) > series.largest(SETTLED_S..f64::INFINITY)
    });
    let unit = effort(scenarios);
    let per_second = |_: &str| "1/s".to_string();
    Found {
        measured: format!(
            "|u| up to {} before {START_S} s, {} from {SETTLED_S} s on (more at the start on {} of {} channels); RMS of du/dt over that of \
             u: {} before, {} after",
            with_units(&first, &unit),
            with_units(&later, &unit),
            higher.count(),
            channels(scenarios).len(),
            with_units(&fast, per_second),
            with_units(&slow, per_second),
        ),
        holds: Some(
            amplitudes.iter().all(|factor| *factor > 1.0)
                && frequencies.iter().all(|factor| *factor > HIGH),
        ),
        read: [amplitudes, frequencies].concat(),
    }
}

/// How much of the control is a sine that cancels the disturbance.
pub(super) fn sine(scenarios: &Scenarios) -> Found {
    let force = scenarios.met.force.abs();
    let waves = channels(scenarios)
        .map(|channel| control(scenarios, channel).wave(scenarios.met.force_rad_s, SETTLED_S));
    let waves: Vec<_> = waves.collect();
    let share = bottom(waves.iter().map(|wave| wave.share));
    let low = bottom(waves.iter().map(|wave| wave.amplitude / force));
    let high = top(waves.iter().map(|wave| wave.amplitude / force));
    Found {
        measured: format!(
            "from {SETTLED_S} s on a sine of {} rad/s is at least {} of the variance of u (must be {}), with {} to {} of the \
             disturbance's amplitude",
            number(scenarios.met.force_rad_s),
            percent(share),
            percent(SINE),
            percent(low),
            percent(high),
        ),
        holds: Some(share >= SINE && low >= SINE && high <= 2.0 - SINE),
        read: vec![share, low, high],
    }
}

/// The size of the force that a UAV's controls demand, beside its weight.
pub(super) fn thrust(scenarios: &Scenarios) -> Found {
    let weight = match &scenarios.group.agent {
        Agent::Uav(uav) => uav.mass_kg * uav.gravity_m_s2 * scenarios.met.mass_scale,
        Agent::Biped(_) => f64::NAN,
    };
    let axes = [0, 1, 2].map(|axis| control(scenarios, axis));
    let [x, y, z] = axes.each_ref().map(|axis| axis.after(SETTLED_S));
    let force = x.zip(y).zip(z).map(|((x, y), z)| x.hypot(y).hypot(z));
    let force: Vec<f64> = force.collect();
    let (low, high) = (bottom(force.iter().copied()), top(force.iter().copied()));
    Found {
        measured: format!(
            "F lies between {} and {} N from {SETTLED_S} s on, the weight is {} N (must stay within {} of it): on each axis the \
             controls cancel a disturbance of {} N",
            number(low),
            number(high),
            number(weight),
            percent(CONSTANT),
            number(scenarios.met.force)
        ),
        holds: Some(low >= (1.0 - CONSTANT) * weight && high <= (1.0 + CONSTANT) * weight),
        read: vec![low, high, weight],
    }
}
