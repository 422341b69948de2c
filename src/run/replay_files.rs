//! The files of a replayed episode.

use super::output_file::OutputFile;
use super::replay::ReplayError;
use std::path::{Path, PathBuf};

/// The files of a replay.
pub struct ReplayFiles {
    /// The trajectories, as Parquet.
    pub table: PathBuf,
    /// The figures, as a page.
    pub page: PathBuf,
    /// The essential figure, as SVG.
    pub picture: PathBuf,
}

impl ReplayFiles {
    /// The figures stand beside the table under its name.
    #[must_use]
    pub fn beside(table: PathBuf) -> Self {
        Self {
            page: table.with_extension("html"),
            picture: table.with_extension("svg"),
            table,
        }
    }

    /// Finds out whether files that were asked for with `--out` can be written, before the episode is simulated.
    ///
    /// # Errors
    /// If two of them are one, one is there already and may not be replaced, or the place cannot be written.
    pub fn may_be_written(&self, overwrite: bool) -> Result<(), ReplayError> {
        let refused = |path: &Path, limit: &str, remedy: &str| ReplayError::Usage {
            option: "--out",
            value: path.display().to_string(),
            limit: limit.to_string(),
            remedy: remedy.to_string(),
        };
        let all = [&self.table, &self.page, &self.picture];
        if all[1..].contains(&&self.table) {
            return Err(refused(
                &self.table,
                "names the Parquet file, beside which the figures get .html and .svg",
                "give it the ending .parquet",
            ));
        }
        if let Some(taken) = all.iter().find(|path| path.exists() && !overwrite) {
            return Err(refused(
                taken,
                "exists already",
                "give another file, or replace it with --overwrite",
            ));
        }
        for path in all {
            OutputFile::claim(path)?;
        }
        Ok(())
    }
}
