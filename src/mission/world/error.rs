//! What can be wrong with a map.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// A map that cannot be used, and why.
#[derive(Debug, Error)]
pub enum WorldError {
    /// A file cannot be read.
    #[error("{}: cannot be read ({source}); name an existing file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file holds no image of a known format.
    #[error(
        "{}: is no image that can be read ({message}); give a PNG or a PGM, PBM or PPM file",
        path.display()
    )]
    Image {
        /// The file.
        path: PathBuf,
        /// What the decoder says.
        message: String,
    },
    /// The description of a map is not YAML or lacks a key.
    #[error(
        "{}: {message}; a map has the keys image, resolution and origin, and may have negate, occupied_thresh, \
         free_thresh and mode",
        path.display()
    )]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the parser says.
        message: String,
    },
    /// A value of the description breaks a limit.
    #[error("{}: {key} = {value}: {limit}; {remedy}", path.display())]
    Key {
        /// The file.
        path: PathBuf,
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The limit.
        limit: &'static str,
        /// What to write instead.
        remedy: &'static str,
    },
    /// What is wrong with the map of a file.
    #[error("{}: {error}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: Box<WorldError>,
    },
    /// The thresholds of occupancy contradict each other.
    #[error(
        "free_thresh = {free} and occupied_thresh = {occupied}: thresholds are 0 <= free_thresh < occupied_thresh <= 1; the \
         usual values are 0.196 and 0.65"
    )]
    Thresholds {
        /// Below it a cell is free.
        free: f64,
        /// Above it a cell is occupied.
        occupied: f64,
    },
    /// A number breaks a limit.
    #[error("{key} = {value}: {limit}; {remedy}")]
    Number {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// The limit.
        limit: &'static str,
        /// What to write instead.
        remedy: &'static str,
    },
    /// The map has less than two rows or columns of cells.
    #[error(
        "the map has {columns} columns and {rows} rows of cells and needs at least 2 of each; give a larger map or \
         smaller cells"
    )]
    TooSmall {
        /// Cells along x.
        columns: usize,
        /// Cells along y.
        rows: usize,
    },
    /// The map has more cells than memory should hold.
    #[error(
        "the map has {columns} x {rows} cells and may have {limit}; cut it or give it larger cells"
    )]
    TooLarge {
        /// Cells along x.
        columns: usize,
        /// Cells along y.
        rows: usize,
        /// The largest number of cells.
        limit: usize,
    },
    /// A raster does not have the map's size.
    #[error(
        "the {what} has {cells} cells and the map {columns} x {rows}; give both the same columns and rows"
    )]
    OtherSize {
        /// Which one.
        what: &'static str,
        /// Its cells.
        cells: usize,
        /// Cells of the map along x.
        columns: usize,
        /// Cells of the map along y.
        rows: usize,
    },
    /// A grey value of the terrain has no class.
    #[error(
        "{}: column {column}, row {row} from the top has the grey value {grey:.1}, which no class of terrain has \
         ({known}); list it under classes or change the image",
        path.display()
    )]
    UnlistedTerrain {
        /// The file.
        path: PathBuf,
        /// The pixel's column.
        column: usize,
        /// The pixel's row, from the top.
        row: usize,
        /// Its grey value, 0 to 255.
        grey: f64,
        /// The classes with their values.
        known: String,
    },
}

impl WorldError {
    /// The same, with the file in which it is.
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self::In {
            path: path.into(),
            error: Box::new(self),
        }
    }
}
