//! Images as rasters of grey values.

use crate::mission::plane::Point;
use crate::mission::world::error::WorldError;
use crate::mission::world::raster::Raster;
use image::{ImageError, ImageReader};
use std::path::{Path, PathBuf};

/// An image with one value per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct GreyImage {
    path: PathBuf,
    columns: usize,
    rows: usize,
    grey: Vec<f64>,
}

impl GreyImage {
    /// Reads an image: the grey value of a pixel is the mean of its colour channels, 0 to 255, whatever its opacity.
    ///
    /// # Errors
    /// If the file cannot be read, holds no PNG, PGM, PBM or PPM image, or one of more cells than a map may have.
    pub fn read(path: &Path) -> Result<Self, WorldError> {
        let open = || ImageReader::open(path)?.with_guessed_format();
        let reader = || {
            open().map_err(|source| WorldError::Read {
                path: path.into(),
                source,
            })
        };
        let image = |error: ImageError| WorldError::Image {
            path: path.into(),
            message: error.to_string(),
        };
        let (columns, rows) = reader()?.into_dimensions().map_err(image)?;
        let [columns, rows] =
            [columns, rows].map(|side| usize::try_from(side).unwrap_or(usize::MAX));
        // Sides that no map may have are refused before the pixels take memory.
        Raster::new([columns, rows], 1.0, [0.0; 2]).map_err(|error| error.in_file(path))?;
        let pixels = reader()?.decode().map_err(image)?.into_rgb8();
        let mean = |[r, g, b]: [u8; 3]| (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0;
        let lines: Vec<_> = pixels.rows().collect();
        // The image's first row is at the top, where y is largest.
        let upwards = lines.into_iter().rev();
        let grey = upwards.flat_map(|line| line.map(|pixel| mean(pixel.0)));
        Ok(Self {
            path: path.into(),
            columns,
            rows,
            grey: grey.collect(),
        })
    }

    /// The file that it was read from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The grey values along the rows from the lowest one, 0 to 255.
    #[must_use]
    pub fn grey(&self) -> &[f64] {
        &self.grey
    }

    /// A raster with a cell per pixel.
    ///
    /// # Errors
    /// As [`Raster::new`].
    pub fn raster(&self, resolution_m: f64, origin_m: Point) -> Result<Raster, WorldError> {
        Raster::new([self.columns, self.rows], resolution_m, origin_m)
    }
}

/// The class of terrain of every pixel: the index of its grey value among the values of the classes.
///
/// # Errors
/// If a pixel has a value that no class has.
pub fn classes(image: &GreyImage, classes: &[(String, u8)]) -> Result<Vec<u8>, WorldError> {
    let class = |(index, &grey): (usize, &f64)| {
        // The mean of three equal channels is exact.
        let same = |&(_, value): &(String, u8)| (f64::from(value) - grey).abs() < 1e-9;
        let class = classes.iter().position(same).map(u8::try_from);
        class.and_then(Result::ok).ok_or_else(|| {
            let known = classes
                .iter()
                .map(|(name, value)| format!("{name} = {value}"));
            WorldError::UnlistedTerrain {
                path: image.path.clone(),
                column: index % image.columns,
                row: image.rows - 1 - index / image.columns,
                grey,
                known: known.collect::<Vec<_>>().join(", "),
            }
        })
    };
    image.grey.iter().enumerate().map(class).collect()
}
