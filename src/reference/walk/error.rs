//! Why there is no walk.

use super::foot::Foot;
use thiserror::Error;

/// Why waypoints and a gait do not give a walk. Indices count from zero, times from the start.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WalkError {
    /// A number of the gait is out of its range, or contradicts another one.
    #[error("{name} = {value} {limit}; {remedy}")]
    Gait {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        limit: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A line needs a start and an end.
    #[error("a walk has {count} waypoint(s) and needs at least 2; add where it is to end")]
    TooFewWaypoints {
        /// Number of waypoints given.
        count: usize,
    },
    /// A coordinate is not finite or too large.
    #[error(
        "waypoint {index} is {point_m:?} m; coordinates must be finite and at most 1e4 m in size"
    )]
    Waypoint {
        /// The waypoint.
        index: usize,
        /// Where it is, m.
        point_m: [f64; 2],
    },
    /// Two waypoints in a row give no direction.
    #[error("waypoint {index} coincides with the one before it; remove one of the two")]
    Coincident {
        /// The second of the two.
        index: usize,
    },
    /// The line turns back on itself.
    #[error(
        "at waypoint {index} the line turns by {turn_deg:.0} degrees and a walk can follow at most \
         {limit_deg:.0}; spread the turn over more waypoints"
    )]
    Reversal {
        /// The waypoint.
        index: usize,
        /// The turn, degrees.
        turn_deg: f64,
        /// The largest turn, degrees.
        limit_deg: f64,
    },
    /// There is no room for a whole step.
    #[error(
        "the line is {length_m} m long, shorter than one step of {step_length_m} m; move its end \
         or shorten the step"
    )]
    ShorterThanAStep {
        /// Length of the smoothed line, m.
        length_m: f64,
        /// The gait's step length, m.
        step_length_m: f64,
    },
    /// The walk has more samples than memory should hold.
    #[error(
        "the walk takes {samples:.0} samples and can have at most {limit}; divide the line or raise \
         the sampling period"
    )]
    TooLong {
        /// Number of samples.
        samples: f64,
        /// The largest number.
        limit: u32,
    },
    /// A turn brings the feet together.
    #[error(
        "at {t_s:.2} s the {foot} foot comes down {distance_m:.3} m beside the other and must keep \
         {limit_m:.3} m; widen the bend (more waypoints, a longer smoothing_step_m) or shorten the \
         step"
    )]
    FeetTooClose {
        /// When.
        t_s: f64,
        /// The foot that steps.
        foot: Foot,
        /// Distance across the direction of either foot, m.
        distance_m: f64,
        /// The least distance, m.
        limit_m: f64,
    },
    /// The zero moment point of the planned motion leaves the supporting feet.
    #[error(
        "at {t_s:.2} s the robot falls: its zero moment point is {outside_m:.4} m outside the \
         supporting feet and may not leave them; step more slowly, or stand longer before and after \
         the walk"
    )]
    Falls {
        /// When.
        t_s: f64,
        /// Distance to the support polygon, m.
        outside_m: f64,
    },
    /// A foothold is farther away than the leg reaches.
    #[error(
        "at {t_s:.2} s the {foot} leg does not reach its foothold: the ankle is to be {distance_m:.3} \
         m from the hip, its joints put it at most {reach_m:.3} m away; shorten the step or lower the pelvis"
    )]
    OutOfReach {
        /// When.
        t_s: f64,
        /// The foot.
        foot: Foot,
        /// Distance from hip to ankle asked for, m.
        distance_m: f64,
        /// How far its joints put the ankle, m.
        reach_m: f64,
    },
    /// The inverse kinematics found no pose of the leg, though it would reach.
    #[error(
        "at {t_s:.2} s no joint angles were found that put the {foot} ankle where it is to be, {distance_m:.3} m from \
         the hip: with the foot turned as there, they were found up to {found_m:.3} m; lower the pelvis or shorten the step"
    )]
    NoPose {
        /// When.
        t_s: f64,
        /// The foot.
        foot: Foot,
        /// Distance from hip to ankle asked for, m.
        distance_m: f64,
        /// The largest distance, in that direction and with the foot so turned, for which a pose was found, m.
        found_m: f64,
    },
    /// A knee is so straight that its leg cannot move along itself.
    #[error(
        "at {t_s:.2} s joint {joint} is bent by {bend_rad:.4} rad and needs {limit_rad} rad to keep \
         the leg from being singular; lower the pelvis or shorten the step"
    )]
    StraightKnee {
        /// When.
        t_s: f64,
        /// Name of the knee joint.
        joint: String,
        /// Its angle, rad.
        bend_rad: f64,
        /// The least angle, rad.
        limit_rad: f64,
    },
    /// A joint would have to leave its range.
    #[error(
        "at {t_s:.2} s joint {joint} is at {angle_rad:.3} rad, its range is {min_rad} to {max_rad} \
         rad; shorten the step, widen the bends or change the pelvis height"
    )]
    JointLimit {
        /// When.
        t_s: f64,
        /// Name of the joint.
        joint: String,
        /// Its angle, rad.
        angle_rad: f64,
        /// The lower limit, rad.
        min_rad: f64,
        /// The upper limit, rad.
        max_rad: f64,
    },
}

impl WalkError {
    /// Whether another gait along the same line may do.
    #[must_use]
    pub fn is_of_the_gait(&self) -> bool {
        matches!(
            self,
            Self::FeetTooClose { .. }
                | Self::Falls { .. }
                | Self::OutOfReach { .. }
                | Self::NoPose { .. }
                | Self::StraightKnee { .. }
                | Self::JointLimit { .. }
        )
    }
}
