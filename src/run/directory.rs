//! The directory of a run: who may write there, and files that appear whole or not at all.

use super::error::{MANIFEST, OutputError};
use super::file_names::{ON_THE_WAY, is_ours};
use super::integrity::inputs;
use super::labels::Labels;
use super::lock::{LOCK, Lock, NotHeld, Sharing};
use super::manifest::{Manifest, campaign_hash};
use super::replacement::recover;
use super::sink::{Sink, part_in, sync_names};
use super::table_file::TableFile;
use crate::campaign::Campaign;
use crate::results::table::Table;
use polars::prelude::DataFrame;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// A directory that this run may write.
#[derive(Debug, Clone)]
pub struct OutputDir {
    path: PathBuf,
    /// What errors call it.
    shown: PathBuf,
    /// Nobody else writes there while this is held; none of a directory that was not claimed.
    lock: Option<Arc<Lock>>,
}

impl OutputDir {
    /// Claims a directory before any work is done, for as long as the value lives. It may be absent, empty, or hold a
    /// run of the same campaign text and seed with no more episodes; anything else is refused unless `overwrite`. A
    /// run that was whole when its process ended is brought to its place.
    ///
    /// # Errors
    /// If the directory holds something else, is held by another process, or cannot be written. Nothing is left behind
    /// then.
    pub fn claim(path: &Path, campaign: &Campaign, overwrite: bool) -> Result<Self, OutputError> {
        Self::claim_with(path, campaign, overwrite, Sharing::Alone)
    }

    /// The same, which other shards of the run may hold at the same time.
    ///
    /// # Errors
    /// As [`OutputDir::claim`].
    pub fn claim_shared(
        path: &Path,
        campaign: &Campaign,
        overwrite: bool,
    ) -> Result<Self, OutputError> {
        Self::claim_with(path, campaign, overwrite, Sharing::Shared)
    }

    fn claim_with(
        path: &Path,
        campaign: &Campaign,
        overwrite: bool,
        sharing: Sharing,
    ) -> Result<Self, OutputError> {
        let held = Self::hold(path, sharing)?;
        // Where there are no locks, what is there may be somebody's who is still writing it.
        if sharing == Sharing::Alone && held.lock.as_ref().is_some_and(|lock| lock.excludes()) {
            recover(path)?;
        }
        let other = match Manifest::read(path) {
            Ok(run) if run.campaign_blake3 != campaign_hash(campaign) => {
                let what = if run.campaign == campaign.text {
                    "this campaign with other settings"
                } else {
                    "another campaign text"
                };
                Some(format!("a run of {what} ({:?})", run.name))
            }
            Ok(run) if run.seed != campaign.seed || run.episodes > campaign.episodes => Some(
                format!("a run of {} episodes with seed {}", run.episodes, run.seed),
            ),
            Ok(run) => {
                let other = other_files(&run, campaign);
                return held.judged(overwrite, &|_| true, other);
            }
            Err(_) => None,
        };
        // A run that did not end leaves nothing under the names of its files.
        held.judged(overwrite, &|_| false, other)
    }

    /// The same of a directory that may hold files of some names only; `other` is what it holds instead, where that is
    /// known.
    ///
    /// # Errors
    /// As [`OutputDir::claim`].
    pub fn claim_for(
        path: &Path,
        overwrite: bool,
        is_own: &dyn Fn(&str) -> bool,
        other: Option<String>,
    ) -> Result<Self, OutputError> {
        Self::hold(path, Sharing::Alone)?.judged(overwrite, is_own, other)
    }

    /// Claims the directory of a finished run, for files that are made of it: nobody may replace the run meanwhile.
    ///
    /// # Errors
    /// If it is none, is held by another process, or cannot be written.
    pub fn of_run(path: &Path) -> Result<Self, OutputError> {
        Manifest::read(path)?;
        Self::hold(path, Sharing::Alone)
    }

    /// Keeps all others from writing into a directory, or all but those that share it.
    fn hold(path: &Path, sharing: Sharing) -> Result<Self, OutputError> {
        let unwritable = |source| OutputError::Unwritable {
            path: path.to_path_buf(),
            source,
        };
        if path.exists() && !path.is_dir() {
            return Err(unwritable(ErrorKind::NotADirectory.into()));
        }
        match Lock::take(path, LOCK, sharing) {
            Ok(lock) => Ok(Self {
                path: path.to_path_buf(),
                shown: path.to_path_buf(),
                lock: Some(Arc::new(lock)),
            }),
            Err(NotHeld::Taken(holder)) => Err(OutputError::Busy {
                path: path.to_path_buf(),
                holder,
            }),
            Err(NotHeld::Failed(source)) => Err(unwritable(source)),
        }
    }

    /// Refuses a directory that holds something else.
    fn judged(
        self,
        overwrite: bool,
        is_own: &dyn Fn(&str) -> bool,
        other: Option<String>,
    ) -> Result<Self, OutputError> {
        // What cannot be listed may hold anything.
        let entries = fs::read_dir(&self.path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let entries = entries.map_err(|source| OutputError::Unwritable {
            path: self.path.clone(),
            source,
        })?;
        let mut names = entries
            .into_iter()
            .map(|entry| entry.file_name().to_string_lossy().into_owned());
        let foreign = names.any(|name| !name.starts_with(ON_THE_WAY) && !is_own(&name));
        let what = other.or(foreign.then(|| "files, but no finished run".to_string()));
        match what.filter(|_| !overwrite) {
            None => Ok(self),
            Some(what) => Err(OutputError::Taken {
                path: self.path.clone(),
                what,
            }),
        }
    }

    /// A directory that exists already, for an additional file.
    #[must_use]
    pub fn existing(path: &Path) -> Self {
        Self::shown_as(path, path)
    }

    /// The same, which errors call by the name of the directory that its files are for.
    pub(super) fn shown_as(path: &Path, shown: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            shown: shown.to_path_buf(),
            lock: None,
        }
    }

    /// The directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file under its final name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), OutputError> {
        self.write_with(name, |file| file.write_all(content))
    }

    /// Writes a table as Parquet, with labels in its metadata.
    ///
    /// # Errors
    /// If the table cannot be encoded or written.
    pub fn write_parquet(
        &self,
        name: &str,
        table: &Table,
        labels: &Labels,
    ) -> Result<(), OutputError> {
        let frame = self.frame(name, table)?;
        let mut file = self.parquet(name, &frame, labels)?;
        file.write(&frame)?;
        file.finish()
    }

    /// Writes a table as CSV.
    ///
    /// # Errors
    /// If the table cannot be encoded or written.
    pub fn write_csv(&self, name: &str, table: &Table) -> Result<(), OutputError> {
        let frame = self.frame(name, table)?;
        let mut file = self.csv(name)?;
        file.write(&frame)?;
        file.finish()
    }

    /// A folder in it.
    pub(super) fn folder(&self, name: &str) -> Self {
        Self::shown_as(&self.path.join(name), &self.shown.join(name))
    }

    /// Makes a file the first one in a folder of its own name.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub(super) fn make_folder(&self, name: &str, first: &str) -> Result<(), OutputError> {
        let (place, aside) = (self.path.join(name), self.path.join(first));
        let made = fs::rename(&place, &aside)
            .and_then(|()| fs::create_dir(&place))
            .and_then(|()| fs::rename(&aside, place.join(first)));
        made.map_err(|source| OutputError::Unwritable {
            path: self.shown.join(name),
            source,
        })
    }

    /// Brings the names in a folder to the disk.
    ///
    /// # Errors
    /// If that fails.
    pub(super) fn sync_folder(&self, name: &str) -> Result<(), OutputError> {
        let synced = sync_names(&self.path.join(name));
        synced.map_err(|source| OutputError::Unwritable {
            path: self.shown.join(name),
            source,
        })
    }

    /// A table as it is written.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub(super) fn frame(&self, name: &str, table: &Table) -> Result<DataFrame, OutputError> {
        table.to_frame().map_err(|source| OutputError::Table {
            path: self.shown.join(name),
            source,
        })
    }

    /// Begins a table as Parquet, of which the first rows are given.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn parquet(
        &self,
        name: &str,
        first: &DataFrame,
        labels: &Labels,
    ) -> Result<TableFile, OutputError> {
        self.made(name)?;
        TableFile::parquet([&self.path, &self.shown], name, first, labels)
    }

    /// Begins a table as CSV.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn csv(&self, name: &str) -> Result<TableFile, OutputError> {
        self.made(name)?;
        TableFile::csv([&self.path, &self.shown], name)
    }

    /// Makes the directory. The folder of a run that is on the way is there, or somebody took it away.
    fn made(&self, name: &str) -> Result<(), OutputError> {
        let made = match self.path == self.shown {
            true => fs::create_dir_all(&self.path),
            false => Ok(()),
        };
        made.map_err(|source| OutputError::Unwritable {
            path: self.shown.join(name),
            source,
        })
    }

    fn write_with(
        &self,
        name: &str,
        fill: impl FnOnce(&mut Sink) -> std::io::Result<()>,
    ) -> Result<(), OutputError> {
        self.made(name)?;
        let whole = self.path.join(name);
        let written = part_in(&self.path).and_then(|part| {
            let (file, part) = part.into_parts();
            let mut file = Sink::new(file);
            fill(&mut file)?;
            file.finish()?;
            part.persist(&whole).map_err(|error| error.error)
        });
        written.map_err(|source| OutputError::Unwritable {
            path: self.shown.join(name),
            source,
        })
    }

    /// Takes away a file of an earlier time, if there is one: what says that the directory is whole goes first.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), OutputError> {
        remove(self.path.join(name))
    }
}

/// That a run of the same campaign was made with other files than the campaign names now.
fn other_files(run: &Manifest, campaign: &Campaign) -> Option<String> {
    let now = inputs(campaign);
    let differs = |(path, hash): &(&String, &String)| now.get(*path) != Some(*hash);
    let (path, _) = run.inputs.iter().find(differs)?;
    Some(format!("a run of this campaign with another {path}"))
}

/// Removes a file that may be absent.
fn remove(path: PathBuf) -> Result<(), OutputError> {
    match fs::remove_file(&path) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(OutputError::Unwritable { path, source })
        }
        _ => Ok(()),
    }
}

/// Whether a path is that of a file that a run in the directory `out` writes itself, whether they are there yet or not.
#[must_use]
pub fn is_of_run(out: &Path, path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let dir = path.parent().unwrap_or(Path::new(""));
    (is_ours(&name) || name == MANIFEST) && resolved(dir) == resolved(out)
}

/// A directory's real path; what does not exist yet has no links in it, so that `..` is the directory before.
fn resolved(dir: &Path) -> PathBuf {
    let here = std::env::current_dir().unwrap_or_default();
    let whole = here.join(dir);
    let there = whole.ancestors().find_map(|dir| {
        let rest = whole.strip_prefix(dir).unwrap_or(Path::new(""));
        Some((dir.canonicalize().ok()?, rest))
    });
    let (mut real, rest) = there.unwrap_or((PathBuf::new(), &whole));
    for part in rest.components() {
        if part == Component::ParentDir {
            real.pop();
        } else {
            real.push(part);
        }
    }
    real
}
