//! The world of a mission: which cells are occupied, how far the nearest of them is, what the ground is like.

mod components;
mod distance;
mod error;
mod image;
mod map_server;
mod polygon;
mod raster;

pub use components::Components;
pub use error::WorldError;
pub use image::{GreyImage, classes};
pub use map_server::{MapThresholds, OccupancyMap, Unknown};
pub use polygon::cells_inside;
pub use raster::Raster;

use crate::mission::plane::{Disc, Point, Rectangle, count, distance, number};

/// Half of a cell's diagonal in sides of cells, 1/√2.
pub(crate) const HALF_DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// The clearance of a point outside of the map, m.
const OUTSIDE_M: f64 = -1.0;

/// Occupancy and terrain of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    raster: Raster,
    occupied: Vec<bool>,
    terrain: Vec<u8>,
    /// Of every cell's centre to that of the nearest occupied one, m.
    distance_m: Vec<f64>,
    free: Components,
}

impl World {
    /// The world with these cells occupied and the class of terrain of every cell, both along the rows of the raster.
    ///
    /// # Errors
    /// If the lists are not as long as the raster has cells.
    pub fn new(raster: Raster, occupied: Vec<bool>, terrain: Vec<u8>) -> Result<Self, WorldError> {
        let lists = [("occupancy", occupied.len()), ("terrain", terrain.len())];
        for (what, cells) in lists {
            if cells != raster.cells() {
                return Err(WorldError::OtherSize {
                    what,
                    cells,
                    columns: raster.columns(),
                    rows: raster.rows(),
                });
            }
        }
        Ok(Self {
            distance_m: distance::to_occupied_m(&occupied, &raster),
            free: Components::of(&raster, |cell| !occupied[cell]),
            raster,
            occupied,
            terrain,
        })
    }

    /// Its cells.
    #[must_use]
    pub fn raster(&self) -> &Raster {
        &self.raster
    }

    /// What it covers.
    #[must_use]
    pub fn area(&self) -> Rectangle {
        self.raster.area()
    }

    /// Whether a cell is occupied; cells outside of the map are.
    #[must_use]
    pub fn is_occupied(&self, cell: usize) -> bool {
        self.occupied.get(cell).copied().unwrap_or(true)
    }

    /// The class of terrain at a point, or at the nearest point of the map.
    #[must_use]
    pub fn class(&self, point: Point) -> u8 {
        let cell = self.raster.cell(point);
        self.terrain.get(cell).copied().unwrap_or(0)
    }

    /// The classes of terrain of all cells.
    #[must_use]
    pub fn terrain(&self) -> &[u8] {
        &self.terrain
    }

    /// Distance from a point to the nearest obstacle, m: to the map from below, by the distance to the centre of the
    /// nearest occupied cell, bilinear between the centres of cells, less half of a cell's diagonal; to the discs
    /// exactly. Negative in obstacles, -1 outside of the map.
    ///
    /// Only beside the corner of an occupied cell does the interpolation outweigh what is taken off, by up to 0.15 of a
    /// cell's side.
    #[must_use]
    pub fn clear_m(&self, point: Point, discs: &[Disc]) -> f64 {
        let Some(of_map_m) = self.clear_of_map_m(point) else {
            return OUTSIDE_M;
        };
        let of_disc_m = |disc: &Disc| distance(point, disc.centre_m) - disc.radius_m;
        discs.iter().map(of_disc_m).fold(of_map_m, f64::min)
    }

    /// Whether a way through cells that are not occupied joins two points. Where there is none, there is no path that
    /// keeps clear of the map; where there is one, there may be none.
    #[must_use]
    pub fn joined(&self, a: Point, b: Point) -> bool {
        let cells = [a, b].map(|point| self.raster.cell(point));
        self.free.connect(cells[0], cells[1])
    }

    /// The components of the cells in whose centres the clearance is at least `clearance_m`.
    #[must_use]
    pub fn components(&self, clearance_m: f64) -> Components {
        let less = HALF_DIAGONAL * self.raster.resolution_m();
        Components::of(&self.raster, |cell| {
            self.distance_m[cell] - less >= clearance_m
        })
    }

    fn clear_of_map_m(&self, point: Point) -> Option<f64> {
        let [u, v] = self.raster.in_cells(point);
        let (columns, rows) = (self.raster.columns(), self.raster.rows());
        let inside = |x: f64, cells: usize| (0.0..=number(cells)).contains(&x);
        if !(inside(u, columns) && inside(v, rows)) {
            return None;
        }
        let u = (u - 0.5).clamp(0.0, number(columns - 1));
        let v = (v - 0.5).clamp(0.0, number(rows - 1));
        let (column, row) = (count(u).min(columns - 2), count(v).min(rows - 2));
        let (right, up) = (u - number(column), v - number(row));
        let lower = row * columns + column;
        let upper = lower + columns;
        let at =
            |cell: usize| self.distance_m[cell] * (1.0 - right) + self.distance_m[cell + 1] * right;
        let centres_m = at(lower) * (1.0 - up) + at(upper) * up;
        Some(centres_m - HALF_DIAGONAL * self.raster.resolution_m())
    }
}
