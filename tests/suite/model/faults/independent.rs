//! What the past does within a step: a loop of one axis from plain formulas, in double precision, with the delays,
//! holds and limits of rate spelled out for every stage.

use super::{AMPLITUDE_M, DRAG_N_S_M, FREQUENCY_RAD_S, MASS_KG, STEP_S, X, campaign, trajectory};
use crate::common::gains;
use urts_mc::synthesis::LoopGains;

const ONSET: usize = 150;
const STEPS: usize = 500;

/// What is between the controller and the plant, as its definition says.
#[derive(Clone, Copy, Default)]
struct Between {
    /// Largest change of the command, N/s.
    rate_n_s: Option<f64>,
    /// Up to which size the command gives nothing, N.
    dead_zone_n: Option<f64>,
    /// Steps by which the command is late, and since when.
    command_late: Option<(usize, usize)>,
    /// Steps by which the measurement is late.
    measurement_late: Option<usize>,
    /// Steps for which the measurement is frozen.
    frozen: Option<usize>,
    /// By what share it is too large, and since when.
    scale: Option<(f64, usize)>,
    /// Whether the integral is that of the measurement.
    measured_integral: bool,
    /// Steps for which a sampled controller holds its command.
    hold: Option<usize>,
    /// When the link of the command is blocked, and when the actuator floats: the first step, and the first step after.
    blocked: Option<(usize, usize)>,
    floats: Option<(usize, usize)>,
}

/// What was at the start of each step.
#[derive(Default)]
struct Past {
    sent: Vec<f64>,
    arrived: Vec<f64>,
    command: Vec<f64>,
    told: Vec<f64>,
    measured: Vec<[f64; 2]>,
}

/// A moment of step `step`: 0 at its start, 1 half a step later, 2 at its end.
#[derive(Clone, Copy)]
struct Moment {
    step: usize,
    half: usize,
}

fn reference(t_s: f64) -> [f64; 3] {
    let (w, phase) = (FREQUENCY_RAD_S, FREQUENCY_RAD_S * t_s);
    [
        AMPLITUDE_M * phase.sin(),
        AMPLITUDE_M * w * phase.cos(),
        -AMPLITUDE_M * w * w * phase.sin(),
    ]
}

/// Between two samples, on the line that joins them.
fn on_the_line(from: f64, to: f64, half: usize) -> f64 {
    from + (to - from) * half as f64 / 2.0
}

impl Between {
    /// What the controller sends: a sampled one what it wanted at its last tick.
    fn sent(&self, at: Moment, wanted: f64, past: &Past) -> f64 {
        match self.hold {
            Some(hold) if at.half > 0 || !at.step.is_multiple_of(hold) => {
                past.sent[at.step - at.step % hold]
            }
            _ => wanted,
        }
    }

    /// What the link makes of it: late, and where it is blocked what arrived last.
    fn arrives(&self, at: Moment, sent: f64, past: &Past) -> f64 {
        let Moment { step, half } = at;
        if let Some((from, until)) = self.blocked
            && (from..until).contains(&step)
        {
            return past.arrived[from - 1];
        }
        let Some((late, _)) = self
            .command_late
            .filter(|(_, since)| step >= *since.max(&1))
        else {
            return sent;
        };
        let sample = |step: usize| past.sent[step.saturating_sub(late)];
        if half == 0 || self.hold.is_some() {
            // A staircase that comes late by whole steps has its edges between steps.
            sample(step)
        } else {
            on_the_line(sample(step), sample(step + 1), half)
        }
    }

    /// What the actuator makes of it.
    fn acts(&self, at: Moment, arrives: f64, past: &Past) -> f64 {
        let Moment { step, half } = at;
        let mut u = arrives;
        if let Some((from, until)) = self.floats
            && (from..until).contains(&step)
        {
            u = 0.0;
        }
        if let Some(dead_zone_n) = self.dead_zone_n
            && step >= ONSET
        {
            u = u.signum() * (u.abs() - dead_zone_n).max(0.0);
        }
        if let Some(rate_n_s) = self.rate_n_s
            && step >= ONSET
        {
            // At the start as far from the last step's start as one step allows; then from there.
            let (from, steps) = if half == 0 {
                (past.command[step - 1], 1.0)
            } else {
                (past.command[step], half as f64 / 2.0)
            };
            let reach = rate_n_s * STEP_S * steps;
            u = u.clamp(from - reach, from + reach);
        }
        u
    }

    fn told(&self, at: Moment, feedback: f64, past: &Past) -> f64 {
        match self.hold {
            Some(hold) if at.half > 0 || !at.step.is_multiple_of(hold) => {
                past.told[at.step - at.step % hold]
            }
            _ => feedback,
        }
    }

    fn measured(&self, at: Moment, motion: [f64; 2], past: &Past) -> [f64; 2] {
        let Moment { step, half } = at;
        let mut seen = motion;
        if let Some((scale, since)) = self.scale
            && step >= since
        {
            seen = seen.map(|value| value * (1.0 + scale));
        }
        if let Some(late) = self.measurement_late
            && step >= ONSET
        {
            let [from, to] = [past.measured[step - late], past.measured[step + 1 - late]];
            seen = [0, 1].map(|k| on_the_line(from[k], to[k], half));
        }
        if let Some(frozen) = self.frozen
            && (ONSET..ONSET + frozen).contains(&step)
        {
            seen = past.measured[ONSET - 1];
        }
        seen
    }
}

type State = [f64; 6];

/// int e, e, e' and the estimates of a PID, at every step.
fn simulate(gains: &LoopGains, between: Between) -> Vec<State> {
    let mut past = Past::default();
    let e0 = 0.05;
    let [r, v, _] = reference(0.0);
    let at_start = Moment { step: 0, half: 0 };
    let [seen, seen_rate] = between.measured(at_start, [r + e0, v], &past);
    let mut state = [0.0, e0, 0.0, 0.0, seen - r, seen_rate - v];
    let mut states = vec![state];
    for step in 0..STEPS {
        let mut slopes: Vec<State> = Vec::new();
        for (stage, half) in [0, 1, 1, 2].into_iter().enumerate() {
            let ahead = [0.0, 0.5, 0.5, 1.0][stage] * STEP_S;
            let point: State = std::array::from_fn(|k| match slopes.last() {
                Some(slope) => state[k] + ahead * slope[k],
                None => state[k],
            });
            let at = Moment { step, half };
            let [r, v, a] = reference((step as f64 + half as f64 / 2.0) * STEP_S);
            let [integral, e, rate, integral_hat, e_hat, rate_hat] = point;
            let feedback = gains.k[0] * integral_hat + gains.k[1] * e_hat + gains.k[2] * rate_hat;
            let told = between.told(at, feedback, &past);
            let wanted = MASS_KG * (a + told) + DRAG_N_S_M * v;
            let sent = between.sent(at, wanted, &past);
            let arrives = between.arrives(at, sent, &past);
            let command = between.acts(at, arrives, &past);
            let motion = [r + e, v + rate];
            if stage == 0 {
                let seen = between.measured(at, motion, &past);
                past.sent.push(sent);
                past.arrived.push(arrives);
                past.command.push(command);
                past.told.push(told);
                // What a delay keeps is what goes into it: no test here has two of them.
                past.measured.push(if between.frozen.is_some() {
                    seen
                } else {
                    motion
                });
            }
            let [seen, seen_rate] = between.measured(at, motion, &past);
            let innovation = [
                integral - integral_hat,
                seen - r - e_hat,
                seen_rate - v - rate_hat,
            ];
            let injected = |row: usize, base: f64| {
                base - (0..3).map(|k| gains.l[row][k] * innovation[k]).sum::<f64>()
            };
            slopes.push([
                if between.measured_integral {
                    seen - r
                } else {
                    e
                },
                rate,
                (command - DRAG_N_S_M * motion[1]) / MASS_KG - a,
                injected(0, e_hat),
                injected(1, rate_hat),
                injected(2, told),
            ]);
        }
        for k in 0..6 {
            let [k1, k2, k3, k4] = [0, 1, 2, 3].map(|stage: usize| slopes[stage][k]);
            state[k] += STEP_S / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        states.push(state);
    }
    states
}

/// The largest difference of e between an episode and the formulas, m.
fn difference(more: &str, between: Between) -> f64 {
    let campaign = campaign(more);
    let gains = gains(&campaign).loops()[0][0];
    let states = simulate(&gains, between);
    let simulated = trajectory(&campaign);
    assert_eq!(states.len(), simulated.len());
    let both = simulated.iter().zip(&states);
    both.map(|(agents, state)| (agents[0][X].e - state[1]).abs())
        .fold(0.0, f64::max)
}

fn fault(target: &str, kind: &str, more: &str) -> String {
    format!(
        "[[fault]]\ntarget = \"{target}\"\nkind = \"{kind}\"\nchannels = [1]\nonset_s = 0.3\n{more}\n"
    )
}

/// Holds an episode against the formulas, and against those without what is between: the fault must matter.
#[track_caller]
fn holds(more: &str, between: Between) {
    tells_apart(more, between, &[Between::default()]);
}

/// Holds an episode against the formulas, and against others that are not meant.
#[track_caller]
fn tells_apart(more: &str, between: Between, others: &[Between]) {
    let agrees = difference(more, between);
    // Sums of some hundred newtons over 500 steps of a stable loop, in double precision.
    assert!(agrees < 1e-11, "{agrees:e} m");
    for (k, &other) in others.iter().enumerate() {
        let apart = difference(more, other);
        assert!(
            apart > 1e-6,
            "other formulas {k} differ by {apart:e} m only"
        );
    }
}

#[test]
fn val_a_loop_without_faults_follows_the_formulas() {
    assert!(difference("", Between::default()) < 1e-11);
}

#[test]
fn val_a_limited_rate_holds_within_the_step() {
    holds(
        &fault("actuator", "rate-limit", "rate = 11.0"),
        Between {
            rate_n_s: Some(11.0),
            ..Between::default()
        },
    );
}

#[test]
fn val_a_dead_zone_takes_its_width_from_the_command_ahead_of_the_rate_limit() {
    let zone = fault("actuator", "dead-zone", "magnitude = 2.0");
    let between = Between {
        dead_zone_n: Some(2.0),
        ..Between::default()
    };
    holds(&zone, between);
    // Two in a row take the sum of their widths.
    let wide = Between {
        dead_zone_n: Some(3.5),
        ..between
    };
    let both = fault("actuator", "dead-zone", "magnitude = 1.5") + &zone;
    tells_apart(&both, wide, &[between]);
    let limit = fault("actuator", "rate-limit", "rate = 20.0");
    let limited = Between {
        rate_n_s: Some(20.0),
        ..between
    };
    tells_apart(&(limit + &zone), limited, &[between]);
}

#[test]
fn val_delays_join_their_samples_by_lines() {
    let late = Between {
        command_late: Some((4, ONSET)),
        ..Between::default()
    };
    holds(&fault("actuator", "delay", "delay_s = 0.008"), late);
    // One step later is another loop.
    assert!(difference(&fault("actuator", "delay", "delay_s = 0.010"), late) > 1e-6);
    holds(
        &fault("sensor", "delay", "delay_s = 0.006"),
        Between {
            measurement_late: Some(3),
            ..Between::default()
        },
    );
}

#[test]
fn val_a_frozen_and_a_scaled_sensor_show_position_and_rate() {
    holds(
        &fault("sensor", "freeze", "duration_s = 0.06"),
        Between {
            frozen: Some(30),
            ..Between::default()
        },
    );
    holds(
        &fault("sensor", "scale", "magnitude = 0.03"),
        Between {
            scale: Some((0.03, ONSET)),
            ..Between::default()
        },
    );
}

#[test]
fn val_a_measured_integral_is_that_of_the_sensor() {
    let scaled = fault("sensor", "scale", "magnitude = 0.03").replace("onset_s = 0.3", "");
    let between = Between {
        scale: Some((0.03, 0)),
        ..Between::default()
    };
    holds(&scaled, between);
    let measured = format!("[control]\nintegral = \"sensor\"\n{scaled}");
    holds(
        &measured,
        Between {
            measured_integral: true,
            ..between
        },
    );
    assert!(
        difference(&measured, between) > 1e-6,
        "the option does something"
    );
}

#[test]
fn val_a_control_delay_is_there_from_the_start() {
    holds(
        "[control]\ndelay_s = 0.004\n",
        Between {
            command_late: Some((2, 0)),
            ..Between::default()
        },
    );
}

#[test]
fn val_a_sampled_controller_holds_its_command() {
    let held = Between {
        hold: Some(5),
        ..Between::default()
    };
    holds("[control]\nrate_hz = 100.0\n", held);
    assert!(difference("[control]\nrate_hz = 125.0\n", held) > 1e-6);
}

/// 50 commands a second, each held for ten steps.
const SAMPLED: &str = "[control]\nrate_hz = 50.0\n";
fn held() -> Between {
    Between {
        hold: Some(10),
        ..Between::default()
    }
}

/// A link that is blocked from an onset on for a while, all the time.
fn blocked(onset_s: f64, duration_s: f64) -> String {
    format!(
        "[[fault]]\ntarget = \"network\"\nkind = \"denial-of-service\"\nonset_s = {onset_s}\nduration_s = {duration_s}\nburst_s = 0.002\nshare = 1.0\n"
    )
}

/// An actuator that gives nothing from an onset on for a while.
fn floats(onset_s: &str, duration_s: &str) -> String {
    let float = fault("actuator", "float", &format!("duration_s = {duration_s}"));
    float.replace("onset_s = 0.3", &format!("onset_s = {onset_s}"))
}

#[test]
fn val_a_limited_rate_is_that_of_the_actuator_also_between_the_ticks_of_a_controller() {
    let limited = |rate_n_s: f64| Between {
        rate_n_s: Some(rate_n_s),
        ..held()
    };
    let limit = fault("actuator", "rate-limit", "rate = 20.0");
    // One step's change per tick would be a tenth of it.
    let others = [
        held(),
        limited(2.0),
        Between {
            hold: None,
            ..limited(20.0)
        },
    ];
    tells_apart(&format!("{SAMPLED}{limit}"), limited(20.0), &others);
}

#[test]
fn val_a_float_between_two_ticks_takes_the_held_command_away() {
    // Steps 251 to 258; the ticks are 250 and 260.
    let float = floats("0.502", "0.016");
    let floating = Between {
        floats: Some((251, 259)),
        ..held()
    };
    let later = Between {
        floats: Some((252, 259)),
        ..held()
    };
    tells_apart(&format!("{SAMPLED}{float}"), floating, &[held(), later]);
}

#[test]
fn val_a_float_behind_a_blocked_link_gives_nothing() {
    let blocked_only = Between {
        blocked: Some((ONSET, STEPS)),
        ..Between::default()
    };
    let both = Between {
        floats: Some((300, STEPS)),
        ..blocked_only
    };
    let float_only = Between {
        blocked: None,
        ..both
    };
    let more = format!("{}{}", blocked(0.3, 10.0), floats("0.6", "10.0"));
    tells_apart(&more, both, &[blocked_only, float_only]);
}

#[test]
fn val_a_link_that_opens_between_two_ticks_brings_what_the_controller_holds() {
    // Steps 152 to 172: the ticks 160 and 170 are lost, and what was computed at the second arrives at step 173.
    let until = |step: usize| Between {
        blocked: Some((152, step)),
        ..held()
    };
    let more = format!("{SAMPLED}{}", blocked(0.304, 0.042));
    tells_apart(&more, until(173), &[held(), until(180), until(170)]);
}

#[test]
fn val_a_delay_moves_the_held_command_by_its_own_steps_and_not_by_periods() {
    let late = |steps: usize, since: usize| Between {
        command_late: Some((steps, since)),
        ..held()
    };
    // Seven steps of a period of ten.
    let others = [held(), late(10, 0), late(6, 0)];
    tells_apart(&format!("{SAMPLED}delay_s = 0.014\n"), late(7, 0), &others);
    let delay = fault("actuator", "delay", "delay_s = 0.014");
    let others = [held(), late(10, ONSET), late(7, 0)];
    tells_apart(&format!("{SAMPLED}{delay}"), late(7, ONSET), &others);
}

#[test]
fn val_all_that_is_on_the_way_of_a_command_comes_in_its_order() {
    // Without a controller that is sampled, late commands lie on lines; the block and the float overlap.
    for (control, hold) in [("[control]\n", None), (SAMPLED, Some(10))] {
        let more = format!(
            "{control}delay_s = 0.006\n{}{}{}",
            blocked(0.346, 0.032),
            floats("0.362", "0.028"),
            fault("actuator", "rate-limit", "rate = 60.0")
        );
        let all = Between {
            hold,
            command_late: Some((3, 0)),
            blocked: Some((173, 189)),
            floats: Some((181, 195)),
            rate_n_s: Some(60.0),
            ..Between::default()
        };
        let others = [
            Between {
                blocked: None,
                ..all
            },
            Between {
                floats: None,
                ..all
            },
            Between {
                rate_n_s: None,
                ..all
            },
            Between {
                command_late: None,
                ..all
            },
        ];
        tells_apart(&more, all, &others);
    }
}
