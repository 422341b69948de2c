//! Whether the files of a run are those that it wrote, and whether its campaign names the same files as before.

use super::error::OutputError;
use crate::campaign::Campaign;
use polars::prelude::{ParquetReader, SerReader};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Error;
use std::path::Path;

/// What a file was when it was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Its size.
    pub bytes: u64,
    /// BLAKE3 hash of its content.
    pub blake3: String,
    /// Rows of a table; none of another file, and in runs of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<usize>,
}

impl FileRecord {
    fn of(path: &Path) -> std::io::Result<Self> {
        let file = File::open(path)?;
        let bytes = file.metadata()?.len();
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(file)?;
        Ok(Self {
            bytes,
            blake3: hasher.finalize().to_hex().to_string(),
            rows: None,
        })
    }

    /// The same, with the rows of a table.
    fn of_new(path: &Path) -> std::io::Result<Self> {
        let mut record = Self::of(path)?;
        if path.extension().is_some_and(|own| own == "parquet") {
            let rows = ParquetReader::new(File::open(path)?).num_rows();
            record.rows = Some(rows.map_err(Error::other)?);
        }
        Ok(record)
    }
}

/// The files that are in a directory under a name, in their order: one, those of a folder, or none.
pub(super) fn files_of(dir: &Path, name: &str) -> std::io::Result<Vec<String>> {
    let path = dir.join(name);
    if !path.is_dir() {
        return Ok(path
            .exists()
            .then(|| name.to_string())
            .into_iter()
            .collect());
    }
    let entries = fs::read_dir(path)?;
    let within = |entry: std::io::Result<fs::DirEntry>| {
        Ok(format!("{name}/{}", entry?.file_name().to_string_lossy()))
    };
    let mut files: Vec<String> = entries.map(within).collect::<std::io::Result<_>>()?;
    files.sort();
    Ok(files)
}

/// The records of those of some files and folders that are in a directory.
///
/// # Errors
/// If one cannot be read.
pub(super) fn records(
    dir: &Path,
    names: impl IntoIterator<Item = String>,
) -> Result<BTreeMap<String, FileRecord>, OutputError> {
    let mut all = BTreeMap::new();
    for name in names {
        let failed = |source| OutputError::Unwritable {
            path: dir.join(&name),
            source,
        };
        for file in files_of(dir, &name).map_err(failed)? {
            let record = FileRecord::of_new(&dir.join(&file)).map_err(failed)?;
            all.insert(file, record);
        }
    }
    Ok(all)
}

/// Refuses a directory whose files are not those of the records.
///
/// # Errors
/// If one is missing, or was changed, or a folder of theirs holds another.
pub(super) fn verify(
    dir: &Path,
    records: &BTreeMap<String, FileRecord>,
) -> Result<(), OutputError> {
    for (name, record) in records {
        let path = dir.join(name);
        let damaged = |reason: String| OutputError::Damaged {
            path: path.clone(),
            reason,
        };
        let found = FileRecord::of(&path).map_err(|error: Error| damaged(format!("{error}")))?;
        if found.bytes != record.bytes {
            let reason = format!("{} bytes, the run wrote {}", found.bytes, record.bytes);
            return Err(damaged(reason));
        }
        if found.blake3 != record.blake3 {
            return Err(damaged("its content was changed".to_string()));
        }
    }
    // Whoever reads a folder as a table reads all of it.
    let folders: BTreeSet<&str> = records
        .keys()
        .filter_map(|name| Some(name.split_once('/')?.0))
        .collect();
    for folder in folders {
        let damaged = |path: &str, reason: String| OutputError::Damaged {
            path: dir.join(path),
            reason,
        };
        let there = files_of(dir, folder).map_err(|error| damaged(folder, error.to_string()))?;
        if let Some(other) = there.iter().find(|name| !records.contains_key(*name)) {
            return Err(damaged(other, "it wrote no such file".to_string()));
        }
    }
    Ok(())
}

/// The hashes of the files that a campaign names, robots and gains, by their paths; a file that cannot be read has none
/// here: what needs it says so.
pub(super) fn inputs(campaign: &Campaign) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for group in campaign.groups() {
        if let Some(robot) = group.agent.file() {
            let hash = blake3::hash(robot.text.as_bytes()).to_hex().to_string();
            all.insert(robot.path.display().to_string(), hash);
        }
        let named = group.synthesis.named.iter().map(|own| &own.gains);
        for path in named.chain(&group.synthesis.gains) {
            if let Ok(record) = FileRecord::of(path) {
                all.insert(path.display().to_string(), record.blake3);
            }
        }
    }
    all
}
