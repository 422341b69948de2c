//! How long robots walk to a target, from everywhere: Dijkstra's algorithm on coarse cells.

use crate::mission::parameters::{Behaviour, Parameters};
use crate::mission::plane::{Disc, Point, count, distance};
use crate::mission::world::{Raster, World, WorldError};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Side of the coarse cells, m.
const CELL_M: f64 = 1.0;
/// What a cell costs more that is itself blocked and left through a neighbour, ms.
const OUT_OF_BLOCKED_MS: u64 = 1000;

/// Rows and columns from a cell to the eight around it.
const AROUND: [[isize; 2]; 8] = [
    [-1, -1],
    [-1, 0],
    [-1, 1],
    [0, -1],
    [0, 1],
    [1, -1],
    [1, 0],
    [1, 1],
];

/// Coarse cells of a world: which of them are blocked by the map, and how slow robots are in them.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseGrid {
    raster: Raster,
    blocked: Vec<bool>,
    /// ms per m.
    slowness: Vec<f64>,
    radius_m: f64,
}

/// Times from all cells to one target with the obstacles known at the time, ms.
#[derive(Clone, Debug, PartialEq)]
pub struct TravelTimes {
    raster: Raster,
    times_ms: Vec<Option<u64>>,
}

impl CoarseGrid {
    /// The grid of a world.
    ///
    /// # Errors
    /// If the world is less than two cells wide or high.
    pub fn new(world: &World, parameters: &Parameters) -> Result<Self, WorldError> {
        let raster = Raster::covering(&world.area(), CELL_M)?;
        let radius_m = parameters.planner.radius_m;
        let centres = (0..raster.cells()).map(|cell| raster.centre_m(cell));
        let blocked = centres
            .clone()
            .map(|centre| world.clear_m(centre, &[]) < radius_m);
        let epoch_ms = 1000.0 * parameters.epoch_s;
        let slowness =
            centres.map(|centre| epoch_ms / advance_m(&parameters.behaviour, world.class(centre)));
        Ok(Self {
            blocked: blocked.collect(),
            slowness: slowness.collect(),
            raster,
            radius_m,
        })
    }

    /// The grid of free ground on which robots go so fast, m/s; with `blocked` cells.
    ///
    /// # Errors
    /// As [`Raster::new`].
    pub fn uniform(
        cells: [usize; 2],
        blocked: impl Fn(usize) -> bool,
        speed_m_s: f64,
    ) -> Result<Self, WorldError> {
        let raster = Raster::new(cells, CELL_M, [0.0; 2])?;
        Ok(Self {
            blocked: (0..raster.cells()).map(blocked).collect(),
            slowness: vec![1000.0 / speed_m_s; raster.cells()],
            raster,
            radius_m: 0.0,
        })
    }

    /// Its cells.
    #[must_use]
    pub fn raster(&self) -> &Raster {
        &self.raster
    }

    /// Whether the map blocks a cell.
    #[must_use]
    pub fn is_blocked(&self, cell: usize) -> bool {
        self.blocked[cell]
    }

    /// Times to a target past the map and `discs`, over 8 neighbours without cutting corners, in whole ms. The target's
    /// own cell counts as free.
    #[must_use]
    pub fn times_to(&self, target: Point, discs: &[Disc]) -> TravelTimes {
        let cells = 0..self.raster.cells();
        let mut blocked: Vec<bool> = cells.map(|cell| self.is_blocked_by(cell, discs)).collect();
        let goal = self.raster.cell(target);
        blocked[goal] = false;

        let mut times_ms: Vec<Option<u64>> = vec![None; blocked.len()];
        let mut front = BinaryHeap::from([Reverse((0, goal))]);
        // Equal times are taken by index, so that the order never depends on the heap.
        while let Some(Reverse((time_ms, cell))) = front.pop() {
            if times_ms[cell].is_some() {
                continue;
            }
            times_ms[cell] = Some(time_ms);
            for (neighbour, length_m) in self.neighbours(cell, &blocked) {
                if times_ms[neighbour].is_none() {
                    let mean = 0.5 * (self.slowness[cell] + self.slowness[neighbour]);
                    let step_ms = whole_ms(mean * length_m + 0.5);
                    front.push(Reverse((time_ms.saturating_add(step_ms), neighbour)));
                }
            }
        }
        TravelTimes {
            raster: self.raster,
            times_ms,
        }
    }

    fn is_blocked_by(&self, cell: usize, discs: &[Disc]) -> bool {
        let centre = self.raster.centre_m(cell);
        let near = |disc: &Disc| distance(centre, disc.centre_m) - disc.radius_m < self.radius_m;
        self.blocked[cell] || discs.iter().any(near)
    }

    /// Cells that are free and beside a cell, with the distance of their centres, m; a diagonal one only if both cells
    /// beside the diagonal are free.
    fn neighbours(&self, cell: usize, blocked: &[bool]) -> impl Iterator<Item = (usize, f64)> {
        let (columns, rows) = (self.raster.columns(), self.raster.rows());
        let (row, column) = (cell / columns, cell % columns);
        let open = AROUND.map(|[up, right]| {
            let beside_row = row.checked_add_signed(up).filter(|&row| row < rows)?;
            let beside_column = column.checked_add_signed(right);
            let beside_column = beside_column.filter(|&column| column < columns)?;
            let neighbour = beside_row * columns + beside_column;
            let diagonal = up != 0 && right != 0;
            let cuts =
                blocked[row * columns + beside_column] || blocked[beside_row * columns + column];
            if blocked[neighbour] || (diagonal && cuts) {
                return None;
            }
            let sides = if diagonal {
                std::f64::consts::SQRT_2
            } else {
                1.0
            };
            Some((neighbour, sides * CELL_M))
        });
        open.into_iter().flatten()
    }
}

impl TravelTimes {
    /// Time from a place, ms; none if no way leads from there. A place whose cell is blocked is left through the best
    /// cell around it.
    #[must_use]
    pub fn from_ms(&self, place: Point) -> Option<u64> {
        let cell = self.raster.cell(place);
        if let Some(time_ms) = self.times_ms[cell] {
            return Some(time_ms);
        }
        let [column, row] = self.raster.column_and_row(place);
        let rows = row.saturating_sub(1)..=(row + 1).min(self.raster.rows() - 1);
        let times = rows.flat_map(|row| {
            let columns = column.saturating_sub(1)..=(column + 1).min(self.raster.columns() - 1);
            columns.filter_map(move |column| self.times_ms[row * self.raster.columns() + column])
        });
        times.min().map(|time_ms| time_ms + OUT_OF_BLOCKED_MS)
    }

    /// Times from all cells, ms, along the rows.
    #[must_use]
    pub fn all_ms(&self) -> &[Option<u64>] {
        &self.times_ms
    }
}

/// How far a robot goes on a class of terrain in an epoch, m.
fn advance_m(behaviour: &Behaviour, class: u8) -> f64 {
    let index = behaviour.of_class.get(usize::from(class));
    index.map_or(0.0, |&index| behaviour.library.advance_m(index))
}

fn whole_ms(milliseconds: f64) -> u64 {
    u64::try_from(count(milliseconds)).unwrap_or(u64::MAX)
}
