//! Faults on the way of the command: what acts is the definition of what was wanted.

use super::{STEP_S, X, campaign, near, of_x, time_s, trajectory, wanted};

/// The step at which the faults here begin.
const ONSET: usize = 150;

/// A fault of the first channel's command.
fn actuator(kind: &str, more: &str) -> String {
    format!(
        "[[fault]]\ntarget = \"actuator\"\nkind = \"{kind}\"\nchannels = [1]\nonset_s = 0.3\n{more}\n"
    )
}

/// Holds a fault against what it must make of the wanted command at each step; before its onset it makes nothing of it.
#[track_caller]
fn holds(fault: &str, expected: impl Fn(usize, f64) -> f64) {
    let simulated = of_x(fault);
    let mut changed = 0;
    for (step, shown) in simulated.iter().enumerate() {
        let wanted = wanted(shown);
        let expected = if step < ONSET {
            wanted
        } else {
            expected(step, wanted)
        };
        near(shown.u, expected, &format!("u at step {step}"));
        changed += usize::from((shown.u - wanted).abs() > 1e-6);
    }
    assert!(changed > 20, "the fault does something");
}

#[test]
fn val_a_loss_comes_along_its_ramp_and_goes_at_its_end() {
    let fault = actuator(
        "loss-of-effectiveness",
        "magnitude = 0.4\nramp_s = 0.1\nduration_s = 0.3",
    );
    holds(&fault, |step, wanted| {
        let risen = ((step - ONSET + 1) as f64 / 50.0).min(1.0);
        if step < ONSET + 150 {
            (1.0 - 0.4 * risen) * wanted
        } else {
            wanted
        }
    });
}

#[test]
fn val_a_bias_is_added() {
    holds(&actuator("bias", "magnitude = -7.0"), |_, wanted| {
        wanted - 7.0
    });
}

#[test]
fn val_a_drift_grows_by_its_rate() {
    holds(&actuator("drift", "rate = 30.0"), |step, wanted| {
        wanted + 30.0 * STEP_S * (step - ONSET + 1) as f64
    });
}

#[test]
fn val_a_float_gives_nothing() {
    holds(&actuator("float", "duration_s = 0.1"), |step, wanted| {
        if step < ONSET + 50 { 0.0 } else { wanted }
    });
}

#[test]
fn val_a_hard_over_goes_to_its_value() {
    holds(
        &actuator("hard-over", "magnitude = 40.0\nramp_s = 0.02"),
        |step, wanted| {
            let share = ((step - ONSET + 1) as f64 / 10.0).min(1.0);
            (1.0 - share) * wanted + share * 40.0
        },
    );
}

#[test]
fn val_an_oscillation_is_added() {
    let fault = actuator(
        "oscillatory",
        "amplitude = 5.0\nfrequency_rad_s = 40.0\nphase_rad = 0.7",
    );
    holds(&fault, |step, wanted| {
        wanted + 5.0 * (40.0 * time_s(step) + 0.7).sin()
    });
}

#[test]
fn val_a_dead_zone_lets_act_what_goes_beyond_it() {
    let fault = actuator("dead-zone", "magnitude = 6.0");
    holds(&fault, |_, wanted| {
        wanted.signum() * (wanted.abs() - 6.0).max(0.0)
    });
    let simulated = of_x(&fault);
    let nothing = simulated[ONSET..].iter().filter(|shown| shown.u == 0.0);
    let some = simulated[ONSET..].iter().filter(|shown| shown.u != 0.0);
    let (nothing, some) = (nothing.count(), some.count());
    assert!(nothing > 5 && some > 20, "{nothing} {some}");
}

#[test]
fn val_a_stuck_actuator_stays_where_it_was() {
    let simulated = of_x(&actuator("stuck", "duration_s = 0.1"));
    for step in ONSET..ONSET + 50 {
        near(simulated[step].u, simulated[ONSET - 1].u, "u while stuck");
    }
    near(
        simulated[ONSET + 50].u,
        wanted(&simulated[ONSET + 50]),
        "u when it is free again",
    );
    assert!((simulated[ONSET + 20].u - wanted(&simulated[ONSET + 20])).abs() > 1e-3);
}

#[test]
fn val_a_rate_limit_lets_the_command_follow_as_fast_as_it_may() {
    let limit = 11.0 * STEP_S;
    let simulated = of_x(&actuator("rate-limit", "rate = 11.0\nduration_s = 0.4"));
    let mut limited = 0;
    for step in ONSET..simulated.len() {
        let before = simulated[step - 1].u;
        let mut expected = wanted(&simulated[step]);
        if step < ONSET + 200 {
            expected = expected.clamp(before - limit, before + limit);
        }
        near(simulated[step].u, expected, "u within its rate");
        limited += usize::from((expected - wanted(&simulated[step])).abs() > 1e-6);
    }
    assert!(limited > 20, "{limited}");
}

#[test]
fn val_a_delayed_command_is_an_old_one() {
    // 7 ms are three and a half steps: four.
    let fault = actuator("delay", "delay_s = 0.0071");
    let simulated = of_x(&fault);
    for step in 0..simulated.len() {
        let source = if step < ONSET { step } else { step - 4 };
        near(simulated[step].u, wanted(&simulated[source]), "u");
    }
    // At the beginning there is nothing older than the first.
    let simulated = of_x(&fault.replace("onset_s = 0.3", ""));
    for step in 1..30_usize {
        near(
            simulated[step].u,
            wanted(&simulated[step.saturating_sub(4)]),
            "u at the start",
        );
    }
}

#[test]
fn val_an_intermittent_loss_hits_its_share_of_the_slots() {
    let fault = actuator(
        "intermittent",
        "magnitude = 0.5\nburst_s = 0.01\nshare = 0.3",
    )
    .replace("channels = [1]", "channels = [1, 2, 3]");
    let campaign = campaign(&fault);
    let simulated = trajectory(&campaign);
    let (mut hits, mut slots) = (0, 0);
    for agent in [0, 1] {
        // z carries the weight, which the formula of `wanted` takes for a fault: x and y are enough.
        for channel in [0, 1] {
            for slot in 0..(campaign.time.steps as usize - ONSET) / 5 {
                let of_slot = (ONSET + 5 * slot..ONSET + 5 * slot + 5).map(|step| {
                    let shown = &simulated[step][agent][channel];
                    let hit = (shown.u - 0.5 * wanted(shown)).abs() < 1e-9;
                    assert!(hit || (shown.u - wanted(shown)).abs() < 1e-9);
                    hit
                });
                let of_slot: Vec<bool> = of_slot.collect();
                assert!(
                    of_slot.iter().all(|&hit| hit == of_slot[0]),
                    "slots are hit as a whole"
                );
                hits += usize::from(of_slot[0]);
                slots += 1;
            }
        }
    }
    assert_eq!(slots, 280);
    // Five standard deviations of a binomial count of 280 at 0.3: 38.
    assert!(
        (hits as f64 - 0.3 * 280.0).abs() < 38.0,
        "{hits} of {slots}"
    );
}

#[test]
fn val_a_blocked_link_holds_the_last_command_of_all_channels() {
    let fault = "[[fault]]\ntarget = \"network\"\nkind = \"denial-of-service\"\nonset_s = 0.3\nburst_s = 0.01\nshare = 0.5\n";
    let simulated = trajectory(&campaign(fault));
    let mut blocked = [0, 0];
    for step in ONSET..simulated.len() {
        for (agent, blocked) in blocked.iter_mut().enumerate() {
            let of = |channel: usize| {
                let shown = &simulated[step][agent][channel];
                let held = shown.u - simulated[step - 1][agent][channel].u;
                assert!(held.abs() < 1e-9 || (shown.u - wanted(shown)).abs() < 1e-9);
                held.abs() < 1e-12
            };
            assert_eq!(of(0), of(1), "a link fails as a whole");
            *blocked += usize::from(of(0));
        }
    }
    // 70 slots each: five standard deviations are 21 of them, 105 steps.
    assert!(
        blocked.iter().all(|&blocked| (70..281).contains(&blocked)),
        "{blocked:?}"
    );
    assert_ne!(blocked[0], blocked[1], "links fail on their own");
}

#[test]
fn val_a_replay_plays_the_window_before_its_onset_again_and_again() {
    let fault = "[[fault]]\ntarget = \"network\"\nkind = \"replay\"\nchannels = [1]\nonset_s = 0.3\nwindow_s = 0.04\nduration_s = 0.1\n";
    let simulated = of_x(fault);
    for step in ONSET..ONSET + 50 {
        let source = ONSET - 20 + (step - ONSET) % 20;
        near(
            simulated[step].u,
            wanted(&simulated[source]),
            "u while it is replayed",
        );
    }
    near(
        simulated[ONSET + 50].u,
        wanted(&simulated[ONSET + 50]),
        "u afterwards",
    );
}

#[test]
fn val_interference_is_a_share_of_the_others_last_commands() {
    let fault = "[[fault]]\ntarget = \"network\"\nkind = \"interference\"\nonset_s = 0.3\nmagnitude = 0.1\n[[initial.agents]]\nerror = 0.02\n[[initial.agents]]\nerror = -0.04\n";
    let simulated = trajectory(&campaign(fault));
    for step in ONSET..simulated.len() {
        for (own, other) in [(0, 1), (1, 0)] {
            let shown = &simulated[step][own][X];
            let leaked = 0.1 * simulated[step - 1][other][X].u;
            near(shown.u, wanted(shown) + leaked, "u");
        }
    }
}

#[test]
fn val_false_data_is_added_to_the_command() {
    let fault = actuator("false-data", "magnitude = 3.0").replace("actuator", "network");
    holds(&fault, |_, wanted| wanted + 3.0);
}
