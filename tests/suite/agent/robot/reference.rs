//! Against Pinocchio (golden/biped_dynamics.json) and an independent walk (golden/biped_walk.json).

use super::load;
use crate::common::golden;
use nalgebra::{Matrix6, SMatrix, SVector};
use serde_json::Value;
use urts_mc::agent::robot::dynamics::{
    bias_force, forward_dynamics, gravity_torque, inverse_dynamics, mass_matrix,
};
use urts_mc::agent::robot::kinematics::{by_leg, com_m, joined, leg_pose};
use urts_mc::agent::robot::wrench::{
    JointMotion, PelvisMotion, ankles_m, ground_reaction, left_share, whole_body_wrench,
};
use urts_mc::agent::robot::{JOINTS, LEG_JOINTS, Robot};

/// Both sides are f64 and of some hundred operations each.
const TOLERANCE: f64 = 1e-12;

type Joints = SVector<f64, JOINTS>;

/// The numbers of a vector or, row by row, of a matrix.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

fn vector<const N: usize>(value: &Value) -> [f64; N] {
    numbers(value).try_into().unwrap()
}

fn matrix<const R: usize, const C: usize>(value: &Value) -> SMatrix<f64, R, C> {
    SMatrix::from_row_slice(&numbers(value))
}

/// Largest difference over the largest entry.
fn relative<const R: usize, const C: usize>(
    ours: &SMatrix<f64, R, C>,
    theirs: &SMatrix<f64, R, C>,
) -> f64 {
    (ours - theirs).amax() / theirs.amax()
}

/// The largest relative difference of a quantity over the 20 states of both robots, which `ours` computes from a state.
fn worst<const R: usize, const C: usize>(
    name: &str,
    theirs: impl Fn(&Value) -> SMatrix<f64, R, C>,
    ours: impl Fn(&Robot, &Value) -> SMatrix<f64, R, C>,
) -> f64 {
    let file = golden("biped_dynamics.json");
    let robots = file["robots"].as_object().unwrap();
    assert_eq!(robots.len(), 2);
    let mut worst = 0.0_f64;
    for (robot, states) in robots {
        let robot = load(robot);
        let states = states.as_array().unwrap();
        assert_eq!(states.len(), 20);
        for state in states {
            let difference = relative(&ours(&robot, state), &theirs(state));
            // max() would drop a not-a-number.
            assert!(difference.is_finite(), "{name}");
            worst = worst.max(difference);
        }
    }
    println!("{name}: {worst:.1e}");
    worst
}

/// As [`worst`], of a quantity of the joints.
fn worst_of_joints(name: &str, ours: impl Fn(&Robot, &Value) -> [f64; JOINTS]) -> f64 {
    worst(
        name,
        |state| Joints::from(vector(&state[name])),
        |robot, state| Joints::from(ours(robot, state)),
    )
}

#[test]
fn val_mass_matrices_are_those_of_pinocchio() {
    let ours = |robot: &Robot, state: &Value| {
        let q = by_leg(&vector(&state["q"]));
        let mut mass = SMatrix::<f64, JOINTS, JOINTS>::zeros();
        for (i, leg) in robot.legs.iter().enumerate() {
            let at = i * LEG_JOINTS;
            mass.fixed_view_mut::<6, 6>(at, at)
                .copy_from(&mass_matrix(leg, &q[i]));
        }
        mass
    };
    let difference = worst("M", |state| matrix::<12, 12>(&state["M"]), ours);
    assert!(difference <= TOLERANCE, "{difference:e}");
}

#[test]
fn val_forces_torques_and_accelerations_are_those_of_pinocchio() {
    let differences = [
        worst_of_joints("h", |robot, state| {
            let [q, rate] = ["q", "qd"].map(|name| by_leg(&vector(&state[name])));
            let g = &robot.gravity_m_s2;
            joined(&[0, 1].map(|i| bias_force(&robot.legs[i], g, &q[i], &rate[i])))
        }),
        worst_of_joints("G", |robot, state| {
            let q = by_leg(&vector(&state["q"]));
            let g = &robot.gravity_m_s2;
            joined(&[0, 1].map(|i| gravity_torque(&robot.legs[i], g, &q[i])))
        }),
        worst_of_joints("tau_rnea", |robot, state| {
            let [q, rate, acceleration] =
                ["q", "qd", "qdd"].map(|name| by_leg(&vector(&state[name])));
            let g = &robot.gravity_m_s2;
            joined(
                &[0, 1].map(|i| {
                    inverse_dynamics(&robot.legs[i], g, &q[i], &rate[i], &acceleration[i])
                }),
            )
        }),
        worst_of_joints("qdd_fd", |robot, state| {
            let [q, rate, torque] = ["q", "qd", "tau_fd"].map(|name| by_leg(&vector(&state[name])));
            let g = &robot.gravity_m_s2;
            joined(
                &[0, 1].map(|i| forward_dynamics(&robot.legs[i], g, &q[i], &rate[i], &torque[i])),
            )
        }),
    ];
    for difference in differences {
        assert!(difference <= TOLERANCE, "{difference:e}");
    }
}

#[test]
fn val_ankles_and_their_jacobians_are_those_of_pinocchio() {
    for (i, side) in ["left_ankle", "right_ankle"].into_iter().enumerate() {
        let q = |state: &Value| by_leg(&vector(&state["q"]))[i];
        let differences = [
            worst(
                &format!("{side} p"),
                |state| matrix::<3, 1>(&state[side]["p"]),
                |robot, state| leg_pose(&robot.legs[i], &q(state)).ankle_m(),
            ),
            worst(
                &format!("{side} R"),
                |state| matrix::<3, 3>(&state[side]["R"]),
                |robot, state| {
                    let ankle = leg_pose(&robot.legs[i], &q(state)).ankle();
                    *ankle.rotation.to_rotation_matrix().matrix()
                },
            ),
            worst(
                &format!("{side} J6"),
                |state| matrix::<6, 12>(&state[side]["J6"]),
                |robot, state| {
                    // The other leg does not move this ankle.
                    let mut jacobian = SMatrix::<f64, 6, JOINTS>::zeros();
                    let own: Matrix6<f64> = leg_pose(&robot.legs[i], &q(state)).jacobian();
                    jacobian
                        .fixed_view_mut::<6, 6>(0, i * LEG_JOINTS)
                        .copy_from(&own);
                    jacobian
                },
            ),
        ];
        for difference in differences {
            assert!(difference <= TOLERANCE, "{side}: {difference:e}");
        }
    }
}

#[test]
fn val_centres_of_mass_are_those_of_pinocchio() {
    let whole = worst(
        "com_all",
        |state| matrix::<3, 1>(&state["com_all"]),
        |robot, state| com_m(robot, &vector(&state["q"])),
    );
    let of_legs = worst(
        "com_legs",
        |state| matrix::<3, 1>(&state["com_legs"]),
        |robot, state| {
            let base = &robot.base;
            let moment = com_m(robot, &vector(&state["q"])) * robot.mass_kg();
            (moment - base.com_m * base.mass_kg) / (robot.mass_kg() - base.mass_kg)
        },
    );
    assert!(
        whole <= TOLERANCE && of_legs <= TOLERANCE,
        "{whole:e} {of_legs:e}"
    );
}

/// A mass that is off by a hundredth of a per cent must show.
#[test]
fn the_comparison_detects_a_changed_mass() {
    let file = golden("biped_dynamics.json");
    let state = &file["robots"]["g1_12dof"][4];
    let mut robot = load("g1_12dof");
    robot.legs[0].joints[3].body.mass_kg *= 1.0001;
    let q = by_leg(&vector(&state["q"]))[0];
    let theirs = matrix::<12, 12>(&state["M"])
        .fixed_view::<6, 6>(0, 0)
        .into_owned();
    assert!(relative(&mass_matrix(&robot.legs[0], &q), &theirs) > 1e6 * TOLERANCE);
}

#[test]
fn val_a_walk_has_the_reference_zero_moment_point_and_ground_reaction() {
    let robot = Robot::g1().unwrap();
    let file = golden("biped_walk.json");
    let (mut zmp_m, mut reaction_n_m, mut fixed_n_m) = (0.0_f64, 0.0_f64, 0.0_f64);
    let samples = file["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 48);
    for sample in samples {
        let joints = JointMotion {
            q_rad: vector(&sample["q"]),
            rate_rad_s: vector(&sample["qd"]),
            acceleration_rad_s2: vector(&sample["qdd"]),
        };
        let pelvis = PelvisMotion {
            position_m: vector::<3>(&sample["pelvis_m"]).into(),
            acceleration_m_s2: vector::<3>(&sample["pelvis_acceleration_m_s2"]).into(),
            yaw_rad: 0.0,
            yaw_rate_rad_s: 0.0,
            yaw_acceleration_rad_s2: 0.0,
        };
        let wrench = whole_body_wrench(&robot, &pelvis, &joints);
        let zmp = wrench.zmp_m();
        let expected = matrix::<2, 1>(&sample["zmp_m"]);
        zmp_m = zmp_m.max((zmp.xy() - expected).amax());
        let share = match sample["support"].as_str().unwrap() {
            "L" => 1.0,
            "R" => 0.0,
            _ => left_share(&zmp, &ankles_m(&robot, &pelvis, &joints.q_rad)),
        };
        let reaction = ground_reaction(&robot, &pelvis, &joints.q_rad, &wrench, share);
        let expected: [f64; JOINTS] = vector(&sample["ground_reaction"]);
        reaction_n_m = reaction_n_m.max((Joints::from(reaction) - Joints::from(expected)).amax());
        let [q, rate, acceleration] = ["q", "qd", "qdd"].map(|name| by_leg(&vector(&sample[name])));
        let torque = joined(&[0, 1].map(|i| {
            let (leg, g) = (&robot.legs[i], &robot.gravity_m_s2);
            inverse_dynamics(leg, g, &q[i], &rate[i], &acceleration[i])
        }));
        let expected: [f64; JOINTS] = vector(&sample["torque_pelvis_fixed"]);
        fixed_n_m = fixed_n_m.max((Joints::from(torque) - Joints::from(expected)).amax());
    }
    println!("zmp {zmp_m:.1e} m, ground reaction {reaction_n_m:.1e}, fixed {fixed_n_m:.1e} N m");
    // The inputs are rounded to 1e-12; z_c / g and 35 kg times a metre carry that over.
    assert!(zmp_m <= 1e-11, "{zmp_m:e}");
    assert!(
        reaction_n_m <= 1e-9 && fixed_n_m <= 1e-9,
        "{reaction_n_m:e} {fixed_n_m:e}"
    );
}
