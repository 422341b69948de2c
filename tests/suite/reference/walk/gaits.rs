//! Gaits of robots of other sizes, and the nearest gait that can be walked.

use super::g1;
use urts_mc::agent::robot::{Body, Robot};
use urts_mc::reference::walk::{Gait, Walk, WalkError, nearest};

const LINE: [[f64; 2]; 2] = [[0.0, 0.0], [1.2, 0.0]];

/// The G1 with all its lengths times a number.
fn scaled(factor: f64) -> Robot {
    let mut robot = g1();
    let body = |body: &mut Body| body.com_m *= factor;
    body(&mut robot.base);
    for leg in &mut robot.legs {
        for joint in &mut leg.joints {
            joint.placement.translation.vector *= factor;
            body(&mut joint.body);
        }
        leg.foot.sole.translation.vector *= factor;
        leg.foot
            .sole_corners_m
            .as_flattened_mut()
            .iter_mut()
            .for_each(|length_m| *length_m *= factor);
    }
    robot
}

#[test]
fn the_gait_of_the_g1_is_its_own_and_that_of_a_robot_of_another_size_is_scaled() {
    assert_eq!(Gait::of(&g1()), Gait::G1);
    for factor in [0.5, 1.7] {
        let robot = scaled(factor);
        let (gait, own) = (Gait::of(&robot), Gait::G1);
        for (name, value) in gait.numbers() {
            let (_, of_g1) = *own.numbers().iter().find(|(own, _)| *own == name).unwrap();
            let is_length = name.ends_with("_m") && name != "smoothing_step_m";
            // The place of the feet is that of the ankles, which are 0.5 mm off the G1's own gait.
            let expected = if is_length { of_g1 * factor } else { of_g1 };
            assert!((value - expected).abs() < 5e-3, "{name} {value} {expected}");
        }
        assert!(Walk::plan(&robot, &LINE, &gait).is_ok(), "{factor}");
    }
}

#[test]
fn the_nearest_gait_can_be_walked_and_differs_no_more_than_it_has_to() {
    let robot = g1();
    let plan = |gait: &Gait| Walk::plan(&robot, &LINE, gait);
    // Too high: only the pelvis is lowered, by two parts in a hundred.
    let high = Gait {
        pelvis_height_m: 0.79,
        ..Gait::G1
    };
    assert!(plan(&high).is_err());
    let found = nearest(&high, 1.2, plan).unwrap();
    assert!(plan(&found).is_ok());
    let changed = found.unlike(&high);
    assert!(
        matches!(changed[..], [("pelvis_height_m", height_m)] if (0.7..0.79).contains(&height_m)),
        "{changed:?}"
    );
    // What can be walked is its own nearest.
    assert_eq!(nearest(&Gait::G1, 1.2, plan), Some(Gait::G1));
    // No gait helps where nothing can be planned.
    let mut tried = 0;
    let mut never = |_: &Gait| {
        tried += 1;
        Err::<Walk, _>(WalkError::TooFewWaypoints { count: 0 })
    };
    assert_eq!(nearest(&Gait::G1, 1.2, &mut never), None);
    // Of a long line fewer are tried: each takes longer.
    let all = tried;
    tried = 0;
    let mut never = |_: &Gait| {
        tried += 1;
        Err::<Walk, _>(WalkError::TooFewWaypoints { count: 0 })
    };
    assert_eq!(nearest(&Gait::G1, 100.0, &mut never), None);
    assert!(all > 200 && (1..100).contains(&tried), "{all} {tried}");
}
