//! Joint angles that put the ankles where they are to be, below a pelvis that carries the centre of
//! mass along (paper, section III-B).

use super::course::Placement;
use super::error::WalkError;
use super::feet::Ankle;
use super::foot::Foot;
use super::gait::Gait;
use crate::agent::robot::kinematics::{by_leg, com_m, joined, leg_pose};
use crate::agent::robot::{JOINTS, Leg, Robot};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

/// Largest component of the pose error at the solution, m and rad.
const TOLERANCE: f64 = 1e-12;
/// A warm start takes three; the first pose, from the robot's standing one, some more.
const MAX_ITERATIONS: u32 = 50;
/// Largest turn of a joint in one iteration, rad: keeps the first pose from overshooting.
const MAX_TURN_RAD: f64 = 0.5;
/// The fourth joint of a leg.
const KNEE: usize = 3;
/// Below it the joint rates that move the foot along the leg exceed ten times those of a bent one.
const MIN_KNEE_BEND_RAD: f64 = 0.1;

/// Joint angles of both legs, rad, for a pelvis upright at `pelvis` and `pelvis_height_m` and the
/// two ankles, by Newton's method from `start_rad`.
///
/// # Errors
/// [`WalkError::OutOfReach`], [`WalkError::StraightKnee`], [`WalkError::JointLimit`], with `t_s`.
pub fn pose(
    robot: &Robot,
    (pelvis, pelvis_height_m): (Placement, f64),
    ankles: [Ankle; 2],
    start_rad: &[f64; JOINTS],
    t_s: f64,
) -> Result<[f64; JOINTS], WalkError> {
    let mut joints_rad = by_leg(start_rad);
    for foot in Foot::BOTH {
        let leg = &robot.legs[foot.index()];
        let target = in_pelvis(leg, (pelvis, pelvis_height_m), ankles[foot.index()]);
        let joints = solve(leg, &target, joints_rad[foot.index()])
            .ok_or_else(|| out_of_reach(leg, foot, &target, t_s))?;
        check(leg, &joints, t_s)?;
        joints_rad[foot.index()] = joints;
    }
    Ok(joined(&joints_rad))
}

/// Centre of mass of the bent standing pose in the pelvis frame, m; its y is zero by decision, so
/// that both legs share what the upper body lacks in symmetry.
///
/// The pose that puts the centre of mass above the zero moment point depends on the offset and gives
/// it: a fixed point, found by iteration. The legs weigh less than the rest, so it contracts.
///
/// # Errors
/// As [`pose`], at time zero.
pub fn standing_com_offset(robot: &Robot, gait: &Gait) -> Result<[f64; 3], WalkError> {
    const MAX_ITERATIONS: u32 = 100;
    let ankles = Foot::BOTH.map(|foot| Ankle {
        placement: Placement {
            position_m: [0.0, foot.side() * gait.foot_offset_m],
            heading_rad: 0.0,
        },
        height_m: gait.ankle_height_m,
    });
    let mut joints_rad = robot.standing_rad;
    let mut offset_m = com_m(robot, &joints_rad);
    for _ in 0..MAX_ITERATIONS {
        let pelvis = Placement {
            position_m: [gait.zmp_ahead_m - offset_m.x, 0.0],
            heading_rad: 0.0,
        };
        joints_rad = pose(
            robot,
            (pelvis, gait.pelvis_height_m),
            ankles,
            &joints_rad,
            0.0,
        )?;
        let last_m = offset_m;
        offset_m = com_m(robot, &joints_rad);
        if (offset_m - last_m).amax() <= TOLERANCE {
            break;
        }
    }
    Ok([offset_m.x, 0.0, offset_m.z])
}

/// The pose of a leg's ankle frame in the pelvis frame: the sole upright, x along the heading.
fn in_pelvis(
    leg: &Leg,
    (pelvis, pelvis_height_m): (Placement, f64),
    ankle: Ankle,
) -> Isometry3<f64> {
    let [x, y] = pelvis.local(ankle.placement.position_m);
    let turn = ankle.placement.heading_rad - pelvis.heading_rad;
    Isometry3::from_parts(
        Translation3::new(x, y, ankle.height_m - pelvis_height_m),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
            * leg.foot.sole.rotation.inverse(),
    )
}

/// Newton's method on the six components of the pose error, in pelvis axes.
fn solve(leg: &Leg, target: &Isometry3<f64>, start_rad: Vector6<f64>) -> Option<Vector6<f64>> {
    let mut joints_rad = start_rad;
    for _ in 0..MAX_ITERATIONS {
        let pose = leg_pose(leg, &joints_rad);
        let at = pose.ankle();
        let shift = target.translation.vector - at.translation.vector;
        let turn = (target.rotation * at.rotation.inverse()).scaled_axis();
        let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        // Not-a-number is never within it.
        if error.iter().all(|part| part.abs() <= TOLERANCE) {
            return Some(joints_rad);
        }
        let step = pose.jacobian().lu().solve(&error)?;
        joints_rad += step * (MAX_TURN_RAD / step.amax()).min(1.0);
    }
    None
}

fn out_of_reach(leg: &Leg, foot: Foot, target: &Isometry3<f64>, t_s: f64) -> WalkError {
    let hip = leg.joints[0].placement.translation.vector;
    let from_hip = |pose: &Isometry3<f64>| (pose.translation.vector - hip).norm();
    WalkError::OutOfReach {
        t_s,
        foot,
        distance_m: from_hip(target),
        reach_m: from_hip(&leg_pose(leg, &Vector6::zeros()).ankle()),
    }
}

fn check(leg: &Leg, joints_rad: &Vector6<f64>, t_s: f64) -> Result<(), WalkError> {
    let bend_rad = joints_rad[KNEE].abs();
    if bend_rad < MIN_KNEE_BEND_RAD {
        return Err(WalkError::StraightKnee {
            t_s,
            joint: leg.joints[KNEE].name.clone(),
            bend_rad,
            limit_rad: MIN_KNEE_BEND_RAD,
        });
    }
    for (joint, &angle_rad) in leg.joints.iter().zip(joints_rad.iter()) {
        let (min_rad, max_rad) = (joint.q_min_rad, joint.q_max_rad);
        if !(min_rad <= angle_rad && angle_rad <= max_rad) {
            return Err(WalkError::JointLimit {
                t_s,
                joint: joint.name.clone(),
                angle_rad,
                min_rad,
                max_rad,
            });
        }
    }
    Ok(())
}
