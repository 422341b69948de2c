//! Faults on the way of the measurement: f2 is what the measured rate is off by.

use super::{STEP_S, X, campaign, near, of_x, time_s, trajectory, velocity};

const ONSET: usize = 150;

fn sensor(kind: &str, more: &str) -> String {
    format!(
        "[[fault]]\ntarget = \"sensor\"\nkind = \"{kind}\"\nchannels = [1]\nonset_s = 0.3\n{more}\n"
    )
}

/// Holds f2 against its definition at each step, given x' of all steps; before the onset there is none.
#[track_caller]
fn holds(fault: &str, expected: impl Fn(usize, &[f64]) -> f64) {
    let simulated = of_x(fault);
    let rates = simulated.iter().enumerate();
    let rates: Vec<f64> = rates.map(|(step, shown)| velocity(shown, step)).collect();
    let mut there = 0;
    for (step, shown) in simulated.iter().enumerate() {
        let expected = if step < ONSET {
            0.0
        } else {
            expected(step, &rates)
        };
        near(shown.f2, expected, &format!("f2 at step {step}"));
        there += usize::from(expected.abs() > 1e-6);
    }
    assert!(there > 20, "the fault does something");
}

#[test]
fn val_offsets_are_as_large_as_they_say() {
    holds(
        &sensor("bias", "magnitude = 0.1\nramp_s = 0.05"),
        |step, _| 0.1 * ((step - ONSET + 1) as f64 / 25.0).min(1.0),
    );
    holds(&sensor("drift", "rate = -0.2"), |step, _| {
        -0.2 * STEP_S * (step - ONSET + 1) as f64
    });
    let attack = sensor("false-data", "magnitude = 0.05\nduration_s = 0.2")
        .replace("\"sensor\"", "\"network\"\nlink = \"measurement\"");
    holds(
        &attack,
        |step, _| if step < ONSET + 100 { 0.05 } else { 0.0 },
    );
}

#[test]
fn val_waves_are_as_large_as_they_say() {
    let wave = sensor("oscillatory", "amplitude = 0.05\nfrequency_rad_s = 20.0");
    holds(&wave, |step, _| 0.05 * (20.0 * time_s(step)).sin());
    let square = sensor(
        "smoothed-square",
        "amplitude = 0.1\nperiod_s = 0.4\nsmoothing = 0.1",
    );
    holds(&square, |step, _| {
        let turn = std::f64::consts::TAU * time_s(step) / 0.4;
        0.1 * (turn.sin() / 0.1).tanh()
    });
}

#[test]
fn val_a_scale_error_grows_with_the_speed() {
    holds(&sensor("scale", "magnitude = 0.03"), |step, rates| {
        0.03 * rates[step]
    });
}

#[test]
fn val_a_frozen_sensor_shows_the_last_measurement() {
    holds(&sensor("freeze", "duration_s = 0.06"), |step, rates| {
        if step < ONSET + 30 {
            rates[ONSET - 1] - rates[step]
        } else {
            0.0
        }
    });
}

#[test]
fn val_a_delayed_measurement_is_an_old_one() {
    holds(&sensor("delay", "delay_s = 0.006"), |step, rates| {
        rates[step - 3] - rates[step]
    });
}

#[test]
fn val_a_replayed_measurement_is_that_of_the_window() {
    let attack = sensor("replay", "window_s = 0.02\nduration_s = 0.1")
        .replace("\"sensor\"", "\"network\"\nlink = \"measurement\"");
    holds(&attack, |step, rates| {
        if step < ONSET + 50 {
            rates[ONSET - 10 + (step - ONSET) % 10] - rates[step]
        } else {
            0.0
        }
    });
}

#[test]
fn val_a_sensor_that_drops_out_shows_the_last_measurement_in_its_share_of_the_slots() {
    let simulated = of_x(&sensor("dropout", "burst_s = 0.004\nshare = 0.4"));
    let (mut seen, mut dropped) = (velocity(&simulated[ONSET - 1], ONSET - 1), 0);
    for (step, shown) in simulated.iter().enumerate().skip(ONSET) {
        let rate = velocity(shown, step);
        if (shown.f2 - (seen - rate)).abs() < 1e-9 && shown.f2 != 0.0 {
            dropped += 1;
        } else {
            near(shown.f2, 0.0, "f2 while it measures");
            seen = rate;
        }
    }
    // 175 slots of two steps at 0.4: five standard deviations are 32 slots.
    assert!(
        (dropped as f64 - 140.0).abs() < 65.0,
        "{dropped} of 351 steps"
    );
}

#[test]
fn val_outliers_are_as_frequent_as_they_say_and_of_both_signs() {
    let fault = sensor("outlier", "amplitude = 0.1\nshare = 0.2").replace("[1]", "\"all\"");
    let simulated = trajectory(&campaign(&fault));
    let mut count = [0, 0];
    for agents in &simulated[ONSET..] {
        for shown in agents.iter().flatten() {
            match shown.f2 {
                0.1 => count[0] += 1,
                -0.1 => count[1] += 1,
                f2 => assert_eq!(f2, 0.0),
            }
        }
    }
    // 4212 steps, a tenth of each sign: five standard deviations are 97.
    assert!(
        count
            .iter()
            .all(|&count| (count as f64 - 421.2).abs() < 97.0),
        "{count:?}"
    );
}

#[test]
fn val_a_blocked_link_freezes_the_measurements_of_all_channels() {
    let attack = "[[fault]]\ntarget = \"network\"\nlink = \"measurement\"\nkind = \"denial-of-service\"\nonset_s = 0.3\nburst_s = 0.01\nshare = 0.5\n";
    let simulated = trajectory(&campaign(attack));
    let mut blocked = 0;
    for agents in &simulated[ONSET..] {
        for channels in agents {
            assert_eq!(channels[X].f2 == 0.0, channels[1].f2 == 0.0);
            blocked += usize::from(channels[X].f2 != 0.0);
        }
    }
    // 140 slots: five standard deviations are 30 of them, 150 steps.
    assert!((200..501).contains(&blocked), "{blocked} of 702 steps");
}
