//! Legs of UAVs and the polynomials between their knots.

use crate::mission::scenarios::*;
use urts_mc::mission::plane::Point;
use urts_mc::mission::quintic::Quintic;
use urts_mc::mission::uav_leg::{FlightLimits, Knot, UavLeg};
use urts_mc::mission::{EventKind, MissionDraws, Subject, ideal};

const LIMITS: FlightLimits = FlightLimits {
    speed_m_s: 2.0,
    acceleration_m_s2: 1.0,
};

#[test]
fn val_legs_are_those_of_the_golden_file() {
    let legs = GOLDEN["uav_legs"].as_array().unwrap();
    assert_eq!(legs.len(), 5);
    for golden in legs {
        let point = |key: &str| -> Point { numbers(&golden[key]).try_into().unwrap() };
        let number = |key: &str| golden[key].as_f64().unwrap();
        let count = |key: &str| usize::try_from(golden[key].as_u64().unwrap()).unwrap();
        let limits = FlightLimits {
            speed_m_s: number("speed"),
            acceleration_m_s2: number("acceleration"),
        };
        let leg = UavLeg::between(point("start"), point("end"), &limits, number("epoch")).unwrap();
        assert_eq!(
            [leg.ramp, leg.cruise, leg.epochs()],
            ["ramp", "cruise", "epochs"].map(count)
        );
        // The golden numbers have seven digits behind the point.
        assert!((leg.speed_m_s - number("v")).abs() < 1e-6);
        let knots = leg.knots(point("start"));
        for (knot, golden) in knots.iter().zip(golden["knots"].as_array().unwrap()) {
            let ours = [knot.place_m, knot.velocity_m_s, knot.acceleration_m_s2].concat();
            for (ours, golden) in ours.iter().zip(numbers(golden)) {
                assert!((ours - golden).abs() < 1e-6, "{ours} {golden}");
            }
        }
    }
}

#[test]
fn val_the_quintic_is_that_of_the_golden_file() {
    let golden = &GOLDEN["quintic"];
    let case = numbers(&golden["case"]);
    let duration_s = golden["T"].as_f64().unwrap();
    let quintic = Quintic::between(
        [case[0], case[1], case[2]],
        [case[3], case[4], case[5]],
        duration_s,
    );
    for (ours, golden) in quintic
        .coefficients
        .iter()
        .zip(numbers(&golden["coefficients"]))
    {
        // A dozen roundings of numbers below 20.
        assert!((ours - golden).abs() < 1e-12);
    }
}

#[test]
fn a_leg_begins_and_ends_at_rest_and_keeps_its_limits() {
    for k in 1..60 {
        let goal = [0.37 * f64::from(k), -0.21 * f64::from(k)];
        for epoch_s in [0.5, 1.0, 2.0] {
            let leg = UavLeg::between([1.0, 2.0], goal, &LIMITS, epoch_s).unwrap();
            let knots = leg.knots([1.0, 2.0]);
            let end = knots.last().unwrap();
            // Sums of up to 60 steps of some metres.
            assert!((0..2).all(|i| (end.place_m[i] - goal[i]).abs() < 1e-12));
            assert!((0..2).all(|i| end.velocity_m_s[i].abs() < 1e-15));
            let mut from = Knot::at_rest([1.0, 2.0]);
            for to in knots {
                let axes = from.quintics_to(&to, epoch_s);
                for tenth in 0..=10 {
                    let at = axes.map(|axis| axis.at(epoch_s * f64::from(tenth) / 10.0));
                    assert!(at[0][1].hypot(at[1][1]) < LIMITS.speed_m_s * (1.0 + 1e-12));
                    assert!(at[0][2].hypot(at[1][2]) < LIMITS.acceleration_m_s2 * (1.0 + 1e-12));
                }
                from = to;
            }
        }
    }
}

#[test]
fn the_quintic_through_the_knots_is_the_law_of_the_leg() {
    let leg = UavLeg::between([0.0; 2], [35.0, 0.0], &LIMITS, 1.0).unwrap();
    let knots = leg.knots([0.0; 2]);
    let ramp_s = leg.ramp as f64;
    let mut from = Knot::at_rest([0.0; 2]);
    for (epoch, to) in knots.iter().take(leg.ramp).enumerate() {
        let [x, _] = from.quintics_to(to, 1.0);
        for tenth in 0..=10 {
            let t = f64::from(tenth) / 10.0;
            let phase = (epoch as f64 + t) / ramp_s;
            let law = leg.speed_m_s * ramp_s * (phase.powi(3) - phase.powi(4) / 2.0);
            // A quartic is among the quintics: only rounding of metres remains.
            assert!((x.at(t)[0] - law).abs() < 1e-13);
        }
        from = *to;
    }
}

#[test]
fn there_is_no_leg_to_the_place_where_it_begins() {
    assert!(UavLeg::between([3.0, 4.0], [3.0, 4.0], &LIMITS, 1.0).is_none());
    assert!(UavLeg::between([3.0, 4.0], [3.0, 4.0 + 1e-8], &LIMITS, 1.0).is_some());
}

#[test]
fn the_first_sweep_takes_as_long_as_a_mission_shows() {
    let draws = MissionDraws::of_episode(&PAPER, SEED, 0).unwrap();
    let outcome = ideal(&PAPER, &draws, &[]);
    for uav in [0, 5, 10] {
        let done = outcome
            .events_of(EventKind::TaskDone, Some(Subject::Search(uav)))
            .next();
        let done_s = done.map(|event| event.time_s);
        // Epoch 0 is spent at the start.
        assert_eq!(
            PAPER.first_sweep_s(uav).map(|sweep_s| sweep_s + 1.0),
            done_s
        );
        assert_eq!(done_s, Some(223.0));
    }
    assert_eq!(PAPER.first_sweep_s(1), None);
}
