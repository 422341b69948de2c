//! The claims of Section V, sentence by sentence, each with what the episodes say about it.

use super::found::{Claim, SETTLED_S, decide, decide_of_pid};
use super::{baseline, errors, signals};
use crate::report::paper::scenarios::Scenario::{Ftc, OnCourse};
use crate::report::paper::scenarios::Scenarios;

/// What counts as "at once", s: half of that, for the paper sets the robot apart from the UAV.
const AT_ONCE_S: f64 = 0.5 * SETTLED_S;
/// Joints of the robot in which the paper sees the sensor fault: x5, x6, x11, x12.
const JOINTS: [usize; 4] = [4, 5, 10, 11];
/// The UAV's attitude: x4, x5, x6.
const ATTITUDE: [usize; 3] = [3, 4, 5];

/// All claims that numbers can decide, and those of which it is worth saying that they cannot.
#[must_use]
pub fn claims(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    let by_figure = [
        about_errors,
        about_signals,
        about_faults_shown,
        about_the_pid,
    ];
    let claims = by_figure.into_iter().flat_map(|about| about(uavs, robots));
    claims.collect()
}

/// Figures 11 and 15.
fn about_errors(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    vec![
        decide(
            "Fig. 11",
            "UAV: tracking errors are in the steady state within 2 s",
            uavs,
            &[Ftc, OnCourse],
            |scenarios| errors::tracking(scenarios, SETTLED_S),
        ),
        decide(
            "Fig. 11",
            "UAV: estimation errors are in the steady state within 2 s",
            uavs,
            &[Ftc, OnCourse],
            |scenarios| errors::estimation(scenarios, SETTLED_S),
        ),
        decide(
            "Fig. 11",
            "UAV: a brief jitter where the sensor fault changes fast, and a quick return",
            uavs,
            &[Ftc],
            errors::jitter,
        ),
        decide(
            "Fig. 15",
            "robot: tracking errors are in the steady state at once",
            robots,
            &[Ftc, OnCourse],
            |scenarios| errors::tracking(scenarios, AT_ONCE_S),
        ),
        decide(
            "Fig. 15",
            "robot: estimation errors are in the steady state at once",
            robots,
            &[Ftc, OnCourse],
            |scenarios| errors::estimation(scenarios, AT_ONCE_S),
        ),
        decide(
            "Fig. 15",
            "robot: tracking errors stay in the steady state whatever the faults do",
            robots,
            &[Ftc],
            |scenarios| errors::kept(scenarios, |shown| shown.e),
        ),
        decide(
            "Fig. 15",
            "robot: estimation errors stay in the steady state whatever the faults do",
            robots,
            &[Ftc],
            |scenarios| errors::kept(scenarios, |shown| shown.e - shown.e_hat),
        ),
    ]
}

/// Figures 12 to 14 and 16 to 18.
fn about_signals(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    vec![
        decide(
            "Fig. 12",
            "UAV: the actuator fault f1 is estimated",
            uavs,
            &[Ftc],
            signals::estimated,
        ),
        decide(
            "Fig. 16",
            "robot: the actuator fault f1 is estimated",
            robots,
            &[Ftc],
            signals::estimated,
        ),
        decide(
            "Fig. 13",
            "UAV: the estimate of the sensor fault f2 overshoots its jumps and is steady again after about 2 s",
            uavs,
            &[Ftc],
            signals::overshoot,
        ),
        decide(
            "Fig. 17",
            "robot: the estimate of the sensor fault f2 overshoots its jumps and is steady again after about 2 s",
            robots,
            &[Ftc],
            signals::overshoot,
        ),
        decide(
            "Fig. 14",
            "UAV: the control starts with a high frequency and a high amplitude",
            uavs,
            &[Ftc],
            signals::start,
        ),
        decide(
            "Fig. 18",
            "robot: the control starts with a high frequency and a high amplitude",
            robots,
            &[Ftc],
            signals::start,
        ),
        decide(
            "Fig. 14",
            "UAV: then the control keeps the shape of a sine that cancels the actuator fault",
            uavs,
            &[Ftc],
            signals::sine,
        ),
        decide(
            "Fig. 18",
            "robot: then the control keeps the shape of a sine that cancels the actuator fault",
            robots,
            &[Ftc],
            signals::sine,
        ),
        decide(
            "Fig. 14",
            "UAV: the total force F stays constant against gravity",
            uavs,
            &[Ftc],
            signals::thrust,
        ),
    ]
}

/// Figures 19 and 20: which faults show under the PID.
fn about_faults_shown(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    vec![
        decide_of_pid(
            "Fig. 19",
            "UAV: without the FTC the actuator fault shows in the tracking error",
            uavs,
            (&[Ftc], false),
            baseline::revealed,
        ),
        decide_of_pid(
            "Fig. 20",
            "robot: without the FTC the actuator fault shows in the tracking error",
            robots,
            (&[Ftc], false),
            baseline::revealed,
        ),
        decide_of_pid(
            "Fig. 19",
            "UAV: under the PID the sensor fault is insignificant beside the actuator fault",
            uavs,
            (&[], false),
            baseline::insignificant,
        ),
        decide_of_pid(
            "Fig. 20",
            "robot: under the PID the sensor fault is insignificant beside the actuator fault",
            robots,
            (&[], false),
            baseline::insignificant,
        ),
        decide(
            "Fig. 19",
            "UAV: the sensor fault is much smaller than the actuator fault",
            uavs,
            &[Ftc],
            baseline::smaller,
        ),
        decide(
            "Fig. 20",
            "robot: the sensor fault is much smaller than the actuator fault",
            robots,
            &[Ftc],
            baseline::smaller,
        ),
        decide_of_pid(
            "Fig. 19",
            "UAV: under the PID the sensor fault's period shows in the attitude x4, x5, x6",
            uavs,
            (&[], false),
            |scenarios, pid| baseline::visible(scenarios, pid, &ATTITUDE),
        ),
        decide_of_pid(
            "Fig. 20",
            "robot: under the PID the sensor fault's period shows in the joints x5, x6, x11, x12",
            robots,
            (&[], false),
            |scenarios, pid| baseline::visible(scenarios, pid, &JOINTS),
        ),
    ]
}

/// Figures 19 and 20: how the PID fares beside the FTC.
fn about_the_pid(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    vec![
        // Whether an episode ends is what this asks, so one that does not is an answer.
        decide_of_pid(
            "Fig. 19",
            "UAV: the PID stays stable",
            uavs,
            (&[], true),
            baseline::stable,
        ),
        decide_of_pid(
            "Fig. 20",
            "robot: the PID stays stable",
            robots,
            (&[], true),
            baseline::stable,
        ),
        decide_of_pid(
            "Fig. 19",
            "UAV: the PID follows much worse than the FTC",
            uavs,
            (&[Ftc], false),
            baseline::worse,
        ),
        decide_of_pid(
            "Fig. 20",
            "robot: the PID follows much worse than the FTC",
            robots,
            (&[Ftc], false),
            baseline::worse,
        ),
    ]
}
