//! The walk as a whole: every stage after the other.

use super::com::{self, CenterOfMass};
use super::course::{Course, Placement};
use super::error::WalkError;
use super::feet::Feet;
use super::gait::Gait;
use super::kinematics;
use super::samples::{ROUNDING, count, floor};
use super::spline::Spline;
use super::zmp::{self, ZmpReference};
use crate::agent::robot::{JOINTS, Robot};
use crate::reference::point::ReferencePoint;

/// A planned walk with all intermediate results.
///
/// Samples lie at the multiples of the gait's sampling period, the first at the time zero.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Walk {
    /// The gait.
    pub gait: Gait,
    /// The smoothed line.
    pub course: Course,
    /// Footholds and swings.
    pub feet: Feet,
    /// The zero moment point planned for.
    pub zmp_reference: ZmpReference,
    /// Centre of mass and zero moment point of the pendulum at the samples.
    pub com: CenterOfMass,
    /// Centre of mass in the pelvis frame, the same throughout, m.
    pub com_offset_m: [f64; 3],
    /// Pelvis x, y (m) and yaw (rad).
    pub pelvis: Spline<3>,
    /// Angles of the joints, rad.
    pub joints: Spline<JOINTS>,
}

impl Walk {
    /// The walk of `robot` along `waypoints` (x, y), m.
    ///
    /// It stands on the first waypoint, walks, and ends standing on the last one.
    ///
    /// # Errors
    /// See [`WalkError`].
    pub fn plan(robot: &Robot, waypoints: &[[f64; 2]], gait: &Gait) -> Result<Self, WalkError> {
        let feet = feet_along(waypoints, gait)?;
        let com_offset_m = kinematics::standing_com_offset(robot, gait)?;
        plan_above(robot, feet, gait, com_offset_m)
    }

    /// As [`Walk::plan`], with the centre of mass at `com_offset_m` in the pelvis frame.
    ///
    /// # Errors
    /// See [`WalkError`].
    pub fn plan_with_com_offset(
        robot: &Robot,
        waypoints: &[[f64; 2]],
        gait: &Gait,
        com_offset_m: [f64; 3],
    ) -> Result<Self, WalkError> {
        plan_above(robot, feet_along(waypoints, gait)?, gait, com_offset_m)
    }

    /// End of the standing after the last step, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.joints.range()[1]
    }

    /// Times of the samples, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> {
        let sampling_s = self.gait.sampling_s;
        (0..self.com.states.len()).map(move |k| count(k) * sampling_s)
    }

    /// Angles of all joints and their first two derivatives, left leg first. Beyond the ends: the
    /// first or the last pose, at rest.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [ReferencePoint; JOINTS] {
        self.joints.at(t_s)
    }

    /// Where the pelvis is.
    #[must_use]
    pub fn pelvis_at(&self, t_s: f64) -> Placement {
        let [x, y, heading_rad] = self.pelvis.value(t_s);
        Placement {
            position_m: [x, y],
            heading_rad,
        }
    }
}

fn feet_along(waypoints: &[[f64; 2]], gait: &Gait) -> Result<(Course, Feet), WalkError> {
    let course = Course::new(waypoints, gait)?;
    let feet = Feet::new(&course, gait)?;
    Ok((course, feet))
}

fn plan_above(
    robot: &Robot,
    (course, feet): (Course, Feet),
    gait: &Gait,
    com_offset_m: [f64; 3],
) -> Result<Walk, WalkError> {
    let zmp_reference = ZmpReference::new(&feet, gait);
    let last = (feet.end_s(gait) / gait.sampling_s - ROUNDING).ceil();
    let times: Vec<f64> = (0..=floor(last))
        .map(|k| count(k) * gait.sampling_s)
        .collect();
    let reference: Vec<[f64; 2]> = times.iter().map(|&t_s| zmp_reference.at(t_s)).collect();
    let height_m = com_height(gait, com_offset_m)?;
    let com = com::track(&reference, height_m, gait.sampling_s);
    check_balance(robot, &feet, &times, &com)?;

    let mut pelvis = Vec::with_capacity(times.len());
    let mut joints = Vec::with_capacity(times.len());
    let mut pose = robot.standing_rad;
    for (&t_s, [x, y]) in times.iter().zip(&com.states) {
        let ankles = feet.ankles_at(t_s);
        let [left, right] = ankles.map(|ankle| ankle.placement.heading_rad);
        let center = Placement {
            position_m: [x[0], y[0]],
            heading_rad: 0.5 * (left + right),
        };
        let below = center.beside([-com_offset_m[0], -com_offset_m[1]]);
        pose = kinematics::pose(robot, (below, gait.pelvis_height_m), ankles, &pose, t_s)?;
        let [x, y] = below.position_m;
        pelvis.push((t_s, [x, y, below.heading_rad]));
        joints.push((t_s, pose));
    }
    // The tracker's jerk is constant between samples: along a straight line the clamped spline
    // through them is its very motion.
    let ends = [com.states.first(), com.states.last()];
    let slopes = ends.map(|state| state.map_or([0.0; 3], |[x, y]| [x[1], y[1], 0.0]));
    Ok(Walk {
        gait: *gait,
        course,
        feet,
        zmp_reference,
        com,
        com_offset_m,
        pelvis: Spline::clamped(pelvis, slopes),
        joints: Spline::at_rest(joints),
    })
}

/// Height z_c of the pendulum, m.
fn com_height(gait: &Gait, offset_m: [f64; 3]) -> Result<f64, WalkError> {
    for value in offset_m {
        if value.is_nan() || value.abs() >= gait.pelvis_height_m {
            return Err(WalkError::Gait {
                name: "com_offset_m",
                value,
                limit: format!("must be below pelvis_height_m = {}", gait.pelvis_height_m),
                remedy: "give the centre of mass in the pelvis frame, in m",
            });
        }
    }
    Ok(gait.pelvis_height_m + offset_m[2])
}

/// The zero moment point of the pendulum must stay in the support polygon.
fn check_balance(
    robot: &Robot,
    feet: &Feet,
    times: &[f64],
    com: &CenterOfMass,
) -> Result<(), WalkError> {
    let soles = zmp::soles(robot);
    for (&t_s, &point) in times.iter().zip(&com.zmp_m) {
        let margin_m = zmp::margin(&zmp::support_polygon(feet, &soles, t_s), point);
        if margin_m < 0.0 {
            return Err(WalkError::Falls {
                t_s,
                outside_m: -margin_m,
            });
        }
    }
    Ok(())
}
