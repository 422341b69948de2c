//! The numbers of a gait.

use super::error::WalkError;
use super::foot::Foot;
use crate::agent::robot::inverse::reach_m;
use crate::agent::robot::kinematics::{by_leg, leg_pose};
use crate::agent::robot::{LEFT, RIGHT, Robot};

/// How a robot walks. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// Period at which the centre of mass and the joints are planned, s.
    pub sampling_s: f64,
    /// Largest distance along the line between two footholds, m. The line is divided into equal
    /// steps no longer than this; the first swing covers one of them, the others two, and the last
    /// foot closes up.
    pub step_length_m: f64,
    /// How far a swinging ankle is raised, m.
    pub step_height_m: f64,
    /// From touch-down to touch-down, s.
    pub step_period_s: f64,
    /// The part of the period in which both feet stand and the weight shifts, s.
    pub double_support_s: f64,
    /// Distance of either foot from the line, L1 of the paper, m.
    pub foot_offset_m: f64,
    /// Height of the pelvis origin above the ground, m.
    pub pelvis_height_m: f64,
    /// Height of an ankle above its foothold, m.
    pub ankle_height_m: f64,
    /// How far ahead of the ankle the zero moment point is to lie under a foot, m.
    pub zmp_ahead_m: f64,
    /// Standing before the first step, s.
    pub standing_before_s: f64,
    /// Standing after the last step, s.
    pub standing_after_s: f64,
    /// The foot that steps first.
    pub first_foot: Foot,
    /// Step of the linear interpolation between waypoints, m: every leg is divided evenly, as near
    /// to it as possible, before the cubic spline. Between long legs a right-angled corner becomes
    /// a bend of radius 0.2 times this.
    pub smoothing_step_m: f64,
}

/// A number's name, its value and the range it must lie in.
type Entry = (&'static str, f64, [f64; 2]);

impl Gait {
    /// A slow walk of the Unitree G1.
    pub const G1: Self = Self {
        sampling_s: 0.01,
        step_length_m: 0.2,
        step_height_m: 0.05,
        step_period_s: 0.9,
        double_support_s: 0.15,
        foot_offset_m: 0.1185,
        pelvis_height_m: 0.74,
        ankle_height_m: 0.035,
        zmp_ahead_m: 0.03,
        standing_before_s: 1.2,
        standing_after_s: 1.6,
        first_foot: Foot::Right,
        smoothing_step_m: 2.0,
    };

    /// [`Gait::G1`] for a robot of another size: lengths grow with the reach of its legs, the feet stand where the
    /// ankles are in its standing pose, and the pelvis is as much above the hips as the robot's own. Times stay: steps
    /// of the same time are slower for a small robot and quicker for a large one, whose pendulum is slower.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let Ok(g1) = Robot::g1() else { return Self::G1 };
        let (own, its) = (Size::of(robot), Size::of(&g1));
        let scale = own.reach_m / its.reach_m;
        let hip_to_ankle_m =
            Self::G1.pelvis_height_m - Self::G1.ankle_height_m - its.pelvis_above_hips_m;
        let ankle_height_m = Self::G1.ankle_height_m * scale;
        Self {
            step_length_m: Self::G1.step_length_m * scale,
            step_height_m: Self::G1.step_height_m * scale,
            // Sums of differences, so that the G1's own come out to the last digit.
            foot_offset_m: Self::G1.foot_offset_m + (own.ankle_offset_m - its.ankle_offset_m),
            pelvis_height_m: Self::G1.pelvis_height_m
                + (own.pelvis_above_hips_m - its.pelvis_above_hips_m)
                + hip_to_ankle_m * (scale - 1.0)
                + (ankle_height_m - Self::G1.ankle_height_m),
            ankle_height_m,
            zmp_ahead_m: Self::G1.zmp_ahead_m * scale,
            ..Self::G1
        }
    }

    /// Refuses numbers that cannot be or that contradict each other.
    ///
    /// # Errors
    /// [`WalkError::Gait`] with the first of them.
    pub fn check(&self) -> Result<(), WalkError> {
        for (name, value, [low, high]) in self.ranges() {
            if !(low <= value && value <= high) {
                return Err(WalkError::Gait {
                    name,
                    value,
                    limit: format!("must lie between {low} and {high}"),
                    remedy: "correct it, in SI units",
                });
            }
        }
        for (name, value, least, other, remedy) in self.orders() {
            if value < least {
                return Err(WalkError::Gait {
                    name,
                    value,
                    limit: format!("must be at least {least} ({other})"),
                    remedy,
                });
            }
        }
        Ok(())
    }

    /// The numbers that differ from those of another gait, each with its name and this gait's value; the foot that
    /// steps first is none.
    #[must_use]
    pub fn unlike(&self, other: &Self) -> Vec<(&'static str, f64)> {
        let both = self.numbers().into_iter().zip(other.numbers());
        both.filter(|(own, other)| own != other)
            .map(|(own, _)| own)
            .collect()
    }

    /// Its numbers, each with its name.
    #[must_use]
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let numbers = self.ranges().into_iter();
        numbers.map(|(name, value, _)| (name, value)).collect()
    }

    /// Wide enough for any biped, narrow enough that nothing overflows.
    fn ranges(&self) -> [Entry; 12] {
        const TIME_S: [f64; 2] = [1e-3, 100.0];
        const LENGTH_M: [f64; 2] = [1e-3, 10.0];
        [
            ("sampling_s", self.sampling_s, [1e-4, 0.1]),
            ("step_length_m", self.step_length_m, LENGTH_M),
            ("step_height_m", self.step_height_m, LENGTH_M),
            ("step_period_s", self.step_period_s, TIME_S),
            ("double_support_s", self.double_support_s, TIME_S),
            ("foot_offset_m", self.foot_offset_m, LENGTH_M),
            ("pelvis_height_m", self.pelvis_height_m, LENGTH_M),
            ("ankle_height_m", self.ankle_height_m, [0.0, 10.0]),
            ("zmp_ahead_m", self.zmp_ahead_m, [-10.0, 10.0]),
            ("standing_before_s", self.standing_before_s, TIME_S),
            ("standing_after_s", self.standing_after_s, TIME_S),
            ("smoothing_step_m", self.smoothing_step_m, [0.01, 1e3]),
        ]
    }

    /// (name, value, least value, where that comes from, remedy).
    fn orders(&self) -> [(&'static str, f64, f64, &'static str, &'static str); 4] {
        [
            (
                "double_support_s",
                self.double_support_s,
                self.sampling_s,
                "sampling_s",
                "lengthen the double support or sample more often",
            ),
            (
                "step_period_s",
                self.step_period_s,
                self.double_support_s + 2.0 * self.sampling_s,
                "double_support_s and two samples of swing",
                "lengthen the period or shorten the double support",
            ),
            (
                "standing_after_s",
                self.standing_after_s,
                self.double_support_s,
                "double_support_s, in which the weight returns to the middle",
                "stand longer after the walk",
            ),
            (
                "pelvis_height_m",
                self.pelvis_height_m,
                self.ankle_height_m + self.step_height_m,
                "ankle_height_m + step_height_m",
                "raise the pelvis or lower the step",
            ),
        ]
    }
}

/// What of a robot decides how it walks.
struct Size {
    /// How far the shorter leg reaches from its hip, m.
    reach_m: f64,
    /// Half the distance between the ankles, m.
    ankle_offset_m: f64,
    /// How far the hips are below the pelvis frame, m.
    pelvis_above_hips_m: f64,
}

impl Size {
    fn of(robot: &Robot) -> Self {
        let q_rad = by_leg(&robot.standing_rad);
        let [left, right] = [LEFT, RIGHT].map(|leg| leg_pose(&robot.legs[leg], &q_rad[leg]));
        let hips_m = [&left, &right].map(|leg| leg.origins_m[0].z);
        Self {
            reach_m: robot.legs.iter().map(reach_m).fold(f64::INFINITY, f64::min),
            ankle_offset_m: 0.5 * (left.ankle_m().y - right.ankle_m().y),
            pelvis_above_hips_m: -0.5 * (hips_m[LEFT] + hips_m[RIGHT]),
        }
    }
}
