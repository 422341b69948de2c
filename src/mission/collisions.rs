//! Closest approaches of motions during an epoch.

use crate::mission::plane::{Point, between, dot, minus, norm};

/// Below it the square of a relative motion's length counts as no motion, m².
const STILL_M2: f64 = 1e-18;

/// Straight motion during an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Where it begins, m.
    pub from_m: Point,
    /// Where it ends, m.
    pub to_m: Point,
}

impl Sweep {
    /// A point that does not move.
    #[must_use]
    pub fn still(at_m: Point) -> Self {
        Self {
            from_m: at_m,
            to_m: at_m,
        }
    }

    /// The least distance of two motions at the same time, m.
    #[must_use]
    pub fn closest_m(&self, other: &Self) -> f64 {
        let (from, to) = (
            minus(self.from_m, other.from_m),
            minus(self.to_m, other.to_m),
        );
        let way = minus(to, from);
        let square = dot(way, way);
        let share = if square < STILL_M2 {
            0.0
        } else {
            (-dot(from, way) / square).clamp(0.0, 1.0)
        };
        norm(between(from, to, share))
    }
}
