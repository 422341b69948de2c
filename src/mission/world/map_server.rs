//! Occupancy maps as the map server of ROS keeps them: an image and its description in YAML.

use crate::mission::world::error::WorldError;
use crate::mission::world::image::GreyImage;
use crate::mission::world::raster::Raster;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// What cells count as whose occupancy is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Unknown {
    /// They are obstacles.
    Occupied,
    /// They are free.
    Free,
}

/// How grey values tell occupancy: with p = (255 - grey) / 255, a cell is occupied above one threshold and free below
/// the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapThresholds {
    /// p = grey / 255 instead.
    pub negate: bool,
    /// Above it a cell is occupied.
    pub occupied: f64,
    /// Below it a cell is free.
    pub free: f64,
    /// What the cells between the two are.
    pub unknown: Unknown,
}

/// Which cells of a raster are occupied.
#[derive(Clone, Debug, PartialEq)]
pub struct OccupancyMap {
    /// The cells.
    pub raster: Raster,
    /// Whether each is occupied, along the rows from the lowest one.
    pub occupied: Vec<bool>,
}

/// The description of a map.
#[derive(Deserialize)]
struct Description {
    image: PathBuf,
    resolution: f64,
    origin: Vec<f64>,
    #[serde(default)]
    negate: Negate,
    occupied_thresh: Option<f64>,
    free_thresh: Option<f64>,
    mode: Option<String>,
}

/// Map servers write a number, people sometimes a word.
#[derive(Deserialize)]
#[serde(untagged)]
enum Negate {
    Number(i64),
    Word(bool),
}

impl Default for Negate {
    fn default() -> Self {
        Self::Word(false)
    }
}

impl MapThresholds {
    /// The map server's thresholds: occupied above 0.65, free below 0.196.
    #[must_use]
    pub fn usual(unknown: Unknown) -> Self {
        Self {
            negate: false,
            occupied: 0.65,
            free: 0.196,
            unknown,
        }
    }

    fn occupies(&self, grey: f64) -> bool {
        let p = if self.negate { grey } else { 255.0 - grey } / 255.0;
        let unknown = self.unknown == Unknown::Occupied;
        p > self.occupied || (unknown && p >= self.free)
    }
}

impl OccupancyMap {
    /// The map of an image.
    ///
    /// # Errors
    /// If the thresholds are not 0 <= free < occupied <= 1.
    pub fn of_image(
        image: &GreyImage,
        raster: Raster,
        thresholds: &MapThresholds,
    ) -> Result<Self, WorldError> {
        let (free, occupied) = (thresholds.free, thresholds.occupied);
        if !(0.0 <= free && free < occupied && occupied <= 1.0) {
            return Err(WorldError::Thresholds { free, occupied });
        }
        let occupied = image.grey().iter().map(|&grey| thresholds.occupies(grey));
        Ok(Self {
            raster,
            occupied: occupied.collect(),
        })
    }

    /// Reads a map from its description; the image's path is relative to it.
    ///
    /// # Errors
    /// If a file cannot be read, the description lacks a key, its mode is not trinary, its origin is turned, its
    /// thresholds contradict each other, or the map has too few or too many cells.
    pub fn read(path: &Path, unknown: Unknown) -> Result<Self, WorldError> {
        let text = std::fs::read_to_string(path).map_err(|source| WorldError::Read {
            path: path.into(),
            source,
        })?;
        let map: Description =
            serde_saphyr::from_str(&text).map_err(|error| WorldError::Syntax {
                path: path.into(),
                message: error
                    .to_string()
                    .lines()
                    .next()
                    .unwrap_or_default()
                    .to_string(),
            })?;
        let refused = |key, value, limit, remedy| WorldError::Key {
            path: path.into(),
            key,
            value,
            limit,
            remedy,
        };
        if map.mode.as_deref().is_some_and(|mode| mode != "trinary") {
            return Err(refused(
                "mode",
                map.mode.unwrap_or_default(),
                "cells are occupied, free or unknown",
                "save the map with mode: trinary",
            ));
        }
        let origin_m = match map.origin[..] {
            [x, y] | [x, y, 0.0] => [x, y],
            _ => {
                return Err(refused(
                    "origin",
                    format!("{:?}", map.origin),
                    "the origin is [x, y, 0]: rows of a map lie along x",
                    "turn the image itself and give the yaw 0",
                ));
            }
        };
        let usual = MapThresholds::usual(unknown);
        let thresholds = MapThresholds {
            negate: match map.negate {
                Negate::Number(number) => number != 0,
                Negate::Word(word) => word,
            },
            occupied: map.occupied_thresh.unwrap_or(usual.occupied),
            free: map.free_thresh.unwrap_or(usual.free),
            unknown,
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let image = GreyImage::read(&folder.join(map.image))?;
        let raster = image.raster(map.resolution, origin_m);
        let raster = raster.map_err(|error| error.in_file(path))?;
        Self::of_image(&image, raster, &thresholds).map_err(|error| error.in_file(path))
    }
}
