//! Walks along curves.

use super::{g1, margins, quarter_turn, walk};
use crate::common::repository;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use urts_mc::agent::robot::Robot;
use urts_mc::agent::robot::wrench::{PelvisMotion, ankles_m};
use urts_mc::reference::walk::{Foot, Gait, Walk};

/// Where the legs put the ankles at a time, m.
fn ankles(robot: &Robot, walk: &Walk, t_s: f64) -> [nalgebra::Vector3<f64>; 2] {
    let [x, y, yaw] = walk.pelvis.at(t_s);
    let pelvis = PelvisMotion {
        position_m: nalgebra::Vector3::new(x.value, y.value, walk.gait.pelvis_height_m),
        acceleration_m_s2: nalgebra::Vector3::zeros(),
        yaw_rad: yaw.value,
        yaw_rate_rad_s: 0.0,
        yaw_acceleration_rad_s2: 0.0,
    };
    ankles_m(robot, &pelvis, &walk.at(t_s).map(|joint| joint.value))
}

/// Balance, standing feet, ground and joint limits of a walk.
fn is_sound(robot: &Robot, walk: &Walk) {
    let [pendulum, links] = margins(robot, walk);
    // That of all links is the pendulum's model error (paper, section III-B): measured, and bounded where a test says
    // so.
    println!("margins: pendulum {pendulum:.4} m, all links {links:.4} m");
    // The tracker's error is below 2 mm; the reference point of the G1 is 30 mm from the edge of its sole.
    assert!(pendulum > 0.02);

    let footholds = walk.feet.footholds();
    let (mut stood, mut swung) = (0, 0);
    // Off the samples too, where the joint splines stand in for the inverse kinematics.
    let halves = walk
        .times_s()
        .flat_map(|t_s| [t_s, t_s + 0.5 * walk.gait.sampling_s]);
    for t_s in halves.filter(|&t_s| t_s <= walk.duration_s()) {
        let swinging = walk.feet.swing_at(t_s).map(|swing| swing.foot);
        for (foot, ankle) in Foot::BOTH.into_iter().zip(ankles(robot, walk, t_s)) {
            let clearance = ankle.z - walk.gait.ankle_height_m;
            // Errors of cubics over 10 ms at joint accelerations of tens of rad/s^2 whose derivative jumps at lift and
            // touch.
            assert!(clearance > -5e-5, "{foot} foot {clearance} m at {t_s} s");
            if swinging == Some(foot) {
                swung += 1;
                continue;
            }
            stood += 1;
            let mut held = footholds
                .iter()
                .filter(|hold| hold.foot == foot && hold.touch_s <= t_s + 1e-9);
            let [x, y] = held.next_back().unwrap().placement.position_m;
            let slip = (ankle.x - x).hypot(ankle.y - y).max(clearance.abs());
            assert!(slip < 5e-5, "{foot} foot slips {slip} m at {t_s} s");
        }
        for (joint, limits) in walk.at(t_s).iter().zip(robot.joints()) {
            assert!((limits.q_min_rad..=limits.q_max_rad).contains(&joint.value));
            assert!(
                joint.rate.abs() <= limits.rate_max_rad_s,
                "{} at {t_s} s",
                limits.name
            );
        }
    }
    assert!(stood > 1000 && swung > 500);
}

#[test]
fn a_quarter_turn_over_two_metres_keeps_balance_feet_and_joints() {
    let robot = g1();
    for side in [1.0, -1.0] {
        let walk = walk(&quarter_turn(2.0, side, 8));
        is_sound(&robot, &walk);
        // The feet turn with the line.
        let last = walk.feet.footholds().last().unwrap().placement;
        assert!(margins(&robot, &walk)[1] > 0.0);
        // The line ends along its last chord, which spans an eighth of the turn.
        assert!((last.heading_rad - side * FRAC_PI_2 * 15.0 / 16.0).abs() < 0.01);
        let pelvis = walk.pelvis_at(walk.duration_s());
        assert!((pelvis.heading_rad - last.heading_rad).abs() < 1e-12);
    }
}

#[test]
fn a_corner_becomes_a_bend_that_can_be_walked() {
    is_sound(&g1(), &walk(&[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0]]));
}

#[test]
fn a_walk_does_not_depend_on_where_and_in_which_direction_the_line_lies() {
    let line = quarter_turn(2.0, 1.0, 8);
    let reference = walk(&line);
    // Turned by 170 degrees, so that the heading passes 180.
    let (sine, cosine) = (170.0 / 180.0 * PI).sin_cos();
    let moved: Vec<[f64; 2]> = line
        .iter()
        .map(|[x, y]| [5.0 + cosine * x - sine * y, -7.0 + sine * x + cosine * y])
        .collect();
    let other = walk(&moved);
    let headings = other.course.samples().windows(2);
    let turns = headings.map(|pair| (pair[1].heading_rad - pair[0].heading_rad).abs());
    assert!(turns.fold(0.0, f64::max) < 0.02, "the heading jumps");
    assert!(other.course.samples().last().unwrap().heading_rad > PI);
    for t_s in reference.times_s() {
        for (a, b) in reference.at(t_s).iter().zip(other.at(t_s)) {
            // Rounding of coordinates of 7 m, times the leg's 1 rad/m near a bent knee.
            assert!((a.value - b.value).abs() < 1e-10);
        }
    }
}

#[test]
fn a_circle_turns_the_heading_by_a_whole_turn() {
    let radius = 1.5;
    let points: Vec<[f64; 2]> = (0..=24)
        .map(|k| f64::from(k) * TAU / 24.0)
        .map(|angle| [radius * angle.sin(), radius * (1.0 - angle.cos())])
        .collect();
    let walk = walk(&points);
    let [first, .., last] = walk.course.samples() else {
        panic!("no samples")
    };
    // The spline starts and ends along the chords, 7.5 degrees inside the circle's tangent.
    let turn = last.heading_rad - first.heading_rad;
    assert!((turn - TAU).abs() < TAU / 24.0 + 0.01, "{turn}");
    // A spline through points 0.39 m apart is 1e-3 of the radius off at most, its ends along chords a little more.
    assert!((walk.course.length_m() - TAU * radius).abs() < 0.02);
    is_sound(&g1(), &walk);
}

#[test]
fn the_walk_rests_before_its_start_and_after_its_end() {
    let walk = walk(&[[0.0, 0.0], [0.5, 0.0]]);
    let end = walk.duration_s();
    for (t_s, same) in [(-1.0, 0.0), (end + 1.0, end), (1e300, end), (f64::NAN, 0.0)] {
        for (ours, theirs) in walk.at(t_s).iter().zip(walk.at(same)) {
            assert_eq!(ours.value, theirs.value);
            assert_eq!((ours.rate, ours.acceleration), (0.0, 0.0));
        }
    }
}

#[test]
fn a_robot_with_turned_ankle_frames_walks_too() {
    let robot = Robot::load(&repository("campaigns/robots/berkeley_humanoid.toml")).unwrap();
    let gait = Gait {
        step_length_m: 0.08,
        step_height_m: 0.02,
        foot_offset_m: 0.1,
        pelvis_height_m: 0.53,
        ankle_height_m: 0.05,
        zmp_ahead_m: 0.0,
        ..Gait::G1
    };
    let walk = Walk::plan(&robot, &quarter_turn(2.0, 1.0, 8), &gait).unwrap();
    for t_s in walk.times_s() {
        let [x, y, _] = walk.pelvis.at(t_s).map(|point| point.value);
        let near = walk.feet.ankles_at(t_s);
        for (ankle, planned) in ankles(&robot, &walk, t_s).iter().zip(near) {
            let [px, py] = planned.placement.position_m;
            assert!((ankle.x - px).hypot(ankle.y - py) < 1e-10);
            assert!((ankle.z - planned.height_m).abs() < 1e-10);
            assert!((ankle.x - x).hypot(ankle.y - y) < 0.5);
        }
    }
}
