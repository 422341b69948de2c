//! A single file that a command writes.

use super::directory::OutputDir;
use super::error::OutputError;
use super::labels::Labels;
use super::sink::part_in;
use crate::results::table::Table;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use tempfile::NamedTempFile;

/// Makes a directory and a file in it, and takes both away again.
fn try_to_write(dir: &Path) -> std::io::Result<()> {
    let absent: Vec<&Path> = dir
        .ancestors()
        .take_while(|dir| !dir.as_os_str().is_empty() && !dir.exists())
        .collect();
    let tried = fs::create_dir_all(dir)
        .and_then(|()| part_in(dir))
        .and_then(NamedTempFile::close);
    // The directories are made again when the first file is written; a run that fails before leaves none behind.
    for dir in absent {
        // One that could not be made cannot be removed either.
        let _ = fs::remove_dir(dir);
    }
    tried
}

/// A single file that may be written.
#[derive(Debug, Clone)]
pub struct OutputFile {
    dir: OutputDir,
    name: String,
}

impl OutputFile {
    /// Finds out whether a file can be written before any work is done; replaces nothing yet.
    ///
    /// # Errors
    /// If it is a directory or another thing that is no file, or its directory cannot be written. Nothing is left
    /// behind then.
    pub fn claim(path: &Path) -> Result<Self, OutputError> {
        let unwritable = |source| OutputError::Unwritable {
            path: path.to_path_buf(),
            source,
        };
        if path.exists() && !path.is_file() {
            return Err(unwritable(std::io::Error::other("it is no file")));
        }
        let name = path
            .file_name()
            .ok_or_else(|| unwritable(ErrorKind::InvalidFilename.into()))?
            .to_string_lossy()
            .into_owned();
        let dir = path
            .parent()
            .filter(|dir| !dir.as_os_str().is_empty())
            .unwrap_or(Path::new("."));
        try_to_write(dir).map_err(unwritable)?;
        Ok(Self {
            dir: OutputDir::existing(dir),
            name,
        })
    }

    /// Whether the directory that is to hold it exists.
    #[must_use]
    pub fn has_place(&self) -> bool {
        self.dir.path().is_dir()
    }

    /// Takes away an earlier file of this name, if there is one.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(&self) -> Result<(), OutputError> {
        self.dir.remove(&self.name)
    }

    /// Writes the file under its name only when it is complete.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, content: &[u8]) -> Result<(), OutputError> {
        self.dir.write(&self.name, content)
    }

    /// As [`OutputFile::write`], a table as Parquet.
    ///
    /// # Errors
    /// If the table cannot be encoded or written.
    pub fn write_parquet(&self, table: &Table, labels: &Labels) -> Result<(), OutputError> {
        self.dir.write_parquet(&self.name, table, labels)
    }
}
