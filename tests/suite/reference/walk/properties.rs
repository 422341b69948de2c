//! Properties for any input.

use super::g1;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::cell::Cell;
use urts_mc::reference::walk::{Foot, Gait, Spline, Walk, com, ground_reaction, zmp};

/// Numbers that programs stumble over, among ordinary ones.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..3.0_f64,
        1 => prop::sample::select(vec![
            0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 1e-300, 1e300,
        ]),
    ]
}

/// Gaits whose numbers come from `near`, given those of the G1.
fn gaits<S: Strategy<Value = f64>>(near: impl Fn(f64) -> S) -> impl Strategy<Value = Gait> {
    let g1 = Gait::G1;
    let steps = (
        // Not finer than 10 ms, for the time that it takes.
        0.01..0.03_f64,
        near(g1.step_length_m),
        near(g1.step_height_m),
        near(g1.step_period_s),
        near(g1.double_support_s),
        near(g1.foot_offset_m),
    );
    let stance = (
        0.65..0.76_f64,
        near(g1.ankle_height_m),
        near(g1.zmp_ahead_m),
        near(g1.standing_before_s),
        near(g1.standing_after_s),
        near(g1.smoothing_step_m),
        any::<bool>(),
    );
    (steps, stance).prop_map(|(steps, stance)| Gait {
        sampling_s: steps.0,
        step_length_m: steps.1,
        step_height_m: steps.2,
        step_period_s: steps.3,
        double_support_s: steps.4,
        foot_offset_m: steps.5,
        pelvis_height_m: stance.0,
        ankle_height_m: stance.1,
        zmp_ahead_m: stance.2,
        standing_before_s: stance.3,
        standing_after_s: stance.4,
        smoothing_step_m: stance.5,
        first_foot: if stance.6 { Foot::Left } else { Foot::Right },
    })
}

/// From useless to absurd.
fn any_gait() -> impl Strategy<Value = Gait> {
    gaits(|usual| prop_oneof![12 => (0.5 * usual)..(1.7 * usual), 1 => any_number()])
}

fn knots() -> impl Strategy<Value = Vec<(f64, [f64; 2])>> {
    let point = (0.01..2.0_f64, [-5.0..5.0_f64, -5.0..5.0_f64]);
    prop::collection::vec(point, 2..12).prop_map(|points| {
        let mut at = -1.0;
        let increasing = points.into_iter().map(|(step, value)| {
            at += step;
            (at, value)
        });
        increasing.collect()
    })
}

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(20_240_607),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn planning_never_panics(
        waypoints in prop::collection::vec([any_number(), any_number()], 0..5),
        gait in any_gait(),
        t_s in any_number(),
    ) {
        if let Ok(walk) = Walk::plan(&g1(), &waypoints, &gait) {
            prop_assert!(walk.at(t_s).iter().all(|joint| joint.value.is_finite()));
            prop_assert!(walk.duration_s().is_finite());
            let reaction = ground_reaction(&walk, &g1(), t_s);
            prop_assert!((0.0..=1.0).contains(&reaction.left_share));
        }
    }

    #[test]
    fn splines_pass_their_points_with_the_given_ends_and_without_breaks(
        points in knots(),
        slopes in [[-3.0..3.0_f64, -3.0..3.0_f64], [-3.0..3.0_f64, -3.0..3.0_f64]],
    ) {
        let spline = Spline::clamped(points.clone(), slopes);
        let [from, to] = spline.range();
        // Values of 5 over steps of 0.01 give second derivatives of 3e5, which rounding spoils by 1e-10 of that.
        let scale = points.windows(2).map(|pair| 30.0 / (pair[1].0 - pair[0].0).powi(2)).fold(1.0, f64::max);
        for (at, value) in &points {
            let before = spline.at((at - 1e-9).max(from));
            let after = spline.at((at + 1e-9).min(to));
            for i in 0..2 {
                prop_assert!((spline.at(*at)[i].value - value[i]).abs() < 1e-9);
                // Over 2e-9 a third derivative of 1e3 times the second moves the latter by 2e-6 of itself.
                prop_assert!((before[i].rate - after[i].rate).abs() < 1e-6 * scale);
                prop_assert!((before[i].acceleration - after[i].acceleration).abs() < 1e-4 * scale);
            }
        }
        for (end, slope) in [from, to].into_iter().zip(slopes) {
            for (point, slope) in spline.at(end).iter().zip(slope) {
                prop_assert!((point.rate - slope).abs() < 1e-9 * scale);
            }
        }
    }

    #[test]
    fn splines_have_exact_derivatives(points in knots(), piece in 0.0..1.0_f64, place in 0.1..0.9_f64) {
        let spline = Spline::at_rest(points.clone());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small index")]
        let piece = (piece * (points.len() - 1) as f64) as usize;
        let (from, to) = (points[piece].0, points[piece + 1].0);
        let length = to - from;
        // Inside a piece, central differences are exact for the second derivative, which is linear, and off by a sixth
        // of the third times h^2 for the first; h is chosen against rounding.
        let (x, h) = (from + place * length, 1e-3 * length);
        let [a, at, b] = [x - h, x, x + h].map(|x| spline.at(x)[0]);
        let third = (b.acceleration - a.acceleration) / (2.0 * h);
        let size = [a.value, a.rate * length, third * length.powi(3)].iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        let rate = (b.value - a.value) / (2.0 * h) - third * h * h / 6.0;
        prop_assert!((rate - at.rate).abs() * length < 1e-10 * size);
        let acceleration = (b.rate - a.rate) / (2.0 * h);
        prop_assert!((acceleration - at.acceleration).abs() * length * length < 1e-10 * size);
    }

    #[test]
    fn the_tracker_reaches_a_point_that_does_not_move(x in -5.0..5.0_f64, y in -5.0..5.0_f64, height_m in 0.2..1.5_f64) {
        let walk = com::track(&vec![[x, y]; 200], height_m, 0.01);
        for (state, zmp) in walk.states.iter().zip(&walk.zmp_m) {
            // It starts there, at rest; gains of 1400 act on rounding.
            prop_assert!((zmp[0] - x).abs() + (zmp[1] - y).abs() < 1e-9);
            prop_assert!((state[0][0] - x).abs() < 1e-9 && state[1][1].abs() < 1e-9);
        }
    }
}

#[test]
fn walks_that_are_planned_stay_in_balance_in_range_and_above_ground() {
    let robot = g1();
    let soles = zmp::soles(&robot);
    let planned = Cell::new(0);
    let cases = (
        0.3..1.5_f64,
        -1.0..1.0_f64,
        gaits(|usual| (0.8 * usual)..(1.2 * usual)),
    );
    let outcome = TestRunner::new(config()).run(&cases, |(length_m, bend, gait)| {
        let middle = [0.5 * length_m, 0.1 * bend * length_m];
        let Ok(walk) = Walk::plan(&robot, &[[0.0, 0.0], middle, [length_m, 0.0]], &gait) else {
            return Ok(());
        };
        planned.set(planned.get() + 1);
        for (t_s, &point) in walk.times_s().zip(&walk.com.zmp_m) {
            let polygon = zmp::support_polygon(&walk.feet, &soles, t_s);
            prop_assert!(zmp::margin(&polygon, point) >= 0.0);
            for (joint, limits) in walk.at(t_s).iter().zip(robot.joints()) {
                prop_assert!((limits.q_min_rad..=limits.q_max_rad).contains(&joint.value));
            }
            let ankles = walk.feet.ankles_at(t_s);
            // Rounding of heights of some centimetres.
            prop_assert!(
                ankles
                    .iter()
                    .all(|ankle| ankle.height_m >= gait.ankle_height_m - 1e-12)
            );
        }
        Ok(())
    });
    outcome.unwrap();
    println!("{} of 200 planned", planned.get());
    assert!(planned.get() > 50);
}

#[test]
fn a_swing_is_at_rest_at_lift_and_touch_and_highest_halfway() {
    let spline = Spline::at_rest([(0.0, [0.0, 0.0]), (0.5, [0.1, 0.05]), (1.0, [0.2, 0.0])]);
    // By symmetry: halfway the vertical speed is zero, the horizontal one 3/2 of the mean.
    let middle = spline.at(0.5);
    assert!((middle[0].rate - 0.3).abs() < 1e-12 && middle[1].rate.abs() < 1e-12);
    for end in [0.0, 1.0] {
        assert!(spline.at(end).iter().all(|point| point.rate.abs() < 1e-12));
    }
}

#[test]
fn splines_without_knots_or_with_knots_out_of_order_give_numbers() {
    let empty = Spline::<1>::at_rest([]);
    assert_eq!(empty.value(0.3), [0.0]);
    let one = Spline::at_rest([(1.0, [4.0])]);
    assert_eq!(one.value(0.3), [4.0]);
    let back = Spline::at_rest([(0.0, [0.0]), (-1.0, [9.0]), (f64::NAN, [9.0]), (1.0, [1.0])]);
    assert_eq!(back.range(), [0.0, 1.0]);
    assert_eq!(back.value(2.0), [1.0]);
}
