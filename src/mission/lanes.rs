//! Parallel lanes over a rectangle, and the starts of a team beside them.

use crate::mission::plane::{Point, Rectangle, count, number};

/// How far inside the lower edge of its area an agent starts, m.
const START_INSIDE_M: f64 = 1.0;

/// Goals that sweep a rectangle in lanes along y, up and down in turns: two of each lane.
///
/// There are as few lanes as keep their spacing within `lane_m`, all spaced evenly, the first half a spacing inside; so
/// nothing is left out and nothing is swept twice. The ends lie half a spacing, at most half of `lane_m`, inside.
#[must_use]
pub fn lanes(area: &Rectangle, lane_m: f64) -> Vec<Point> {
    let width_m = area.size_m()[0];
    // A width of whole lanes, up to rounding, has no further one.
    let lanes = count((width_m / lane_m - 1e-9).ceil());
    let spacing_m = width_m / number(lanes);
    let inside_m = spacing_m.min(lane_m) / 2.0;
    let ends = [area.lower_m[1] + inside_m, area.upper_m[1] - inside_m];
    let goals = (0..lanes).flat_map(|lane| {
        let x = area.lower_m[0] + (number(lane) + 0.5) * spacing_m;
        let upwards = lane % 2 == 0;
        let [from, to] = if upwards { ends } else { [ends[1], ends[0]] };
        [[x, from], [x, to]]
    });
    goals.collect()
}

/// Where a team starts that begins at the lower edge of its area, m: the UAV in the middle, each robot in the middle
/// of its strip.
#[must_use]
pub fn starts_below(area: &Rectangle, robots: usize) -> Vec<Point> {
    let middle = |part: &Rectangle| {
        [
            f64::midpoint(part.lower_m[0], part.upper_m[0]),
            part.lower_m[1] + START_INSIDE_M,
        ]
    };
    let strips = (0..robots).map(|robot| area.part(robot, robots));
    let robots = strips.map(|strip| middle(&strip));
    std::iter::once(middle(area)).chain(robots).collect()
}
