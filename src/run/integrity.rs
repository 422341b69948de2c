//! Whether the files of a run are those that it wrote, and whether its campaign names the same files as before.

use super::error::OutputError;
use crate::campaign::Campaign;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Error, ErrorKind};
use std::path::Path;

/// What a file was when it was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Its size.
    pub bytes: u64,
    /// BLAKE3 hash of its content.
    pub blake3: String,
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
        })
    }
}

/// The records of those of some files that are in a directory.
///
/// # Errors
/// If one cannot be read.
pub(super) fn records(
    dir: &Path,
    names: impl IntoIterator<Item = String>,
) -> Result<BTreeMap<String, FileRecord>, OutputError> {
    let mut all = BTreeMap::new();
    for name in names {
        let path = dir.join(&name);
        match FileRecord::of(&path) {
            Ok(record) => {
                all.insert(name, record);
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(source) => return Err(OutputError::Unwritable { path, source }),
        }
    }
    Ok(all)
}

/// Refuses a directory whose files are not those of the records.
///
/// # Errors
/// If one is missing, or was changed.
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
