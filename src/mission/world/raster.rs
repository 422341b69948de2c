//! Where the cells of a raster lie in the plane.

use crate::mission::plane::{Point, Rectangle, count, number};
use crate::mission::world::error::WorldError;

/// Most cells of a map: bounds memory.
const MOST_CELLS: usize = 16_000_000;
/// A distance is interpolated between the centres of neighbouring cells.
const LEAST_SIDE: usize = 2;

/// Square cells in rows along x; row 0 has the smallest y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    columns: usize,
    rows: usize,
    resolution_m: f64,
    origin_m: Point,
}

impl Raster {
    /// Columns and rows of cells with sides of `resolution_m`; `origin_m` is the lower left corner of the first one.
    ///
    /// # Errors
    /// If there are fewer than 2 columns or rows or more than 16 million cells, the resolution is not positive and
    /// finite, or the origin is not finite.
    pub fn new(
        [columns, rows]: [usize; 2],
        resolution_m: f64,
        origin_m: Point,
    ) -> Result<Self, WorldError> {
        if columns.min(rows) < LEAST_SIDE {
            return Err(WorldError::TooSmall { columns, rows });
        }
        if columns.saturating_mul(rows) > MOST_CELLS {
            return Err(WorldError::TooLarge {
                columns,
                rows,
                limit: MOST_CELLS,
            });
        }
        if !(resolution_m > 0.0 && resolution_m.is_finite()) {
            return Err(WorldError::Number {
                key: "resolution_m",
                value: resolution_m,
                limit: "the side of a cell is a positive length",
                remedy: "give it in m, such as 0.25",
            });
        }
        if let Some(&value) = origin_m.iter().find(|x| !x.is_finite()) {
            return Err(WorldError::Number {
                key: "origin_m",
                value,
                limit: "the corner of the map lies at finite coordinates",
                remedy: "give (x, y) in m",
            });
        }
        Ok(Self {
            columns,
            rows,
            resolution_m,
            origin_m,
        })
    }

    /// The raster that covers `area` with cells of `resolution_m`.
    ///
    /// # Errors
    /// As [`Raster::new`].
    pub fn covering(area: &Rectangle, resolution_m: f64) -> Result<Self, WorldError> {
        let size = area.size_m();
        // An area of whole cells, up to the rounding of its size, has no further row of them.
        let cells = size.map(|size| count((size / resolution_m - 1e-9).ceil()));
        Self::new(cells, resolution_m, area.lower_m)
    }

    /// Cells along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Side of a cell, m.
    #[must_use]
    pub fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// What the raster covers.
    #[must_use]
    pub fn area(&self) -> Rectangle {
        let size = [self.columns, self.rows].map(|cells| number(cells) * self.resolution_m);
        Rectangle {
            lower_m: self.origin_m,
            upper_m: [self.origin_m[0] + size[0], self.origin_m[1] + size[1]],
        }
    }

    /// Centre of the cell with an index, m. Cells are counted along the rows.
    #[must_use]
    pub fn centre_m(&self, index: usize) -> Point {
        let (row, column) = (index / self.columns, index % self.columns);
        [
            self.origin_m[0] + (number(column) + 0.5) * self.resolution_m,
            self.origin_m[1] + (number(row) + 0.5) * self.resolution_m,
        ]
    }

    /// Index of the cell in which a point lies, or of the nearest one.
    #[must_use]
    pub fn cell(&self, point: Point) -> usize {
        let [column, row] = self.column_and_row(point);
        row * self.columns + column
    }

    /// Column and row of the cell in which a point lies, or of the nearest one.
    #[must_use]
    pub fn column_and_row(&self, point: Point) -> [usize; 2] {
        let [x, y] = self.in_cells(point).map(count);
        [x.min(self.columns - 1), y.min(self.rows - 1)]
    }

    /// A point in sides of cells from the corner.
    pub(super) fn in_cells(&self, point: Point) -> [f64; 2] {
        [
            (point[0] - self.origin_m[0]) / self.resolution_m,
            (point[1] - self.origin_m[1]) / self.resolution_m,
        ]
    }
}
