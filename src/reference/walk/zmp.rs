//! The zero moment point that the walk is planned around, and the polygon it must stay in.

use super::course::Placement;
use super::feet::Feet;
use super::foot::Foot;
use super::gait::Gait;
use crate::agent::robot::Robot;

/// The reference of the zero moment point: linear between its corners, constant outside.
#[derive(Clone, Debug, PartialEq)]
pub struct ZmpReference {
    corners: Vec<(f64, [f64; 2])>,
}

impl ZmpReference {
    /// From midway between the feet, onto each stance foot in turn and back midway; it moves during
    /// double support only.
    #[must_use]
    pub fn new(feet: &Feet, gait: &Gait) -> Self {
        let point = |placement: &Placement| placement.point([gait.zmp_ahead_m, 0.0]);
        let mut stands = feet.ankles_at(0.0).map(|ankle| point(&ankle.placement));
        let mut at = middle(stands);
        let mut corners = vec![(0.0, at)];
        let mut end_s = gait.standing_before_s;
        for swing in feet.swings() {
            corners.push((swing.lift_s - gait.double_support_s, at));
            at = stands[swing.foot.other().index()];
            corners.push((swing.lift_s, at));
            stands[swing.foot.index()] = point(&swing.to);
            end_s = swing.touch_s;
        }
        corners.push((end_s, at));
        corners.push((end_s + gait.double_support_s, middle(stands)));
        Self { corners }
    }

    /// The point at a time, m.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [f64; 2] {
        let right = self
            .corners
            .partition_point(|&(corner_s, _)| corner_s <= t_s);
        let left = right.checked_sub(1).and_then(|left| self.corners.get(left));
        match (left, self.corners.get(right)) {
            (Some(&(a_s, a)), Some(&(b_s, b))) => {
                let weight = (t_s - a_s) / (b_s - a_s);
                std::array::from_fn(|i| a[i] + weight * (b[i] - a[i]))
            }
            (Some(&(_, only)), None) | (None, Some(&(_, only))) => only,
            (None, None) => [0.0; 2],
        }
    }
}

/// Corners of the left sole and of the right one, (ahead, to the left) of their ankles, m; none
/// where the robot has none.
#[must_use]
pub fn soles(robot: &Robot) -> [Vec<[f64; 2]>; 2] {
    [0, 1].map(|leg| {
        let foot = &robot.legs[leg].foot;
        let from_ankle = foot.sole.translation.vector - foot.ankle_offset_m;
        let center = foot.sole.rotation.inverse() * from_ankle;
        let corners = foot.sole_corners_m.iter();
        corners.map(|[x, y]| [center.x + x, center.y + y]).collect()
    })
}

/// Corners of the convex hull of the soles on the ground at a time, counterclockwise, m.
///
/// `soles` as from [`soles`]. Without them there is no polygon.
#[must_use]
pub fn support_polygon(feet: &Feet, soles: &[Vec<[f64; 2]>; 2], t_s: f64) -> Vec<[f64; 2]> {
    let swinging = feet.swing_at(t_s).map(|swing| swing.foot);
    let ankles = feet.ankles_at(t_s);
    let standing = Foot::BOTH
        .into_iter()
        .filter(|&foot| swinging != Some(foot));
    let corners = standing.flat_map(|foot| {
        let placement = ankles[foot.index()].placement;
        let corners = soles[foot.index()].iter();
        corners.map(move |&corner| placement.point(corner))
    });
    convex_hull(corners.collect())
}

/// Distance of a point from the nearest edge of a convex polygon, m: positive inside, infinite without
/// a polygon.
#[must_use]
pub fn margin(polygon: &[[f64; 2]], point: [f64; 2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let distances = polygon.iter().zip(next).map(|(&a, &b)| {
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        cross(a, b, point) / length
    });
    distances.fold(f64::INFINITY, f64::min)
}

fn middle([a, b]: [[f64; 2]; 2]) -> [f64; 2] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

/// Twice the area of a triangle, positive if counterclockwise.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Andrew's monotone chain: the lower side from left to right, then the upper side back.
fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull = half_hull(points.iter());
    hull.extend(half_hull(points.iter().rev()));
    hull
}

/// One side, without its last point, which starts the other side.
fn half_hull<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut side: Vec<[f64; 2]> = Vec::new();
    for &point in points {
        while let [.., a, b] = side[..]
            && cross(a, b, point) <= 0.0
        {
            side.pop();
        }
        side.push(point);
    }
    side.pop();
    side
}
