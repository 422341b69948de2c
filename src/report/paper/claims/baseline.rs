//! Figures 19 and 20: the PID without fault tolerance beside the FTC.

use super::found::{Found, SETTLED_S};
use super::groups::{Grouped, grouped, own, quotients, rate, times, with_units, worst_of_groups};
use crate::report::paper::measures::top;
use crate::report::paper::scenarios::{Scenario, Scenarios};
use crate::statistics::rms;
use crate::util::format::number;

/// An influence is revealed if it is so many times that under the FTC.
const REVEALED: f64 = 5.0;
/// One number is much larger than another if it is so many times that.
const MUCH: f64 = 2.0;

/// The amplitude of a channel's tracking error at a frequency.
fn amplitude(scenarios: &Scenarios, simulated: Scenario, channel: usize, rad_s: f64) -> f64 {
    let errors = scenarios.series(simulated, channel, |shown| shown.e);
    errors.wave(rad_s, SETTLED_S).amplitude
}

fn amplitudes(scenarios: &Scenarios, simulated: Scenario, rad_s: f64) -> Grouped {
    worst_of_groups(scenarios, |channel| {
        amplitude(scenarios, simulated, channel, rad_s)
    })
}

/// The errors at the frequency of the disturbance, without and with the FTC.
pub(super) fn revealed(scenarios: &Scenarios, pid: Scenario) -> Found {
    let rad_s = scenarios.met.force_rad_s;
    let [pid, ftc] = [pid, Scenario::Ftc].map(|simulated| amplitudes(scenarios, simulated, rad_s));
    let factors = quotients(&pid, &ftc);
    Found {
        measured: format!(
            "amplitude of the error at {} rad/s: PID {}, FTC {}, {} times less (must be above {REVEALED})",
            number(rad_s),
            with_units(&pid, own),
            with_units(&ftc, own),
            times(&factors)
        ),
        holds: Some(factors.iter().all(|factor| *factor > REVEALED)),
        read: factors,
    }
}

/// The errors at the frequency of the sensor fault beside those at the frequency of the disturbance.
pub(super) fn insignificant(scenarios: &Scenarios, pid: Scenario) -> Found {
    let (fault_rad_s, force_rad_s) = (scenarios.met.fault_rad_s(), scenarios.met.force_rad_s);
    let of = |rad_s: f64| amplitudes(scenarios, pid, rad_s);
    let (fault, force) = (of(fault_rad_s), of(force_rad_s));
    let shares = quotients(&fault, &force);
    Found {
        measured: format!(
            "amplitude of the error at the sensor fault's {} rad/s {}, at the actuator fault's {} rad/s {} (the first must be below \
             half of the second)",
            number(fault_rad_s),
            with_units(&fault, own),
            number(force_rad_s),
            with_units(&force, own),
        ),
        holds: Some(shares.iter().all(|share| share * MUCH < 1.0)),
        read: shares,
    }
}

/// The sizes of both faults, which have no unit in common.
pub(super) fn smaller(scenarios: &Scenarios) -> Found {
    let largest = |pick: fn(&crate::model::ChannelSample) -> f64| {
        worst_of_groups(scenarios, |channel| {
            let series = scenarios.series(Scenario::Ftc, channel, pick);
            top(series.after(SETTLED_S).map(f64::abs))
        })
    };
    let (f1, f2) = (largest(|shown| shown.f1), largest(|shown| shown.f2));
    Found {
        measured: format!(
            "|f1| up to {}, |f2| up to {}: an acceleration and a rate, so neither is the smaller",
            with_units(&f1, |unit| format!("{unit}/s²")),
            with_units(&f2, rate),
        ),
        holds: None,
        read: Vec::new(),
    }
}

/// The errors of some channels at the frequency of the sensor fault, beside its even harmonics: a symmetric square wave
/// has only odd ones.
pub(super) fn visible(scenarios: &Scenarios, pid: Scenario, channels: &[usize]) -> Found {
    let base_rad_s = scenarios.met.fault_rad_s();
    let of = |harmonic: f64| {
        let own = channels.iter();
        top(own.map(|channel| amplitude(scenarios, pid, *channel, harmonic * base_rad_s)))
    };
    let [first, second, fourth] = [1.0, 2.0, 4.0].map(of);
    let unit = channels
        .first()
        .map_or("", |channel| scenarios.group.unit(*channel));
    Found {
        measured: format!(
            "amplitude of the error at {} rad/s {} {unit}; at {} and {} rad/s, which a symmetric square wave lacks, {} and {} {unit} \
             (must be below half of the first)",
            number(base_rad_s),
            number(first),
            number(2.0 * base_rad_s),
            number(4.0 * base_rad_s),
            number(second),
            number(fourth),
        ),
        holds: Some(first > MUCH * second.max(fourth)),
        read: vec![first, second, fourth],
    }
}

/// Whether the episode under the PID ends within bounds.
pub(super) fn stable(scenarios: &Scenarios, pid: Scenario) -> Found {
    let largest = |from_s: f64, until_s: f64| {
        worst_of_groups(scenarios, |channel| {
            let errors = scenarios.series(pid, channel, |shown| shown.e);
            errors.largest(from_s..until_s)
        })
    };
    if let Some(lost_s) = scenarios.lost_s(pid) {
        return Found {
            measured: format!("{} diverges within {lost_s:.2} s", pid.name()),
            holds: Some(false),
            read: Vec::new(),
        };
    }
    let period_s = scenarios.met.period_s;
    let end_s = scenarios.end_s();
    // The periods before the last one and the last: the jumps of the sensor fault are in both.
    let (before, last) = (
        largest(SETTLED_S, end_s - period_s),
        largest(end_s - period_s, f64::INFINITY),
    );
    let growth = quotients(&last, &before);
    Found {
        measured: format!(
            "|e| up to {} before {} s, up to {} later (must be below {MUCH} times that)",
            with_units(&before, own),
            number(end_s - period_s),
            with_units(&last, own),
        ),
        holds: Some(growth.iter().all(|factor| *factor < MUCH)),
        read: growth,
    }
}

/// The RMS errors of both controllers.
pub(super) fn worse(scenarios: &Scenarios, pid: Scenario) -> Found {
    let of = |simulated: Scenario| {
        grouped(scenarios, |channels| {
            rms(channels.iter().flat_map(|channel| {
                let errors = scenarios.series(simulated, *channel, |shown| shown.e);
                errors.after(SETTLED_S).collect::<Vec<_>>()
            }))
        })
    };
    let (ftc, pid) = (of(Scenario::Ftc), of(pid));
    let factors = quotients(&pid, &ftc);
    Found {
        measured: format!(
            "RMS error from {SETTLED_S} s on: PID {}, FTC {}, factors of {} (must be above {MUCH})",
            with_units(&pid, own),
            with_units(&ftc, own),
            times(&factors)
        ),
        holds: Some(factors.iter().all(|factor| *factor > MUCH)),
        read: factors,
    }
}
