//! Connected parts of free space.

use crate::mission::world::raster::Raster;

/// The label of cells that belong to no component.
const NONE: u32 = 0;

/// The connected components of some cells, where cells with a common side are neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    labels: Vec<u32>,
}

impl Components {
    /// The components of the cells for which `belongs` holds.
    #[must_use]
    pub fn of(raster: &Raster, belongs: impl Fn(usize) -> bool) -> Self {
        let columns = raster.columns();
        let mut labels = vec![NONE; raster.cells()];
        let mut label = NONE;
        let mut front = Vec::new();
        for first in 0..raster.cells() {
            if labels[first] != NONE || !belongs(first) {
                continue;
            }
            label += 1;
            labels[first] = label;
            front.push(first);
            while let Some(cell) = front.pop() {
                let column = cell % columns;
                let neighbours = [
                    (column > 0).then(|| cell - 1),
                    (column + 1 < columns).then_some(cell + 1),
                    cell.checked_sub(columns),
                    (cell + columns < raster.cells()).then_some(cell + columns),
                ];
                for neighbour in neighbours.into_iter().flatten() {
                    if labels[neighbour] == NONE && belongs(neighbour) {
                        labels[neighbour] = label;
                        front.push(neighbour);
                    }
                }
            }
        }
        Self { labels }
    }

    /// Whether two cells lie in one component.
    #[must_use]
    pub fn connect(&self, a: usize, b: usize) -> bool {
        let label = |cell: usize| self.labels.get(cell).copied().unwrap_or(NONE);
        label(a) != NONE && label(a) == label(b)
    }

    /// Number of components.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.labels.iter().copied().max().unwrap_or(NONE)
    }
}
