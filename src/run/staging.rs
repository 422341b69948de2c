//! Files that replace those of an earlier run in one go: they are written beside them, and take their places only when
//! all of them are whole.

use super::directory::OutputDir;
use super::error::OutputError;
use super::file_names::{A_RUN, ON_THE_WAY};
use super::replacement::take_places;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A run that is being written.
#[derive(Debug)]
pub(crate) struct Staging {
    place: TempDir,
    files: OutputDir,
    target: PathBuf,
}

impl Staging {
    /// Begins a run that is to be in a directory.
    ///
    /// # Errors
    /// If nothing can be written there.
    pub(crate) fn within(target: &OutputDir) -> Result<Self, OutputError> {
        let target = target.path().to_path_buf();
        let made = fs::create_dir_all(&target).and_then(|()| {
            tempfile::Builder::new()
                .prefix(ON_THE_WAY)
                .suffix(A_RUN)
                .tempdir_in(&target)
        });
        let place = made.map_err(|source| OutputError::Unwritable {
            path: target.clone(),
            source,
        })?;
        let files = OutputDir::shown_as(place.path(), &target);
        Ok(Self {
            place,
            files,
            target,
        })
    }

    /// Where the files are written.
    #[must_use]
    pub(crate) fn files(&self) -> &OutputDir {
        &self.files
    }

    /// Puts all files, of which the manifest must be one, into the places of an earlier run's.
    ///
    /// # Errors
    /// If one cannot be moved. What has not been moved is kept, and the next run that claims the directory goes on.
    pub(crate) fn commit(self) -> Result<(), OutputError> {
        let place = self.place.keep();
        take_places(&place, &self.target)
    }
}
