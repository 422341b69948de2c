//! The folder of the parts in a run's directory: whose they are, and who is flying more of them.

use super::plan::Plan;
use crate::campaign::Campaign;
use crate::run::error::OutputError;
use crate::run::lock::Lock;
use crate::run::shard::{Shard, Shards};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// The folder of the parts in a run's directory.
pub(super) const FOLDER: &str = ".urts-mc-parts";
/// The file that says whose they are.
pub(super) const PLAN: &str = "plan.json";
/// The file that says in how many shards it was begun.
pub(super) const SHARDS: &str = "shards.json";
/// What the name of a part's file begins with, before its number.
pub(super) const PART: &str = "part-";

/// What to do with parts that are there already.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Resume {
    /// Whether to begin anew whatever they are.
    pub(crate) restart: bool,
    /// Whether to begin anew where they are of another run.
    pub(crate) overwrite: bool,
    /// Whether another engine or version may go on.
    pub(crate) allow_mixed: bool,
}

/// What is in the folder of parts.
pub(super) enum Found {
    /// Nothing that is to stay.
    Nothing,
    /// Parts of the run at hand.
    Ours,
}

pub(super) fn judged(
    out: &Path,
    campaign: &Campaign,
    plan: &Plan,
    resume: Resume,
) -> Result<Found, OutputError> {
    let dir = out.join(FOLDER);
    let unfinished = |what: String, remedy| OutputError::Unfinished {
        path: out.to_path_buf(),
        what,
        remedy,
    };
    // A link is followed by nobody.
    match fs::symlink_metadata(&dir) {
        Err(_) => return Ok(Found::Nothing),
        Ok(there) if !there.is_dir() => {
            let source = ErrorKind::NotADirectory.into();
            return Err(OutputError::Unwritable { path: dir, source });
        }
        Ok(_) if resume.restart => return Ok(Found::Nothing),
        Ok(_) => {}
    }
    let Ok(text) = fs::read(dir.join(PLAN)) else {
        // Whoever began it wrote no part.
        return Ok(Found::Nothing);
    };
    const OTHER: &str = "give another directory with --out, or begin anew with --restart";
    let Ok(there) = serde_json::from_slice::<Plan>(&text) else {
        return match resume.overwrite {
            true => Ok(Found::Nothing),
            false => Err(unfinished(
                "what is no plan of this version".to_string(),
                OTHER,
            )),
        };
    };
    match plan.difference(&there, campaign) {
        None => Ok(Found::Ours),
        Some(_) if resume.overwrite => Ok(Found::Nothing),
        Some(what) => Err(unfinished(what, OTHER)),
    }
}

/// The plan of the parts in a directory; none if there is none.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn plan_of(out: &Path) -> Result<Option<Plan>, OutputError> {
    let path = out.join(FOLDER).join(PLAN);
    let Ok(text) = fs::read(&path) else {
        return Ok(None);
    };
    let plan = serde_json::from_slice(&text);
    plan.map(Some).map_err(|error| OutputError::DamagedPart {
        path,
        reason: error.to_string(),
    })
}

/// In how many shards a directory's run was begun, if it was.
#[must_use]
pub fn shards_of(out: &Path) -> Option<Shards> {
    let text = fs::read(out.join(FOLDER).join(SHARDS)).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Who flies a shard of a directory's run, if anybody does.
pub(crate) fn pilot_of(out: &Path, shard: Shard) -> Option<String> {
    Lock::holder_of(&out.join(FOLDER), &lock_of(shard))
}

/// Whether the lock of a shard was left behind.
pub(crate) fn was_left(out: &Path, shard: Shard) -> bool {
    out.join(FOLDER).join(lock_of(shard)).exists() && pilot_of(out, shard).is_none()
}

pub(super) fn lock_of(shard: Shard) -> String {
    format!("shard-{}-of-{}.lock", shard.number(), shard.of())
}
