//! Joint angles that put the ankles where they are to be, below a pelvis that carries the centre of
//! mass along (paper, section III-B).

use super::course::Placement;
use super::error::WalkError;
use super::feet::Ankle;
use super::foot::Foot;
use super::gait::Gait;
use crate::agent::robot::inverse::{KNEE, STRAIGHT_RAD, TOLERANCE, bent, reach_m, solve};
use crate::agent::robot::kinematics::{by_leg, com_m, joined, leg_pose};
use crate::agent::robot::{JOINTS, Leg, Robot};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

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
        joints_rad[foot.index()] = of_leg(leg, foot, &target, joints_rad[foot.index()], t_s)?;
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

/// The joint angles of a leg: from the start, or, where that leads to none that the leg can take (a straight leg is
/// singular, and a start may lie on the wrong side of it), from bent poses.
fn of_leg(
    leg: &Leg,
    foot: Foot,
    target: &Isometry3<f64>,
    start_rad: Vector6<f64>,
    t_s: f64,
) -> Result<Vector6<f64>, WalkError> {
    let from_start = solve(leg, target, start_rad);
    let tried = from_start.map(|joints| check(leg, &joints, t_s).map(|()| joints));
    if let Some(Ok(joints)) = tried {
        return Ok(joints);
    }
    let solutions: Vec<Vector6<f64>> = bent(leg)
        .into_iter()
        .filter_map(|bent_rad| solve(leg, target, bent_rad))
        .collect();
    let ahead = |joints: &Vector6<f64>| leg_pose(leg, joints).origins_m[KNEE].x;
    let sound = solutions.iter().filter(|own| check(leg, own, t_s).is_ok());
    // Of two sides to bend to, people and their robots bend the knee forwards.
    if let Some(joints) = sound.max_by(|a, b| ahead(a).total_cmp(&ahead(b))) {
        return Ok(*joints);
    }
    // What keeps the leg from the nearest solution, if there is one.
    if let Some(Err(error)) = tried {
        return Err(error);
    }
    match solutions.first() {
        Some(joints) => check(leg, joints, t_s).map(|()| *joints),
        None => Err(no_pose(leg, foot, target, t_s)),
    }
}

/// Why no pose was found: the foothold is farther away than the leg reaches, or it is not.
fn no_pose(leg: &Leg, foot: Foot, target: &Isometry3<f64>, t_s: f64) -> WalkError {
    let hip = leg.joints[0].placement.translation.vector;
    let distance_m = (target.translation.vector - hip).norm();
    let reach_m = reach_m(leg);
    match distance_m > reach_m {
        true => WalkError::OutOfReach {
            t_s,
            foot,
            distance_m,
            reach_m,
        },
        false => WalkError::NoPose {
            t_s,
            foot,
            distance_m,
            found_m: distance_m * share_found(leg, target, hip),
        },
    }
}

/// The largest share of the way from the hip to the ankle for which a pose is found, the foot turned as at its end.
fn share_found(leg: &Leg, target: &Isometry3<f64>, hip_m: Vector3<f64>) -> f64 {
    let way_m = target.translation.vector - hip_m;
    let mut starts = bent(leg);
    let mut found = 0.0;
    for percent in 1..100 {
        let share = f64::from(percent) / 100.0;
        let nearer = Isometry3::from_parts((hip_m + way_m * share).into(), target.rotation);
        let poses = starts
            .iter()
            .filter_map(|start_rad| solve(leg, &nearer, *start_rad));
        let poses: Vec<Vector6<f64>> = poses.collect();
        if !poses.is_empty() {
            found = share;
            starts = poses;
        }
    }
    found
}

fn check(leg: &Leg, joints_rad: &Vector6<f64>, t_s: f64) -> Result<(), WalkError> {
    let bend_rad = joints_rad[KNEE].abs();
    if bend_rad < STRAIGHT_RAD {
        return Err(WalkError::StraightKnee {
            t_s,
            joint: leg.joints[KNEE].name.clone(),
            bend_rad,
            limit_rad: STRAIGHT_RAD,
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
