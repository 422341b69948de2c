//! How much of the free ground has been in somebody's range.

use crate::mission::plane::{Point, distance, number};
use crate::mission::travel_time::CoarseGrid;

/// A centre at just the range is within it, whatever the rounding, m.
const ROUNDING_M: f64 = 1e-9;

/// The coarse cells whose centres have been within range of an agent.
#[derive(Clone, Debug)]
pub(crate) struct Coverage {
    seen: Vec<bool>,
    free: usize,
    free_and_seen: usize,
}

impl Coverage {
    pub(crate) fn new(grid: &CoarseGrid) -> Self {
        let cells = grid.raster().cells();
        Self {
            seen: vec![false; cells],
            free: (0..cells).filter(|&cell| !grid.is_blocked(cell)).count(),
            free_and_seen: 0,
        }
    }

    /// Adds what is within range of a place.
    pub(crate) fn look(&mut self, grid: &CoarseGrid, place: Point, range_m: f64) {
        let raster = grid.raster();
        let corner = |sign: f64| place.map(|x| x + sign * range_m);
        let [from, to] = [corner(-1.0), corner(1.0)].map(|corner| raster.column_and_row(corner));
        for row in from[1]..=to[1] {
            for column in from[0]..=to[0] {
                let cell = row * raster.columns() + column;
                if !self.seen[cell]
                    && distance(raster.centre_m(cell), place) <= range_m + ROUNDING_M
                {
                    self.seen[cell] = true;
                    self.free_and_seen += usize::from(!grid.is_blocked(cell));
                }
            }
        }
    }

    /// The share of the free cells that has been seen.
    pub(crate) fn share(&self) -> f64 {
        number(self.free_and_seen) / number(self.free.max(1))
    }
}
