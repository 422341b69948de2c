//! What the ground has to do to a robot that moves: the whole-body wrench, its zero moment point, and the torques that
//! the ground reaction causes in the joints (the optional disturbance of the paper's (4)).
//!
//! The pelvis is upright and turns about the vertical only, as in the walking reference (section III-B). The world
//! frame has z up and the ground at z = 0. Rotors add to the joints' torques, not to this wrench.

use super::dynamics::{BaseMotion, carried, newton_euler};
use super::kinematics::{by_leg, joined, leg_pose};
use super::structure::{JOINTS, Robot};
use nalgebra::{Rotation3, Vector3, Vector6};

/// Motion of an upright pelvis. Its velocity is not asked for: no force depends on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PelvisMotion {
    /// Origin of the pelvis frame in the world, m.
    pub position_m: Vector3<f64>,
    /// Its second derivative, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Heading, rad.
    pub yaw_rad: f64,
    /// Its derivative, rad/s.
    pub yaw_rate_rad_s: f64,
    /// Its second derivative, rad/s^2.
    pub yaw_acceleration_rad_s2: f64,
}

/// Joint angles and their derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMotion {
    /// q, rad.
    pub q_rad: [f64; JOINTS],
    /// q', rad/s.
    pub rate_rad_s: [f64; JOINTS],
    /// q'', rad/s^2.
    pub acceleration_rad_s2: [f64; JOINTS],
}

/// A force and its moment, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force_n: Vector3<f64>,
    /// Moment about the point, N m.
    pub moment_n_m: Vector3<f64>,
    /// The point, m.
    pub about_m: Vector3<f64>,
}

impl Wrench {
    /// The same wrench about another point.
    #[must_use]
    pub fn about(&self, point_m: &Vector3<f64>) -> Self {
        Self {
            force_n: self.force_n,
            moment_n_m: self.moment_n_m + (self.about_m - point_m).cross(&self.force_n),
            about_m: *point_m,
        }
    }

    /// The point of the ground about which the wrench has no horizontal moment (the multibody ZMP), m; not finite if
    /// the wrench has no vertical force.
    #[must_use]
    pub fn zmp_m(&self) -> Vector3<f64> {
        let Wrench {
            force_n,
            moment_n_m,
            ..
        } = self.about(&Vector3::zeros());
        Vector3::new(-moment_n_m.y / force_n.z, moment_n_m.x / force_n.z, 0.0)
    }
}

/// The wrench that the ground has to exert on the robot for this motion: rate of momentum less gravity, about the
/// pelvis.
#[must_use]
pub fn whole_body_wrench(robot: &Robot, pelvis: &PelvisMotion, joints: &JointMotion) -> Wrench {
    let world_from_pelvis = heading(pelvis.yaw_rad);
    let free_of_gravity = pelvis.acceleration_m_s2 - robot.gravity_m_s2;
    let base = BaseMotion {
        angular_velocity: Vector3::z() * pelvis.yaw_rate_rad_s,
        angular_acceleration: Vector3::z() * pelvis.yaw_acceleration_rad_s2,
        acceleration: world_from_pelvis.inverse() * free_of_gravity,
    };
    let body = &robot.base;
    let spin = body.inertia_kg_m2 * base.angular_velocity;
    let of_com = base.acceleration
        + carried(
            &base.angular_velocity,
            &base.angular_acceleration,
            &body.com_m,
        );
    let mut force = body.mass_kg * of_com;
    let mut moment = body.inertia_kg_m2 * base.angular_acceleration
        + base.angular_velocity.cross(&spin)
        + body.com_m.cross(&force);
    let [q, rates, accelerations] = [
        &joints.q_rad,
        &joints.rate_rad_s,
        &joints.acceleration_rad_s2,
    ]
    .map(by_leg);
    for (i, leg) in robot.legs.iter().enumerate() {
        let pose = leg_pose(leg, &q[i]);
        let on_leg = newton_euler(&pose, &base, &rates[i], &accelerations[i]);
        force += on_leg.force_n;
        moment += on_leg.moment_n_m;
    }
    Wrench {
        force_n: world_from_pelvis * force,
        moment_n_m: world_from_pelvis * moment,
        about_m: pelvis.position_m,
    }
}

/// Origins of the left and the right ankle frame in the world, m.
#[must_use]
pub fn ankles_m(robot: &Robot, pelvis: &PelvisMotion, q_rad: &[f64; JOINTS]) -> [Vector3<f64>; 2] {
    let world_from_pelvis = heading(pelvis.yaw_rad);
    let q = by_leg(q_rad);
    std::array::from_fn(|i| {
        pelvis.position_m + world_from_pelvis * leg_pose(&robot.legs[i], &q[i]).ankle_m()
    })
}

/// The left foot's share of the ground reaction in double support: where the ZMP lies on the way from the right ankle
/// to the left, 0 to 1.
#[must_use]
pub fn left_share(zmp_m: &Vector3<f64>, [left, right]: &[Vector3<f64>; 2]) -> f64 {
    let (across, along) = ((left - right).xy(), (zmp_m - right).xy());
    (along.dot(&across) / across.norm_squared()).clamp(0.0, 1.0)
}

/// Torque J'f of the ground reaction in the joints, N m: `wrench` acts at its ZMP, `left_share` of it on the left foot
/// (1 or 0 in single support) and the rest on the right one.
#[must_use]
pub fn ground_reaction(
    robot: &Robot,
    pelvis: &PelvisMotion,
    q_rad: &[f64; JOINTS],
    wrench: &Wrench,
    left_share: f64,
) -> [f64; JOINTS] {
    let pelvis_from_world = heading(pelvis.yaw_rad).inverse();
    let ankles = ankles_m(robot, pelvis, q_rad);
    let q = by_leg(q_rad);
    let shares = [left_share, 1.0 - left_share];
    joined(&std::array::from_fn(|i| {
        let at_ankle = wrench.about(&ankles[i]);
        let force = pelvis_from_world * at_ankle.force_n * shares[i];
        let moment = pelvis_from_world * at_ankle.moment_n_m * shares[i];
        let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        leg_pose(&robot.legs[i], &q[i]).jacobian().tr_mul(&wrench)
    }))
}

fn heading(yaw_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad)
}
