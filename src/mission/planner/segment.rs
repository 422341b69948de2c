//! Whether straight motions keep clear of obstacles.

use crate::mission::plane::{Disc, Point, between, distance};
use crate::mission::world::World;

/// Around a start that is itself near an obstacle less clearance is enough, m.
const RELAXED_M: f64 = 1.0;
/// By how much less than the start's own, m.
const RELAXED_BY_M: f64 = 1e-3;
/// Least step of a march, m.
const LEAST_STEP_M: f64 = 0.02;

/// Whether a straight motion never has negative excess clearance, m.
///
/// The excess falls by at most 1 m per metre, so that a step as long as the excess leaves nothing out, whatever the
/// length of the motion; steps below 0.02 m are not resolved.
pub fn march(from: Point, to: Point, excess_m: impl Fn(Point) -> f64) -> bool {
    let length_m = distance(from, to);
    if length_m <= 0.0 {
        return excess_m(from) >= 0.0;
    }
    let mut way_m = 0.0;
    loop {
        let excess_m = excess_m(between(from, to, way_m / length_m));
        if excess_m.is_nan() || excess_m < 0.0 {
            return false;
        }
        if way_m >= length_m {
            return true;
        }
        way_m = (way_m + excess_m.max(LEAST_STEP_M)).min(length_m);
    }
}

/// Obstacles, and what a way from a start keeps clear of them.
#[derive(Clone, Copy)]
pub struct Space<'a> {
    world: &'a World,
    discs: &'a [Disc],
    start: Point,
    start_clear_m: f64,
    clearance_m: f64,
}

impl<'a> Space<'a> {
    /// The space of ways that begin at `start` and keep `clearance_m` from the map and from `discs`.
    #[must_use]
    pub fn new(world: &'a World, discs: &'a [Disc], start: Point, clearance_m: f64) -> Self {
        Self {
            start_clear_m: world.clear_m(start, discs),
            world,
            discs,
            start,
            clearance_m,
        }
    }

    /// The same space with another clearance.
    #[must_use]
    pub fn with_clearance(&self, clearance_m: f64) -> Self {
        Self {
            clearance_m,
            ..*self
        }
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// The clearance at a point beyond what it needs, m. Within 1 m of a start that does not have its clearance itself,
    /// a little less than the start's is enough: a robot that stands near an obstacle can leave.
    #[must_use]
    pub fn excess_m(&self, point: Point) -> f64 {
        let relaxed =
            self.start_clear_m < self.clearance_m && distance(point, self.start) <= RELAXED_M;
        let needed_m = if relaxed {
            self.start_clear_m - RELAXED_BY_M
        } else {
            self.clearance_m
        };
        self.world.clear_m(point, self.discs) - needed_m
    }

    /// Whether the straight way between two points keeps clear.
    #[must_use]
    pub fn is_free(&self, from: Point, to: Point) -> bool {
        march(from, to, |point| self.excess_m(point))
    }
}
