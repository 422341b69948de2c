//! Shorter ways out of long ones.

use crate::mission::plane::{Point, between, distance};
use crate::mission::planner::segment::Space;

/// The vertices of a way that remain if each is followed by the farthest one that it sees.
pub(super) fn pruned(space: &Space<'_>, way: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = way.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < way.len() {
        let sees = |&to: &usize| to == from + 1 || space.is_free(way[from], way[to]);
        from = (from + 1..way.len()).rev().find(sees).unwrap_or(way.len());
        kept.extend(way.get(from));
    }
    kept
}

/// The way after so many attempts to join two random points of it straight (Geraerts and Overmars, "Creating
/// high-quality paths for motion planning", IJRR 26:845-863, 2007). `units` gives the two numbers of an attempt.
pub(super) fn with_shortcuts(
    space: &Space<'_>,
    mut way: Vec<Point>,
    attempts: u32,
    units: impl Fn(u32) -> [f64; 2],
) -> Vec<Point> {
    for attempt in 0..attempts {
        if way.len() <= 2 {
            break;
        }
        let mut arcs_m = vec![0.0];
        let mut arc_m = 0.0;
        for leg in way.windows(2) {
            arc_m += distance(leg[0], leg[1]);
            arcs_m.push(arc_m);
        }
        let [u, v] = units(attempt).map(|unit| unit * arc_m);
        let (u, v) = if u > v { (v, u) } else { (u, v) };
        let last = way.len() - 2;
        // The leg on which an arc length lies.
        let leg = |arc: f64| arcs_m[1..=last].partition_point(|&end| end <= arc);
        let (first, second) = (leg(u), leg(v));
        if first == second {
            continue;
        }
        let at = |leg: usize, arc: f64| {
            let share = (arc - arcs_m[leg]) / (arcs_m[leg + 1] - arcs_m[leg]);
            between(way[leg], way[leg + 1], share)
        };
        let (a, b) = (at(first, u), at(second, v));
        if space.is_free(a, b) {
            way.splice(first + 1..=second, [a, b]);
        }
    }
    way
}
