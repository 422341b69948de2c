//! A run in the place of an earlier one, wherever a process may end.

use super::error::{MANIFEST, OutputError};
use super::file_names::{A_RUN, ON_THE_WAY, is_replaced};
use std::ffi::OsString;
use std::fs::{self, File};
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
    let standing = |name: OsString| Some(target.join(name)).filter(|path| path.is_dir());
    let mut all = names(place).into_iter().flatten();
    if let Some(path) = all.find_map(standing) {
        let source = std::io::ErrorKind::IsADirectory.into();
        return Err(OutputError::Unwritable { path, source });
    }
    let moved = || {
        let ready = cleared(place, target)?;
        for name in names(&ready)?.into_iter().filter(|name| name != MANIFEST) {
            fs::rename(ready.join(&name), target.join(&name))?;
        }
        sync(target)?;
        fs::rename(ready.join(MANIFEST), target.join(MANIFEST))?;
        sync(target)?;
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
    sync(place)?;
    remove(&target.join(MANIFEST))?;
    for name in names(target)? {
        if is_replaced(&name.to_string_lossy()) {
            remove(&target.join(name))?;
        }
    }
    let own = name.strip_prefix(ON_THE_WAY).unwrap_or(&name);
    let ready = target.join(format!("{READY}{own}"));
    fs::rename(place, &ready)?;
    sync(target)?;
    Ok(ready)
}

fn names(dir: &Path) -> std::io::Result<Vec<OsString>> {
    let entries = fs::read_dir(dir)?;
    entries.map(|entry| Ok(entry?.file_name())).collect()
}

/// Removes a file that may be absent.
fn remove(path: &Path) -> std::io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Brings the names in a directory to the disk, where directories can be opened.
fn sync(dir: &Path) -> std::io::Result<()> {
    use std::io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(dir)?.sync_all() {
        // Some file systems do this for files alone.
        Err(error) if [InvalidInput, PermissionDenied, Unsupported].contains(&error.kind()) => {
            Ok(())
        }
        synced => synced,
    }
}
