//! How a robot stands.

use super::check::Check;
use super::error::RobotError;
use super::inverse::level_below_hip;
use super::kinematics::{by_leg, joined, leg_pose};
use super::structure::{JOINTS, LEFT, Leg, RIGHT};
use super::urdf::Standing;
use nalgebra::Vector6;

/// The angles at which a robot stands, rad.
///
/// # Errors
/// If they are outside the joints' ranges, or none within them are found.
pub(super) fn angles_rad(
    check: &Check<'_>,
    legs: &[Leg; 2],
    standing: &Standing,
) -> Result<[f64; JOINTS], RobotError> {
    match standing {
        Standing::Angles(angles_rad) => {
            check.standing("standing", legs, angles_rad)?;
            Ok(*angles_rad)
        }
        Standing::Bent => bent(check, legs),
    }
}

/// Both knees bent, the feet level below the hips.
fn bent(check: &Check<'_>, legs: &[Leg; 2]) -> Result<[f64; JOINTS], RobotError> {
    let mut both = [Vector6::zeros(); 2];
    for (own, leg) in both.iter_mut().zip(legs) {
        *own = level_below_hip(leg).ok_or_else(|| {
            check.invalid(
                format!("standing ({})", leg.joints[0].name),
                "\"bent\"",
                "no pose within the joints' ranges puts the foot level below the hip",
                "give the angles at which the robot stands",
            )
        })?;
    }
    Ok(joined(&both))
}

/// Height of the pelvis above the lower sole, m.
pub(super) fn height_m(legs: &[Leg; 2], q_rad: &[f64; JOINTS]) -> f64 {
    let q = by_leg(q_rad);
    [LEFT, RIGHT]
        .map(|i| -leg_pose(&legs[i], &q[i]).sole().translation.z)
        .into_iter()
        .fold(f64::NEG_INFINITY, f64::max)
}
