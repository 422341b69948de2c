//! Where the feet stand and how they swing (paper, section III-B).

use super::course::{Course, Placement};
use super::error::WalkError;
use super::foot::Foot;
use super::gait::Gait;
use super::samples::{MAX_SAMPLES, ROUNDING, count, floor};
use super::spline::Spline;

/// Where a foot stands from a time on. Its position is below the ankle, on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foothold {
    /// The foot.
    pub foot: Foot,
    /// When it comes to stand there, s.
    pub touch_s: f64,
    /// Where.
    pub placement: Placement,
}

/// An ankle frame: upright, turned by the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ankle {
    /// (x, y) and heading.
    pub placement: Placement,
    /// Height above the ground, m.
    pub height_m: f64,
}

/// A foot's way from one foothold to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Swing {
    /// The foot.
    pub foot: Foot,
    /// When it lifts, s.
    pub lift_s: f64,
    /// When it touches, s.
    pub touch_s: f64,
    /// Where it stood.
    pub from: Placement,
    /// Where it comes to stand.
    pub to: Placement,
    /// x, y, height above stance and heading.
    path: Spline<4>,
}

/// The footholds and swings of a walk.
#[derive(Clone, Debug, PartialEq)]
pub struct Feet {
    start: [Placement; 2],
    ankle_height_m: f64,
    swings: Vec<Swing>,
}

impl Feet {
    /// The steps along a course.
    ///
    /// # Errors
    /// [`WalkError::Gait`], [`WalkError::ShorterThanAStep`], [`WalkError::TooLong`],
    /// [`WalkError::FeetTooClose`].
    pub fn new(course: &Course, gait: &Gait) -> Result<Self, WalkError> {
        gait.check()?;
        let (length_m, step_length_m) = (course.length_m(), gait.step_length_m);
        if length_m < step_length_m * (1.0 - ROUNDING) {
            return Err(WalkError::ShorterThanAStep {
                length_m,
                step_length_m,
            });
        }
        let steps = (length_m / step_length_m - ROUNDING).ceil();
        let hold = |foot: Foot, s_m: f64| {
            let center = course.at(s_m);
            center.beside([0.0, foot.side() * gait.foot_offset_m])
        };
        let walking_s = (steps + 1.0) * gait.step_period_s;
        let standing_s = gait.standing_before_s + gait.standing_after_s;
        let samples = (walking_s + standing_s) / gait.sampling_s;
        if samples > f64::from(MAX_SAMPLES) {
            return Err(WalkError::TooLong {
                samples,
                limit: MAX_SAMPLES,
            });
        }
        let start = Foot::BOTH.map(|foot| hold(foot, 0.0));

        let mut stands = start;
        let mut foot = gait.first_foot;
        let mut swings = Vec::new();
        // One swing for every step, and one by which the last foot closes up.
        let mut from_s = gait.standing_before_s;
        for k in 1..=floor(steps) + 1 {
            let to_s = from_s + gait.step_period_s;
            let s_m = length_m * (count(k) / steps).min(1.0);
            let swing = Swing::new(
                foot,
                [from_s + gait.double_support_s, to_s],
                [stands[foot.index()], hold(foot, s_m)],
                gait.step_height_m,
            );
            stands[foot.index()] = swing.to;
            check_distance(&swing, &stands[foot.other().index()], gait)?;
            swings.push(swing);
            foot = foot.other();
            from_s = to_s;
        }
        Ok(Self {
            start,
            ankle_height_m: gait.ankle_height_m,
            swings,
        })
    }

    /// The swings, in their order.
    #[must_use]
    pub fn swings(&self) -> &[Swing] {
        &self.swings
    }

    /// End of the standing after the last swing, s.
    #[must_use]
    pub fn end_s(&self, gait: &Gait) -> f64 {
        let touch_s = self
            .swings
            .last()
            .map_or(gait.standing_before_s, |swing| swing.touch_s);
        touch_s + gait.standing_after_s
    }

    /// The two first footholds, then every foothold in the order of its time.
    #[must_use]
    pub fn footholds(&self) -> Vec<Foothold> {
        let start = Foot::BOTH.map(|foot| Foothold {
            foot,
            touch_s: 0.0,
            placement: self.start[foot.index()],
        });
        let steps = self.swings.iter().map(|swing| Foothold {
            foot: swing.foot,
            touch_s: swing.touch_s,
            placement: swing.to,
        });
        start.into_iter().chain(steps).collect()
    }

    /// The swing of the moment, if a foot is in the air; at its lift and its touch both feet stand.
    #[must_use]
    pub fn swing_at(&self, t_s: f64) -> Option<&Swing> {
        let begun = self.swings.partition_point(|swing| swing.lift_s < t_s);
        let last = self.swings.get(begun.checked_sub(1)?)?;
        (t_s < last.touch_s).then_some(last)
    }

    /// Both ankles at a time, left first.
    #[must_use]
    pub fn ankles_at(&self, t_s: f64) -> [Ankle; 2] {
        let begun = self.swings.partition_point(|swing| swing.lift_s < t_s);
        Foot::BOTH.map(|foot| {
            let mut latest = self.swings[..begun].iter().rev();
            let ankle = match latest.find(|swing| swing.foot == foot) {
                Some(swing) if t_s < swing.touch_s => swing.ankle_at(t_s),
                Some(swing) => Ankle::standing(swing.to),
                None => Ankle::standing(self.start[foot.index()]),
            };
            Ankle {
                height_m: self.ankle_height_m + ankle.height_m,
                ..ankle
            }
        })
    }
}

impl Swing {
    /// A clamped cubic through lift, the raised midpoint and touch: at rest at both ends, so that
    /// the foot neither slides nor dips under the ground where it stands.
    fn new(
        foot: Foot,
        [lift_s, touch_s]: [f64; 2],
        [from, to]: [Placement; 2],
        height_m: f64,
    ) -> Self {
        let flat = |at: Placement| [at.position_m[0], at.position_m[1], 0.0, at.heading_rad];
        let (a, b) = (flat(from), flat(to));
        let mut middle: [f64; 4] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        middle[2] += height_m;
        let middle_s = 0.5 * (lift_s + touch_s);
        Self {
            foot,
            lift_s,
            touch_s,
            from,
            to,
            path: Spline::at_rest([(lift_s, a), (middle_s, middle), (touch_s, b)]),
        }
    }

    /// The ankle during the swing, its height counted from stance.
    fn ankle_at(&self, t_s: f64) -> Ankle {
        let [x, y, height_m, heading_rad] = self.path.value(t_s);
        Ankle {
            placement: Placement {
                position_m: [x, y],
                heading_rad,
            },
            height_m,
        }
    }
}

impl Ankle {
    fn standing(placement: Placement) -> Self {
        Self {
            placement,
            height_m: 0.0,
        }
    }
}

/// The feet must keep half their distance on a straight line, across the direction of either.
fn check_distance(swing: &Swing, other: &Placement, gait: &Gait) -> Result<(), WalkError> {
    let across = |of: &Placement, to: &Placement| of.local(to.position_m)[1];
    let side = swing.foot.side();
    let distance_m = f64::min(
        side * across(other, &swing.to),
        -side * across(&swing.to, other),
    );
    if distance_m < gait.foot_offset_m {
        return Err(WalkError::FeetTooClose {
            t_s: swing.touch_s,
            foot: swing.foot,
            distance_m,
            limit_m: gait.foot_offset_m,
        });
    }
    Ok(())
}
