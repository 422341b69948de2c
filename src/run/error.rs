//! Why a run cannot be written or read, and the names of its files.

use polars::prelude::PolarsError;
use std::path::PathBuf;
use thiserror::Error;

/// The reports of a run.
pub const REPORTS: [&str; 2] = ["report.html", "report.md"];

/// File name of the manifest, which is written after all tables: a directory that has one holds all episodes that it
/// counts. Only the reports, which are made of the directory, come after it.
pub const MANIFEST: &str = "manifest.json";

/// File name of a run's gains.
pub const GAINS: &str = "gains.json";

/// Why a run cannot be written or read.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The directory cannot be used.
    ///
    /// What would help depends on who asked for it, and is said there.
    #[error("{}: cannot be written ({source})", path.display())]
    Unwritable {
        /// The directory or file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The directory holds something else.
    #[error("{}: holds {what}; give another directory with --out, or replace it with --overwrite", path.display())]
    Taken {
        /// The directory.
        path: PathBuf,
        /// What it holds.
        what: String,
    },
    /// Another process writes into the directory.
    #[error("{}: is being written by {holder}; wait until it has ended, or give another directory with --out", path.display())]
    Busy {
        /// The directory.
        path: PathBuf,
        /// Which process, on which machine.
        holder: String,
    },
    /// The directory does not hold a run, or not a whole one.
    #[error("{}: holds no readable run ({reason}); name the output directory of a finished run", path.display())]
    NoRun {
        /// The directory.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file of a run is not the one that it wrote.
    #[error("{}: is not the file that the run wrote ({reason}); run the campaign again, or bring the file back", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// In what it differs.
        reason: String,
    },
    /// The directory keeps episodes of an unfinished run that cannot be gone on with.
    #[error("{}: keeps the episodes of an unfinished run: {what}; {remedy}", path.display())]
    Unfinished {
        /// The directory.
        path: PathBuf,
        /// Of which run.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A part of an unfinished run is not what was written.
    #[error("{}: {reason}; run the campaign again, which simulates its episodes anew and keeps all others", path.display())]
    DamagedPart {
        /// Its file.
        path: PathBuf,
        /// In what it differs.
        reason: String,
    },
    /// Two directories hold the same episodes of a run with other numbers.
    #[error("{}: is not what {} holds of the same episodes; find out which is right, and merge without the other", path.display(), other.display())]
    Contradiction {
        /// A part.
        path: PathBuf,
        /// The other directory.
        other: PathBuf,
    },
    /// A table cannot be encoded.
    #[error("{}: the table cannot be encoded", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        source: PolarsError,
    },
}

impl OutputError {
    /// Whether a disk takes no more.
    #[must_use]
    pub fn is_full(&self) -> bool {
        use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
        let full = [FileTooLarge, QuotaExceeded, StorageFull];
        matches!(self, Self::Unwritable { source, .. } if full.contains(&source.kind()))
    }

    /// Whether who asked could have known: a disk that fills up while a run is written is no bad usage.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Table { .. } | Self::DamagedPart { .. } | Self::Contradiction { .. } => false,
            Self::Unwritable { .. } => !self.is_full(),
            _ => true,
        }
    }
}
