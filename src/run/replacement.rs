//! A run in the place of an earlier one, wherever a process may end.

use super::error::{MANIFEST, OutputError};
use super::file_names::{A_RUN, ON_THE_WAY, is_replaced, is_table_folder};
use super::sink::sync_names;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// What the name of a run begins with whose predecessor's files are gone, so that only its own are left to be moved.
const READY: &str = ".urts-mc-ready-";

/// Ends what a process could not: moves the files of a run that was whole, and removes those of one that was not.
///
/// # Errors
/// If files cannot be moved or removed.
pub(super) fn recover(target: &Path) -> Result<(), OutputError> {
    let entries = fs::read_dir(target).into_iter().flatten().flatten();
    for entry in entries {
        // A link is followed by nobody.
        let is_dir = entry.file_type().is_ok_and(|kind| kind.is_dir());
        let name = entry.file_name();
        let Some(ready) = is_ready(&name.to_string_lossy()).filter(|_| is_dir) else {
            continue;
        };
        let path = entry.path();
        let ended = match (path.join(MANIFEST).try_exists(), ready) {
            (Ok(true), _) => {
                take_places(&path, target)?;
                Ok(())
            }
            // Its manifest was the last to leave.
            (Ok(false), true) => fs::remove_dir(&path),
            (Ok(false), false) => fs::remove_dir_all(&path),
            (Err(error), _) => Err(error),
        };
        ended.map_err(|source| OutputError::Unwritable { path, source })?;
    }
    Ok(())
}

/// Whether the folder of a run, by its name, has nothing left of an earlier one in its way; none if it is no such
/// folder.
fn is_ready(name: &str) -> Option<bool> {
    let of = |begin: &str| {
        let letters = name.strip_prefix(begin)?.strip_suffix(A_RUN)?;
        letters
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric())
            .then_some(())
    };
    match (of(READY), of(ON_THE_WAY)) {
        (Some(()), _) => Some(true),
        (None, Some(())) => Some(false),
        (None, None) => None,
    }
}

/// Moves files to where they belong, the manifest last: a directory that has it is whole. Wherever this is interrupted,
/// it can be begun again.
///
/// # Errors
/// If a file cannot be replaced; then nothing is.
pub(super) fn take_places(place: &Path, target: &Path) -> Result<(), OutputError> {
    // What cannot be replaced is found before anything is.
    let standing = |name: OsString| {
        let path = target.join(name);
        Some(path).filter(|path| path.is_dir() && !is_table_folder(path))
    };
    let there = names(target).into_iter().flatten();
    let there = there.filter(|name| is_replaced(&name.to_string_lossy()));
    let mut all = names(place).into_iter().flatten().chain(there);
    if let Some(path) = all.find_map(standing) {
        let source = std::io::ErrorKind::IsADirectory.into();
        return Err(OutputError::Unwritable { path, source });
    }
    let moved = || {
        let ready = cleared(place, target)?;
        for name in names(&ready)?.into_iter().filter(|name| name != MANIFEST) {
            fs::rename(ready.join(&name), target.join(&name))?;
        }
        sync_names(target)?;
        fs::rename(ready.join(MANIFEST), target.join(MANIFEST))?;
        sync_names(target)?;
        fs::remove_dir(&ready)
    };
    moved().map_err(|source| OutputError::Unwritable {
        path: target.to_path_buf(),
        source,
    })
}

/// Takes away the files of an earlier run, and gives the new one the name that says so.
fn cleared(place: &Path, target: &Path) -> std::io::Result<PathBuf> {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    if name.starts_with(READY) {
        return Ok(place.to_path_buf());
    }
    sync_names(place)?;
    remove(&target.join(MANIFEST))?;
    for name in names(target)? {
        if is_replaced(&name.to_string_lossy()) {
            remove(&target.join(name))?;
        }
    }
    let own = name.strip_prefix(ON_THE_WAY).unwrap_or(&name);
    let ready = target.join(format!("{READY}{own}"));
    fs::rename(place, &ready)?;
    sync_names(target)?;
    Ok(ready)
}

fn names(dir: &Path) -> std::io::Result<Vec<OsString>> {
    let entries = fs::read_dir(dir)?;
    entries.map(|entry| Ok(entry?.file_name())).collect()
}

/// Removes a file, or the folder of a large table, that may be absent.
fn remove(path: &Path) -> std::io::Result<()> {
    let removed = match is_table_folder(path) {
        true => fs::remove_dir_all(path),
        false => fs::remove_file(path),
    };
    match removed {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
