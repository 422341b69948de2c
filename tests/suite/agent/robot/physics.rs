//! What holds whatever the numbers: positive definite inertia, energy, momentum, inverses, mirror images.

use super::{LegState, leg_states, load, numbers, shipped};
use nalgebra::{Cholesky, Matrix3, Matrix6, Rotation3, Vector3, Vector6};
use urts_mc::agent::robot::dynamics::{
    bias_force, forward_dynamics, gravity_torque, inverse_dynamics, mass_matrix,
};
use urts_mc::agent::robot::kinematics::{by_leg, com_m, leg_pose};
use urts_mc::agent::robot::wrench::{JointMotion, PelvisMotion, Wrench, whole_body_wrench};
use urts_mc::agent::robot::{Body, JOINTS, Leg, Robot};

/// Step of central differences: truncation goes with its square, rounding with its inverse.
const DIFFERENCE: f64 = 1e-5;

/// The legs of both robots, each with states.
fn legs_and_states() -> Vec<(Robot, usize, Vec<LegState>)> {
    let of = |robot: Robot| [0, 1].map(|leg| (robot.clone(), leg, leg_states(7, 50)));
    shipped().into_iter().flat_map(of).collect()
}

/// Angular velocity between two attitudes a short time apart: sine of the angle between them, along its axis.
fn angular_velocity(before: &Matrix3<f64>, after: &Matrix3<f64>, time_s: f64) -> Vector3<f64> {
    let between = after * before.transpose();
    let twice_odd = between - between.transpose();
    Vector3::new(twice_odd[(2, 1)], twice_odd[(0, 2)], twice_odd[(1, 0)]) / (2.0 * time_s)
}

/// Energy of the links and the rotors, J, with velocities by differences of the poses.
fn kinetic_energy(leg: &Leg, state: &LegState) -> f64 {
    let at = |time: f64| leg_pose(leg, &(state.q + state.rate * time));
    let (before, now, after) = (at(-DIFFERENCE), at(0.0), at(DIFFERENCE));
    let of_link = |i: usize| {
        let body = now.bodies()[i];
        let velocity = (after.bodies()[i].com_m - before.bodies()[i].com_m) / (2.0 * DIFFERENCE);
        let omega = angular_velocity(&before.rotations[i], &after.rotations[i], 2.0 * DIFFERENCE);
        let rotor = leg.joints[i].armature_kg_m2 * state.rate[i].powi(2);
        0.5 * (body.mass_kg * velocity.norm_squared()
            + omega.dot(&(body.inertia_kg_m2 * omega))
            + rotor)
    };
    (0..6).map(of_link).sum()
}

fn potential_energy(leg: &Leg, gravity: &Vector3<f64>, q: &Vector6<f64>) -> f64 {
    let bodies = leg_pose(leg, q).bodies();
    bodies
        .iter()
        .map(|body| -body.mass_kg * gravity.dot(&body.com_m))
        .sum()
}

#[test]
fn mass_matrices_are_symmetric_and_positive_definite() {
    for (robot, leg, states) in legs_and_states() {
        for state in states {
            let mass = mass_matrix(&robot.legs[leg], &state.q);
            assert_eq!(mass, mass.transpose());
            assert!(Cholesky::new(mass).is_some());
        }
    }
}

#[test]
fn kinetic_energy_is_that_of_the_links_and_rotors() {
    for (robot, leg, states) in legs_and_states() {
        for state in states {
            let leg = &robot.legs[leg];
            let energy = 0.5 * state.rate.dot(&(mass_matrix(leg, &state.q) * state.rate));
            let of_links = kinetic_energy(leg, &state);
            // Central differences: a link turns by some 1e-4 rad in 1e-5 s, and truncation goes with its square.
            assert!(
                (energy - of_links).abs() <= 1e-7 * energy,
                "{energy} {of_links}"
            );
        }
    }
}

#[test]
fn energy_changes_by_the_power_of_the_joints_less_damping() {
    for (mut robot, leg, states) in legs_and_states() {
        for joint in &mut robot.legs[leg].joints {
            joint.damping_n_m_s = 0.2;
        }
        let (leg, g) = (&robot.legs[leg], &robot.gravity_m_s2);
        for state in states {
            let (q, rate) = (state.q, state.rate);
            let torque = state.acceleration / 5.0;
            let acceleration = forward_dynamics(leg, g, &q, &rate, &torque);
            let energy = |time: f64| {
                let q = q + rate * time + acceleration * (time * time / 2.0);
                let rate = rate + acceleration * time;
                0.5 * rate.dot(&(mass_matrix(leg, &q) * rate)) + potential_energy(leg, g, &q)
            };
            let step_s = 1e-6;
            let change = (energy(step_s) - energy(-step_s)) / (2.0 * step_s);
            let power = rate.dot(&(torque - 0.2 * rate));
            // Rounding of some 10 J over 2e-6 s; truncation is far below it.
            assert!(
                (change - power).abs() <= 1e-7 * (1.0 + torque.norm() * rate.norm()),
                "{change} {power}"
            );
        }
    }
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    for (robot, leg, states) in legs_and_states() {
        let (leg, g) = (&robot.legs[leg], &robot.gravity_m_s2);
        for LegState {
            q,
            rate,
            acceleration,
        } in states
        {
            let torque = inverse_dynamics(leg, g, &q, &rate, &acceleration);
            let again = forward_dynamics(leg, g, &q, &rate, &torque);
            // Rounding times the condition of M, some 1e3.
            assert!((again - acceleration).amax() <= 1e-12 * acceleration.amax());
        }
    }
}

#[test]
fn centrifugal_forces_are_quadratic_in_the_rates() {
    for (robot, leg, states) in legs_and_states() {
        let (leg, g) = (&robot.legs[leg], &robot.gravity_m_s2);
        for state in states {
            let of = |factor: f64| {
                bias_force(leg, g, &state.q, &(state.rate * factor))
                    - gravity_torque(leg, g, &state.q)
            };
            // Rounding only.
            assert!((of(-2.0) - of(1.0) * 4.0).amax() <= 1e-12 * (1.0 + of(-2.0).amax()));
            assert!(of(1.0).amax() > 1e-3, "the state must move");
        }
    }
}

#[test]
fn jacobian_is_the_derivative_of_the_ankle() {
    for (mut robot, leg, states) in legs_and_states() {
        robot.legs[leg].foot.ankle_offset_m = Vector3::new(0.02, -0.03, -0.05);
        let leg = &robot.legs[leg];
        for state in states {
            let at = |time: f64| leg_pose(leg, &(state.q + state.rate * time));
            let (before, after) = (at(-DIFFERENCE), at(DIFFERENCE));
            let velocity = (after.ankle_m() - before.ankle_m()) / (2.0 * DIFFERENCE);
            let omega =
                angular_velocity(&before.rotations[5], &after.rotations[5], 2.0 * DIFFERENCE);
            let twist = leg_pose(leg, &state.q).jacobian() * state.rate;
            // Central differences: as above, of velocities of some 10 m/s and rad/s.
            assert!((twist.fixed_rows::<3>(0) - velocity).amax() <= 1e-6);
            assert!((twist.fixed_rows::<3>(3) - omega).amax() <= 1e-6);
        }
    }
}

/// Roll and yaw change their sign. One product of inertia of the right shank has the wrong sign at the source of the
/// table.
#[test]
fn legs_of_the_g1_are_mirror_images_but_for_one_product_of_inertia() {
    let mut robot = load("g1_12dof");
    let left_xz = robot.legs[0].joints[3].body.inertia_kg_m2[(0, 2)];
    let shank = &mut robot.legs[1].joints[3].body.inertia_kg_m2;
    assert_eq!(shank[(0, 2)], -left_xz);
    (shank[(0, 2)], shank[(2, 0)]) = (left_xz, left_xz);
    let mirror = Matrix6::from_diagonal(&Vector6::new(1.0, -1.0, -1.0, 1.0, 1.0, -1.0));
    let [left, right] = &robot.legs;
    let g = &robot.gravity_m_s2;
    for state in leg_states(11, 50) {
        let (q, rate) = (mirror * state.q, mirror * state.rate);
        let mass = mass_matrix(left, &state.q);
        let mirrored = mirror * mass_matrix(right, &q) * mirror;
        // Rounding only.
        assert!((mass - mirrored).amax() <= 1e-14 * (1.0 + mass.amax()));
        let force = bias_force(left, g, &state.q, &state.rate);
        let mirrored = mirror * bias_force(right, g, &q, &rate);
        assert!((force - mirrored).amax() <= 1e-13 * (1.0 + force.amax()));
        assert!(force.amax() > 0.1, "the state must load the leg");
    }
}

/// A smooth motion of the whole robot that turns.
struct Motion {
    amplitudes: Vec<f64>,
}

impl Motion {
    fn new() -> Self {
        let mut next = numbers(3);
        Self {
            amplitudes: (0..32).map(|_| next()).collect(),
        }
    }

    /// Value, rate and acceleration of the i-th coordinate.
    fn coordinate(&self, i: usize, t: f64) -> [f64; 3] {
        let (a, phase) = (self.amplitudes[i], 3.0 * self.amplitudes[i + 16]);
        let w = 2.0 + a;
        let (sin, cos) = (w * t + phase).sin_cos();
        [a * sin, a * w * cos, -a * w * w * sin]
    }

    fn at(&self, t: f64) -> (PelvisMotion, JointMotion) {
        let along = |part: usize| Vector3::from_fn(|i, _| self.coordinate(12 + i, t)[part]);
        let joints = |part: usize| std::array::from_fn(|i| self.coordinate(i, t)[part]);
        let [yaw_rad, yaw_rate_rad_s, yaw_acceleration_rad_s2] = self.coordinate(15, t);
        let pelvis = PelvisMotion {
            position_m: along(0),
            acceleration_m_s2: along(2),
            yaw_rad,
            yaw_rate_rad_s,
            yaw_acceleration_rad_s2,
        };
        let joints = JointMotion {
            q_rad: joints(0),
            rate_rad_s: joints(1),
            acceleration_rad_s2: joints(2),
        };
        (pelvis, joints)
    }

    /// Every body in the world, with its attitude.
    fn bodies(&self, robot: &Robot, t: f64) -> Vec<(Body, Matrix3<f64>)> {
        let (pelvis, joints) = self.at(t);
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), pelvis.yaw_rad).into_inner();
        let q: [Vector6<f64>; 2] = by_leg(&joints.q_rad);
        let mut all = vec![(robot.base, Matrix3::identity())];
        for (leg, q) in robot.legs.iter().zip(&q) {
            let pose = leg_pose(leg, q);
            all.extend(pose.bodies().into_iter().zip(pose.rotations));
        }
        let in_world = |(body, attitude): (Body, Matrix3<f64>)| {
            (body.moved(&turned, &pelvis.position_m), turned * attitude)
        };
        all.into_iter().map(in_world).collect()
    }

    /// Momentum and angular momentum about the world's origin, by differences of the bodies' positions.
    fn momentum(&self, robot: &Robot, t: f64, step_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [before, now, after] = [t - step_s, t, t + step_s].map(|t| self.bodies(robot, t));
        let mut sum = (Vector3::zeros(), Vector3::zeros());
        for ((before, now), after) in before.iter().zip(&now).zip(&after) {
            let body = &now.0;
            let velocity = (after.0.com_m - before.0.com_m) / (2.0 * step_s);
            let omega = angular_velocity(&before.1, &after.1, 2.0 * step_s);
            sum.0 += body.mass_kg * velocity;
            sum.1 += body.com_m.cross(&(body.mass_kg * velocity)) + body.inertia_kg_m2 * omega;
        }
        sum
    }
}

#[test]
fn wrench_of_a_turning_robot_is_the_rate_of_its_momentum_less_gravity() {
    let motion = Motion::new();
    for robot in shipped() {
        for t in [0.0, 0.4, 1.3, 2.9] {
            let step_s = 2e-4;
            let before = motion.momentum(&robot, t - step_s, step_s);
            let after = motion.momentum(&robot, t + step_s, step_s);
            let rate =
                |after: Vector3<f64>, before: Vector3<f64>| (after - before) / (2.0 * step_s);
            let weight = robot.mass_kg() * robot.gravity_m_s2;
            let bodies = motion.bodies(&robot, t);
            let torque_of_weight = bodies.iter().fold(Vector3::zeros(), |sum, (body, _)| {
                sum + body.com_m.cross(&(body.mass_kg * robot.gravity_m_s2))
            });
            let force = rate(after.0, before.0) - weight;
            let moment = rate(after.1, before.1) - torque_of_weight;
            let (pelvis, joints) = motion.at(t);
            let wrench = whole_body_wrench(&robot, &pelvis, &joints).about(&Vector3::zeros());
            // Central differences: (3 rad/s x 2e-4 s)^2 of the accelerations.
            let tolerance = 1e-6 * (1.0 + force.amax());
            assert!(
                (wrench.force_n - force).amax() <= tolerance,
                "{force} {}",
                wrench.force_n
            );
            assert!(
                (wrench.moment_n_m - moment).amax() <= tolerance,
                "{moment} {}",
                wrench.moment_n_m
            );
        }
    }
}

#[test]
fn wrench_at_the_zero_moment_point_has_no_horizontal_moment() {
    let wrench = Wrench {
        force_n: Vector3::new(3.0, -7.0, 300.0),
        moment_n_m: Vector3::new(11.0, -20.0, 2.0),
        about_m: Vector3::new(0.3, 0.1, 0.74),
    };
    let zmp = wrench.zmp_m();
    let moment = wrench.about(&zmp).moment_n_m;
    // Rounding only.
    assert!(
        moment.xy().amax() <= 1e-12 && moment.z.abs() > 0.1,
        "{moment}"
    );
    assert_eq!(zmp.z, 0.0);
}

#[test]
fn standing_still_takes_the_weight_below_the_centre_of_mass() {
    let robot = Robot::g1().unwrap();
    let pelvis = PelvisMotion {
        position_m: Vector3::new(1.0, 2.0, robot.base_height_m),
        acceleration_m_s2: Vector3::zeros(),
        yaw_rad: 0.5,
        yaw_rate_rad_s: 0.0,
        yaw_acceleration_rad_s2: 0.0,
    };
    let joints = JointMotion {
        q_rad: robot.standing_rad,
        rate_rad_s: [0.0; JOINTS],
        acceleration_rad_s2: [0.0; JOINTS],
    };
    let wrench = whole_body_wrench(&robot, &pelvis, &joints);
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5);
    let com = com_m(&robot, &robot.standing_rad);
    let below = pelvis.position_m + turned * com;
    // Rounding only.
    assert!((wrench.force_n.z - robot.mass_kg() * 9.81).abs() <= 1e-11);
    assert!((wrench.zmp_m().xy() - below.xy()).amax() <= 1e-13);
}
