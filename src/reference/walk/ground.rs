//! What the ground does to the joints along the walk: J'f, an optional disturbance.

use super::foot::Foot;
use super::plan::Walk;
use crate::agent::robot::wrench::{self, JointMotion, PelvisMotion, whole_body_wrench};
use crate::agent::robot::{JOINTS, Robot};
use nalgebra::Vector3;

/// The reaction of the ground at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundReaction {
    /// Zero moment point of all links, m.
    pub zmp_m: [f64; 2],
    /// The left foot's share of the load, 0 to 1.
    pub left_share: f64,
    /// Its torques J'f on the joints, N m.
    pub torque_n_m: [f64; JOINTS],
}

/// The ground's reaction at `t_s` while `robot` moves as planned.
///
/// The force and moment that move all links act at the zero moment point. In single support the
/// stance foot carries all of it, in double support the feet share it by the place of that point
/// between the ankles.
#[must_use]
pub fn ground_reaction(walk: &Walk, robot: &Robot, t_s: f64) -> GroundReaction {
    let joints = walk.at(t_s);
    let [x, y, yaw] = walk.pelvis.at(t_s);
    let pelvis = PelvisMotion {
        position_m: Vector3::new(x.value, y.value, walk.gait.pelvis_height_m),
        acceleration_m_s2: Vector3::new(x.acceleration, y.acceleration, 0.0),
        yaw_rad: yaw.value,
        yaw_rate_rad_s: yaw.rate,
        yaw_acceleration_rad_s2: yaw.acceleration,
    };
    let joints = JointMotion {
        q_rad: joints.map(|joint| joint.value),
        rate_rad_s: joints.map(|joint| joint.rate),
        acceleration_rad_s2: joints.map(|joint| joint.acceleration),
    };
    let load = whole_body_wrench(robot, &pelvis, &joints);
    let zmp_m = load.zmp_m();
    let left_share = match walk.feet.swing_at(t_s).map(|swing| swing.foot) {
        Some(Foot::Left) => 0.0,
        Some(Foot::Right) => 1.0,
        None => wrench::left_share(&zmp_m, &wrench::ankles_m(robot, &pelvis, &joints.q_rad)),
    };
    GroundReaction {
        zmp_m: [zmp_m.x, zmp_m.y],
        left_share,
        torque_n_m: wrench::ground_reaction(robot, &pelvis, &joints.q_rad, &load, left_share),
    }
}
