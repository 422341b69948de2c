//! What the frequency curves of a report say, against flights under sines of that frequency.

use crate::common::altered;
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::controllers::GainSet;
use urts_mc::model::ChannelSample;
use urts_mc::synthesis::{placed_gains, responses, settling_s};

/// Steps of a period of 2 s, and periods that are looked at after the transients.
const PERIOD: usize = 1000;
const PERIODS: usize = 8;

/// The size of the component of a signal with a period of 2 s, over its last periods.
fn component(signal: &[f64]) -> f64 {
    let last = &signal[signal.len() - PERIOD * PERIODS..];
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / PERIOD as f64;
    let sum = |wave: fn(f64) -> f64| -> f64 {
        let all = last.iter().enumerate();
        all.map(|(k, value)| value * wave(angle(k))).sum()
    };
    sum(f64::cos).hypot(sum(f64::sin))
}

/// The error of x over a signal of a flight, both at pi rad/s, under "pid-placed" and "ftc-tuned", and what
/// [`responses`] says of it.
fn measured_and_said(
    changes: &[&str],
    signal: fn(&ChannelSample) -> f64,
    said: fn(&urts_mc::synthesis::Response) -> f64,
) -> [[f64; 2]; 2] {
    let quiet = [
        "controllers=[\"pid-placed\", \"ftc-tuned\"]",
        "synthesis.pid-placed={ poles_rad_s = 20.0 }",
        "agent.team=1",
        "agent.mass_scale=1.0",
        "agent.inertia_scale=1.0",
        "reference.agents.2=",
        "reference.agents.1=",
        "initial.error=0.0",
        "initial.error_rate=0.0",
        "coupling=",
        "time.duration_s=40.0",
        "verdict.max_error=100.0",
        "verdict.max_rmse=100.0",
    ];
    let campaign = altered("smoke", &[&quiet[..], changes].concat());
    let gains = GainSet::of_groups(&campaign).unwrap();
    let loops = GainSet::loops_of(&gains);
    let cpu = Cpu::new(campaign.first_group(), &loops[0], Precision::F64, None);
    [0, 1].map(|controller| {
        let (_, snapshots) = cpu.trace(0, controller, 1);
        let of = |pick: fn(&ChannelSample) -> f64| -> Vec<f64> {
            let shown = snapshots.iter();
            shown.map(|snapshot| pick(&snapshot.agents[0][0])).collect()
        };
        let own = &gains[0].controllers[controller].groups[0];
        let answers = responses(&own.design, &own.gains, &[std::f64::consts::PI]).unwrap();
        let ratio = component(&of(|shown| shown.e)) / component(&of(signal));
        [ratio, said(&answers[0])]
    })
}

#[test]
fn val_the_answers_of_a_loop_are_those_of_a_flight_under_sines() {
    let disturbed = [
        "fault.1=",
        "fault.0=",
        "disturbance.0.amplitude=[50.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
        "disturbance.0.frequency_rad_s=3.141592653589793",
    ];
    let found = measured_and_said(&disturbed, |own| own.f1, |own| own.from_actuator_fault);
    println!("actuator: {found:?}");
    for [measured, said] in found {
        // The loop is linear, and the step as good as continuous; what is left of the transients is less than that.
        assert!((measured / said - 1.0).abs() < 0.01, "{measured} {said}");
    }
    let faulty = [
        "disturbance.0=",
        "fault.0=",
        "fault.0.probability=1.0",
        "fault.0.channels=[1]",
        "fault.0.amplitude=0.5",
        "fault.0.period_s=2.0",
        "fault.0.phase_rad=0.0",
    ];
    let found = measured_and_said(&faulty, |own| own.f2, |own| own.from_sensor_fault);
    println!("sensor: {found:?}");
    for [measured, said] in found {
        assert!((measured / said - 1.0).abs() < 0.01, "{measured} {said}");
    }
    // Another frequency would be noticed.
    assert!((found[0][1] / found[1][1] - 1.0).abs() > 0.05);
}

#[test]
fn a_nominal_loop_settles_as_its_poles_say() {
    // What a triple pole at -p makes of e(0) = 1 is a function of p t: ten times the pole settles ten times as fast.
    let [slow, fast] = [2.0, 20.0].map(|rad_s| {
        let gains = placed_gains(rad_s, 800.0);
        settling_s(&gains).unwrap()
    });
    assert!((slow / fast - 10.0).abs() < 0.05, "{slow} {fast}");
    // s^3 = K (0, 1, 0) leads to e'' + 3 p e' + 3 p^2 e + p^3 int e = 0 with e(0) = 1, e'(0) = 0: its solution
    // (1 + p t - p^2 t^2) exp(-p t) has 5 % left for good from p t = 6.57 on.
    assert!((20.0 * fast - 6.566).abs() < 0.03, "{}", 20.0 * fast);
}
