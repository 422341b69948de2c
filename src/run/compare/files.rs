//! The directory of a comparison: its findings, its tables and its pages.

use super::{CompareError, RunComparison};
use crate::results::{comparison_table, fairness_table};
use crate::run::directory::OutputDir;
use crate::run::error::OutputError;
use crate::run::labels::Labels;
use crate::run::pretty;
use std::path::Path;

/// The findings, which are written last.
const FINDINGS: &str = "compare.json";
/// The pages on them.
const PAGES: [&str; 2] = ["compare.html", "compare.md"];
/// The statistics of every pair and on what terms they are.
const TABLES: [&str; 2] = ["comparison", "fairness"];

/// Claims a directory before any work is done: it may be absent, empty, or hold an earlier comparison; anything else is
/// refused unless `overwrite`.
///
/// # Errors
/// If the directory holds something else or cannot be written. Nothing is left behind then.
pub fn claim(path: &Path, overwrite: bool) -> Result<OutputDir, OutputError> {
    let is_own = |name: &str| {
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
        let table = TABLES.contains(&stem) && ["parquet", "csv"].contains(&extension);
        table || name == FINDINGS || PAGES.contains(&name)
    };
    OutputDir::claim_for(path, overwrite, &is_own, None)
}

/// Writes a comparison with its pages, in HTML and in Markdown.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    found: &RunComparison,
    pages: &[String; 2],
    out: &OutputDir,
) -> Result<(), CompareError> {
    let tables = [
        comparison_table(&found.campaign, &found.comparisons),
        fairness_table(&found.terms),
    ];
    for (name, table) in TABLES.iter().zip(&tables) {
        let labels = Labels::new(&found.campaign, name);
        out.write_parquet(&format!("{name}.parquet"), table, &labels)?;
        out.write_csv(&format!("{name}.csv"), table)?;
    }
    for (name, page) in PAGES.iter().zip(pages) {
        out.write(name, page.as_bytes())?;
    }
    out.write(FINDINGS, &pretty(found)?)?;
    Ok(())
}
