//! How a robot of a URDF stands, and on what.

use super::options::{Soles, Standing, UrdfOptions};
use super::tree::Tree;
use crate::agent::robot::check::Check;
use crate::agent::robot::error::RobotError;
use crate::agent::robot::kinematics::{by_leg, leg_pose};
use crate::agent::robot::standing;
use crate::agent::robot::structure::{JOINTS, LEG_JOINTS, Leg};

/// Sets the soles of both legs; returns the standing pose, rad.
///
/// # Errors
/// If the pose is outside the joints' ranges, or a frame is not of the last link.
pub(super) fn set(
    check: &Check<'_>,
    tree: &Tree<'_>,
    legs: &mut [Leg; 2],
    options: &UrdfOptions,
) -> Result<[f64; JOINTS], RobotError> {
    let given = match &options.standing {
        Some(Standing::Angles(angles_rad)) => *angles_rad,
        Some(Standing::Bent) | None => [0.0; JOINTS],
    };
    match &options.soles {
        Some(Soles::Feet(feet)) => {
            for (leg, foot) in legs.iter_mut().zip(feet) {
                check.foot("soles", foot)?;
                leg.foot = foot.clone();
            }
        }
        Some(Soles::Frames(names)) => {
            for (leg, name) in legs.iter_mut().zip(names) {
                let last = &leg.joints[LEG_JOINTS - 1].name;
                leg.foot.sole = tree.frame_below(last, name)?;
            }
        }
        Some(Soles::Standing) | None => level(legs, &given),
    }
    match &options.standing {
        Some(standing) => standing::angles_rad(check, legs, standing),
        None => Ok(at_rest(legs)),
    }
}

/// What is taken for granted of the soles.
pub(super) fn assumed(options: &UrdfOptions) -> Option<String> {
    let said = options.soles.is_some() || matches!(options.standing, Some(Standing::Angles(_)));
    let note = "the soles are taken to be level at q = 0; agent.sole names their frames, or agent.standing gives the angles \
                at which the robot stands on them";
    (!said).then(|| note.to_string())
}

/// Turns the soles so that they are parallel to the pelvis at the joint angles `q_rad`.
fn level(legs: &mut [Leg; 2], q_rad: &[f64; JOINTS]) {
    for (leg, q_rad) in legs.iter_mut().zip(by_leg(q_rad)) {
        let last = leg_pose(leg, &q_rad).link(LEG_JOINTS - 1);
        leg.foot.sole.rotation = last.rotation.inverse();
    }
}

/// The pose nearest to zero that the joints can reach.
fn at_rest(legs: &[Leg; 2]) -> [f64; JOINTS] {
    std::array::from_fn(|i| {
        let joint = &legs[i / LEG_JOINTS].joints[i % LEG_JOINTS];
        0.0_f64.clamp(joint.q_min_rad, joint.q_max_rad)
    })
}
