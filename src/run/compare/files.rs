//! The directory of a comparison: its findings, its tables and its pages.

use super::{CompareError, RunComparison};
use crate::results::{comparison_table, fairness_table};
use crate::run::directory::OutputDir;
use crate::run::error::OutputError;
use crate::run::labels::Labels;
use crate::util::json::pretty;
use std::path::{Path, PathBuf};

/// The findings, which are written last.
const FINDINGS: &str = "compare.json";
/// The pages on them.
const PAGES: [&str; 2] = ["compare.html", "compare.md"];
/// The statistics of every pair and on what terms they are.
const TABLES: [&str; 2] = ["comparison", "fairness"];

/// Claims a directory before any work is done: it may be absent, empty, or hold an earlier comparison of the runs in
/// the same two directories; anything else is refused unless `overwrite`.
///
/// # Errors
/// If the directory holds something else or cannot be written. Nothing is left behind then.
pub fn claim(path: &Path, runs: [&PathBuf; 2], overwrite: bool) -> Result<OutputDir, OutputError> {
    let is_own = |name: &str| {
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
        let table = TABLES.contains(&stem) && ["parquet", "csv"].contains(&extension);
        table || name == FINDINGS || PAGES.contains(&name)
    };
    let earlier = std::fs::read_to_string(path.join(FINDINGS)).ok();
    let earlier = earlier.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    let runs = runs.map(|run| run.to_str());
    let what = earlier.and_then(|found| {
        let earlier = ["a", "b"].map(|run| found[run]["path"].as_str());
        let [a, b] = earlier.map(|path| path.unwrap_or("?"));
        (earlier != runs).then(|| format!("a comparison of {b} with {a}"))
    });
    OutputDir::claim_for(path, overwrite, &is_own, what)
}

/// Writes a comparison with its pages, in HTML and in Markdown: the findings are taken away first and written last, so
/// that a directory that has them is whole.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    found: &RunComparison,
    pages: &[String; 2],
    out: &OutputDir,
) -> Result<(), CompareError> {
    out.remove(FINDINGS)?;
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
