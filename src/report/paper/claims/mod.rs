//! The claims of Section V, sentence by sentence, and what the flights say about them.

mod baseline;
mod errors;
mod signals;

use super::flights::{Scenario, Scenarios};
use super::measures::{Series, top};
use crate::util::format::number;
use Scenario::{Ftc, OnCourse, Pid};

/// Where the paper has the errors of its UAV settled, s.
const SETTLED_S: f64 = 2.0;
/// What counts as "at once", s: half of that, for the paper sets the robot apart from the UAV.
const AT_ONCE_S: f64 = 0.5 * SETTLED_S;
/// Joints of the robot in which the paper sees the sensor fault: x5, x6, x11, x12.
const JOINTS: [usize; 4] = [4, 5, 10, 11];
/// The UAV's attitude: x4, x5, x6.
const ATTITUDE: [usize; 3] = [3, 4, 5];

/// A claim of the paper, and what was measured.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Where the paper says so.
    pub place: &'static str,
    /// What it says, in short.
    pub claim: &'static str,
    /// What was measured here.
    pub measured: String,
    /// Whether it holds; none where the flight does not decide.
    pub holds: Option<bool>,
}

/// What was found out about a claim.
struct Found {
    measured: String,
    /// All numbers that the verdict reads.
    read: Vec<f64>,
    /// None where numbers cannot decide.
    holds: Option<bool>,
}

/// All claims that numbers can decide, and those of which it is worth saying that they cannot.
#[must_use]
pub fn claims(uavs: &Scenarios, robots: &Scenarios) -> Vec<Claim> {
    vec![
        decide(
            "Fig. 11",
            "UAV: tracking errors are in the steady state within 2 s",
            uavs,
            &[Ftc, OnCourse],
            |flights| errors::tracking(flights, SETTLED_S),
        ),
        decide(
            "Fig. 11",
            "UAV: estimation errors are in the steady state within 2 s",
            uavs,
            &[Ftc, OnCourse],
            |flights| errors::estimation(flights, SETTLED_S),
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
            |flights| errors::tracking(flights, AT_ONCE_S),
        ),
        decide(
            "Fig. 15",
            "robot: estimation errors are in the steady state at once",
            robots,
            &[Ftc, OnCourse],
            |flights| errors::estimation(flights, AT_ONCE_S),
        ),
        decide(
            "Fig. 15",
            "robot: tracking errors stay in the steady state whatever the faults do",
            robots,
            &[Ftc],
            |flights| errors::kept(flights, |shown| shown.e),
        ),
        decide(
            "Fig. 15",
            "robot: estimation errors stay in the steady state whatever the faults do",
            robots,
            &[Ftc],
            |flights| errors::kept(flights, |shown| shown.e - shown.e_hat),
        ),
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
        decide(
            "Fig. 19",
            "UAV: without the FTC the actuator fault shows in the tracking error",
            uavs,
            &[Ftc, Pid],
            baseline::revealed,
        ),
        decide(
            "Fig. 20",
            "robot: without the FTC the actuator fault shows in the tracking error",
            robots,
            &[Ftc, Pid],
            baseline::revealed,
        ),
        decide(
            "Fig. 19",
            "UAV: under the PID the sensor fault is insignificant beside the actuator fault",
            uavs,
            &[Pid],
            baseline::insignificant,
        ),
        decide(
            "Fig. 20",
            "robot: under the PID the sensor fault is insignificant beside the actuator fault",
            robots,
            &[Pid],
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
        decide(
            "Fig. 19",
            "UAV: under the PID the sensor fault's period shows in the attitude x4, x5, x6",
            uavs,
            &[Pid],
            |flights| baseline::visible(flights, &ATTITUDE),
        ),
        decide(
            "Fig. 20",
            "robot: under the PID the sensor fault's period shows in the joints x5, x6, x11, x12",
            robots,
            &[Pid],
            |flights| baseline::visible(flights, &JOINTS),
        ),
        // Whether a flight ends is what this asks, so one that does not is an answer.
        decide(
            "Fig. 19",
            "UAV: the PID stays stable",
            uavs,
            &[],
            baseline::stable,
        ),
        decide(
            "Fig. 20",
            "robot: the PID stays stable",
            robots,
            &[],
            baseline::stable,
        ),
        decide(
            "Fig. 19",
            "UAV: the PID follows much worse than the FTC",
            uavs,
            &[Ftc, Pid],
            baseline::worse,
        ),
        decide(
            "Fig. 20",
            "robot: the PID follows much worse than the FTC",
            robots,
            &[Ftc, Pid],
            baseline::worse,
        ),
    ]
}

/// Judges a claim by the flights that it reads; nothing is decided by a flight that diverges, or by numbers that are none.
fn decide(
    place: &'static str,
    claim: &'static str,
    flights: &Scenarios,
    reads: &[Scenario],
    judge: impl Fn(&Scenarios) -> Found,
) -> Claim {
    let lost = reads
        .iter()
        .find_map(|flown| Some((flown.name(), flights.lost_s(*flown)?)));
    let (measured, holds) = match lost {
        Some((flight, lost_s)) => {
            let text =
                format!("{flight} diverges within {lost_s:.2} s: there is nothing to measure");
            (text, None)
        }
        None => {
            let found = judge(flights);
            let decided = found.read.iter().all(|value| value.is_finite());
            (found.measured, found.holds.filter(|_| decided))
        }
    };
    Claim {
        place,
        claim,
        measured,
        holds,
    }
}

fn channels(flights: &Scenarios) -> std::ops::Range<usize> {
    0..flights.campaign.channels().len()
}

/// The largest value over channels, of quantities without a unit.
fn worst(flights: &Scenarios, of: impl Fn(usize) -> f64) -> f64 {
    top(channels(flights).map(of))
}

/// A number of each group of channels, and the unit of its errors: metres and radians are never mixed.
type Grouped = Vec<(f64, &'static str)>;

fn grouped(flights: &Scenarios, of: impl Fn(&[usize]) -> f64) -> Grouped {
    let groups = flights.campaign.channel_groups().into_iter();
    groups
        .map(|group| {
            let channels: Vec<usize> = group.channels.collect();
            (of(&channels), group.role.unit())
        })
        .collect()
}

/// The largest value over each group's channels.
fn worst_of_groups(flights: &Scenarios, of: impl Fn(usize) -> f64) -> Grouped {
    grouped(flights, |channels| {
        top(channels.iter().map(|channel| of(*channel)))
    })
}

/// Numbers with their units, of which `unit` makes another quantity's.
fn with_units(values: &Grouped, unit: impl Fn(&str) -> String) -> String {
    let texts: Vec<String> = values
        .iter()
        .map(|(value, own)| format!("{} {}", number(*value), unit(own)))
        .collect();
    texts.join(" and ")
}

/// The unit of errors.
fn own(unit: &str) -> String {
    unit.to_string()
}

/// The unit of rates.
fn rate(unit: &str) -> String {
    format!("{unit}/s")
}

/// The quotients of two numbers of each group.
fn quotients(above: &Grouped, below: &Grouped) -> Vec<f64> {
    let pairs = above.iter().zip(below);
    pairs.map(|((a, _), (b, _))| a / b).collect()
}

/// Factors in a sentence.
fn times(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| number(*value)).collect();
    texts.join(" and ")
}

/// What is read of the time between two jumps of the sensor fault, as shares of it: the peak around the jump, from before it; the
/// calm part, clear of this jump and of the next; what a stretch between jumps is.
const PEAK: [f64; 2] = [-0.1, 0.3];
const CALM: [f64; 2] = [0.6, 0.9];
const STRETCH: [f64; 2] = [0.4, 0.9];
/// An error is back where it stays within so many times its own calm error.
const BACK: f64 = 1.5;

/// A part of the time after a jump, s.
fn part(flights: &Scenarios, jump_s: f64, shares: [f64; 2]) -> std::ops::Range<f64> {
    let [from_s, until_s] = shares.map(|share| jump_s + share * flights.met.half_period_s());
    from_s..until_s
}

/// A curve's calm level: its largest size in the calm parts.
fn calm(flights: &Scenarios, series: &Series) -> f64 {
    let jumps = flights.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| series.largest(part(flights, jump_s, CALM))))
}

/// How soon after the jumps a curve is back at its calm level, s; the longest.
fn back_s(flights: &Scenarios, series: &Series) -> f64 {
    let bound = BACK * calm(flights, series);
    let jumps = flights.jumps_s(SETTLED_S).into_iter();
    top(jumps.map(|jump_s| {
        let until_calm = part(flights, jump_s, [0.0, CALM[0]]);
        series.last_above(bound, until_calm) - jump_s
    }))
}
