//! Cells inside polygons.

use crate::mission::plane::Point;
use crate::mission::world::raster::Raster;

/// The cells whose centres lie inside a polygon (even-odd rule): an edge counts for the heights from its lower end,
/// included, to its upper end, excluded, so that a centre level with a corner is counted once.
#[must_use]
pub fn cells_inside(polygon: &[Point], raster: &Raster) -> Vec<bool> {
    let mut inside = vec![false; raster.cells()];
    let next = polygon.iter().cycle().skip(1);
    for (&[x1, y1], &[x2, y2]) in polygon.iter().zip(next) {
        let (low, high) = (y1.min(y2), y1.max(y2));
        for row in 0..raster.rows() {
            let y = raster.centre_m(row * raster.columns())[1];
            if !(low <= y && y < high) {
                continue;
            }
            let crossing = (x2 - x1) * (y - y1) / (y2 - y1) + x1;
            for column in 0..raster.columns() {
                let index = row * raster.columns() + column;
                // All cells on the left of the edge change sides.
                if raster.centre_m(index)[0] >= crossing {
                    break;
                }
                inside[index] = !inside[index];
            }
        }
    }
    inside
}
