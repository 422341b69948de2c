//! The names of the files of a run's directory.

use super::error::REPORTS;
use crate::results::files::RUN_TABLES;

/// What the names of all that is only on the way begin with.
pub(crate) const ON_THE_WAY: &str = ".urts-mc-";
/// What the name of the folder of a run that is on the way ends with.
pub(super) const A_RUN: &str = ".run";

/// Whether a file is a table that some run writes.
fn is_table(name: &str) -> bool {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    RUN_TABLES.iter().any(|table| table.name == stem) && ["parquet", "csv"].contains(&extension)
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
