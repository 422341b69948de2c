//! What is refused, and in which words.

use super::{g1, quarter_turn};
use urts_mc::reference::walk::{Gait, Walk};

const LINE: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 0.0]];

/// The words of a refusal must contain `expected`, all of them.
fn refuses(waypoints: &[[f64; 2]], gait: &Gait, expected: &[&str]) {
    let words = Walk::plan(&g1(), waypoints, gait).unwrap_err().to_string();
    println!("{words}");
    for part in expected {
        assert!(words.contains(part), "{words:?} lacks {part:?}");
    }
}

#[test]
fn waypoints_that_make_no_line() {
    let gait = Gait::G1;
    refuses(&[], &gait, &["0 waypoint(s)", "at least 2", "add"]);
    refuses(&LINE[..1], &gait, &["1 waypoint(s)", "at least 2"]);
    let twice = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]];
    refuses(&twice, &gait, &["waypoint 2 coincides", "remove one"]);
    let back = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.01]];
    refuses(
        &back,
        &gait,
        &["waypoint 1", "179 degrees", "150", "spread the turn"],
    );
    for bad in [f64::NAN, f64::INFINITY, 1e5] {
        refuses(
            &[[0.0, 0.0], [bad, 0.0]],
            &gait,
            &["waypoint 1 is", "at most 1e4 m"],
        );
    }
}

#[test]
fn a_line_shorter_than_a_step() {
    let short = [[0.0, 0.0], [0.15, 0.0]];
    refuses(
        &short,
        &Gait::G1,
        &["0.15 m long", "0.2 m", "shorten the step"],
    );
}

#[test]
fn a_line_too_long_to_hold() {
    let long = [[0.0, 0.0], [900.0, 0.0]];
    refuses(&long, &Gait::G1, &["samples", "200000", "divide the line"]);
    let longer = [[0.0, 0.0], [9000.0, 0.0]];
    refuses(
        &longer,
        &Gait::G1,
        &["samples", "200000", "divide the line"],
    );
}

#[test]
fn a_bend_that_brings_the_feet_together() {
    let gait = Gait {
        smoothing_step_m: 0.2,
        ..Gait::G1
    };
    let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    refuses(
        &corner,
        &gait,
        &["foot comes down", "0.118 m", " s the ", "widen the bend"],
    );
}

#[test]
fn a_step_too_long_for_the_leg() {
    let gait = Gait {
        step_length_m: 0.7,
        ..Gait::G1
    };
    let long = [[0.0, 0.0], [2.8, 0.0]];
    refuses(
        &long,
        &gait,
        &[
            "no joint angles were found",
            "0.664 m from the hip",
            "up to 0.65",
            "shorten the step",
        ],
    );
}

#[test]
fn a_pelvis_too_high_to_stand() {
    let gait = Gait {
        pelvis_height_m: 0.85,
        ..Gait::G1
    };
    refuses(
        &LINE,
        &gait,
        &["at 0.00 s", "does not reach", "lower the pelvis"],
    );
}

#[test]
fn a_straight_knee() {
    let gait = Gait {
        pelvis_height_m: 0.79,
        step_length_m: 0.05,
        ..Gait::G1
    };
    refuses(&LINE, &gait, &["knee", "needs 0.1 rad", "lower the pelvis"]);
}

#[test]
fn a_joint_beyond_its_range() {
    let gait = Gait {
        pelvis_height_m: 0.4,
        ..Gait::G1
    };
    refuses(
        &LINE,
        &gait,
        &[
            "joint l_ankle_pitch is at",
            "its range is -0.87267 to 0.5236 rad",
        ],
    );
}

#[test]
fn a_gait_that_falls() {
    // The centre of mass would have to jump: no time to prepare, and a shift within one sample.
    let gait = Gait {
        double_support_s: 0.01,
        standing_before_s: 0.05,
        ..Gait::G1
    };
    refuses(
        &LINE,
        &gait,
        &[
            "the robot falls",
            "outside the supporting feet",
            "stand longer",
        ],
    );
}

#[test]
fn gait_numbers_out_of_range_or_in_contradiction() {
    let g1 = Gait::G1;
    for bad in [f64::NAN, 0.0, -0.2, f64::INFINITY] {
        let gait = Gait {
            step_length_m: bad,
            ..g1
        };
        refuses(
            &LINE,
            &gait,
            &["step_length_m = ", "must lie between 0.001 and 10"],
        );
    }
    let swing = Gait {
        double_support_s: 0.9,
        ..g1
    };
    refuses(
        &LINE,
        &swing,
        &[
            "step_period_s = 0.9",
            "double_support_s",
            "lengthen the period",
        ],
    );
    let shift = Gait {
        double_support_s: 0.005,
        ..g1
    };
    refuses(
        &LINE,
        &shift,
        &[
            "double_support_s = 0.005",
            "at least 0.01",
            "sample more often",
        ],
    );
    let stand = Gait {
        standing_after_s: 0.1,
        ..g1
    };
    refuses(
        &LINE,
        &stand,
        &["standing_after_s = 0.1", "at least 0.15", "stand longer"],
    );
    let low = Gait {
        pelvis_height_m: 0.05,
        ..g1
    };
    refuses(
        &LINE,
        &low,
        &["pelvis_height_m = 0.05", "ankle_height_m + step_height_m"],
    );
}

#[test]
fn a_center_of_mass_under_the_ground() {
    let plan = |offset| Walk::plan_with_com_offset(&super::g1(), &LINE, &Gait::G1, offset);
    for offset in [[0.0, 0.0, -0.74], [f64::NAN, 0.0, 0.0]] {
        let words = plan(offset).unwrap_err().to_string();
        assert!(words.contains("com_offset_m = "), "{words}");
    }
}

#[test]
fn every_gait_of_the_tests_of_curves_is_accepted() {
    // The refusals above change one number each of what works.
    assert!(Walk::plan(&g1(), &LINE, &Gait::G1).is_ok());
    assert!(Walk::plan(&g1(), &quarter_turn(2.0, 1.0, 8), &Gait::G1).is_ok());
}
