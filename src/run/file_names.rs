//! The names of the files of a run's directory.

use super::error::REPORTS;
use crate::results::files::RUN_TABLES;
use std::fs;
use std::path::Path;

/// What the names of all that is only on the way begin with.
pub(crate) const ON_THE_WAY: &str = ".urts-mc-";
/// What the name of the folder of a run that is on the way ends with.
pub(super) const A_RUN: &str = ".run";

/// Whether a file is a table that some run writes.
fn is_table(name: &str) -> bool {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    RUN_TABLES.iter().any(|table| table.name == stem) && ["parquet", "csv"].contains(&extension)
}

/// A file of a table that has more rows than one file holds, in the folder that has the table's name.
pub(super) fn piece(number: usize) -> String {
    format!("part-{number:05}.parquet")
}

fn is_piece(name: &str) -> bool {
    let number = name
        .strip_prefix("part-")
        .and_then(|rest| rest.strip_suffix(".parquet"));
    number.is_some_and(|number| number.parse().is_ok_and(|number| piece(number) == name))
}

/// Whether a path is the folder of a large table, with nothing in it but the files of one.
pub(super) fn is_table_folder(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // A link is followed by nobody.
    let is_folder = fs::symlink_metadata(path).is_ok_and(|there| there.is_dir());
    let is_own = |entry: fs::DirEntry| {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        is_file && is_piece(&entry.file_name().to_string_lossy())
    };
    let all_are = |entries: fs::ReadDir| entries.into_iter().all(|entry| entry.is_ok_and(is_own));
    let is_large = is_table(&name) && name.ends_with(".parquet");
    is_folder && is_large && fs::read_dir(path).is_ok_and(all_are)
}

/// Whether a file is the table or a figure of a replay: replay-EPISODE-CONTROLLER.
fn is_replay(name: &str) -> bool {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let of = stem
        .strip_prefix("replay-")
        .and_then(|rest| rest.split_once('-'));
    let of_episode = of.is_some_and(|(episode, _)| episode.parse::<u32>().is_ok());
    of_episode && ["parquet", "html", "svg"].contains(&extension)
}

/// Whether a file is one that belongs to an earlier run alone, so that a new one takes it away.
pub(super) fn is_replaced(name: &str) -> bool {
    is_table(name) || is_replay(name) || REPORTS.contains(&name)
}

/// Whether a file is one that a run writes, beside its manifest.
pub(super) fn is_ours(name: &str) -> bool {
    is_table(name) || is_replay(name) || name == "gains.json" || REPORTS.contains(&name)
}
