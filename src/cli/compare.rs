//! `urts-mc compare`: two runs of the same draws, episode by episode.

use super::console::{print, print_json};
use super::exit::{Code, Failure};
use super::junit::{JunitFile, reported};
use clap::Args;
use std::path::{Path, PathBuf};
use urts_mc::report::{comparison, regressions, terminal};
use urts_mc::run::compare::{self, Asked, RunComparison, compare_runs};

#[derive(Debug, Args)]
pub(crate) struct CompareArguments {
    /// Output directory of the run to compare with, "A"
    pub(crate) a: PathBuf,
    /// Output directory of the run that may have become worse, "B"
    pub(crate) b: PathBuf,
    /// Compare a controller of B with another one of A, such as ftc-tuned=ftc;
    /// without it those that are in both. Repeatable
    #[arg(long, value_name = "B=A", verbatim_doc_comment, value_parser = pair)]
    pub(crate) pair: Vec<[String; 2]>,
    /// What has to be proved of the ratio of B's numbers to A's, such as
    /// "rmse position p50 <= 1.05". Repeatable
    #[arg(long, value_name = "LIMIT", verbatim_doc_comment)]
    pub(crate) ratio: Vec<String>,
    /// The same of their difference, such as "failure_rate <= 0.01". Repeatable
    #[arg(long, value_name = "LIMIT")]
    pub(crate) difference: Vec<String>,
    /// Output directory [default: reports/<name of B>-against-<name of A>]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Write a JUnit XML file for CI: pairs and limits as test cases
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// Write even where the output directory holds something else,
    /// and replace the file of --junit
    #[arg(long, verbatim_doc_comment)]
    pub(crate) overwrite: bool,
    /// Print the findings as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing but errors and what --json asks for
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// Two controllers.
fn pair(text: &str) -> Result<[String; 2], String> {
    match text.split_once('=') {
        Some((b, a)) if !b.is_empty() && !a.is_empty() => Ok([b.to_string(), a.to_string()]),
        _ => Err("name a controller of B and one of A, such as ftc-tuned=ftc".to_string()),
    }
}

/// Compares two runs, and fails if the second is worse.
pub(super) fn compare_command(arguments: &CompareArguments) -> Result<Code, Failure> {
    let CompareArguments { a, b, .. } = arguments;
    let out = arguments.out.clone().unwrap_or_else(|| {
        let name = |run: &Path| run.file_name().unwrap_or_default().display().to_string();
        Path::new("reports").join(format!("{}-against-{}", name(b), name(a)))
    });
    let junit = arguments.junit.as_deref();
    let junit = JunitFile::claim(junit, arguments.overwrite, &[a, b, &out])?;
    let found = match arguments.compared(&out) {
        Ok(found) => found,
        Err(failure) => return Err(reported(junit, "compare", failure)),
    };
    if let Some(file) = junit {
        file.write_comparison(&found)?;
    }
    if arguments.json {
        print_json(&found)?;
    } else if !arguments.quiet {
        print(&terminal::comparison(&found, &out))?;
    }
    match regressions(&found) {
        None => Ok(Code::Done),
        Some(worse) => Err(Failure::new(Code::Unmet, worse)),
    }
}

impl CompareArguments {
    /// Compares the runs into a directory.
    fn compared(&self, out: &Path) -> Result<RunComparison, Failure> {
        let dir = compare::claim(out, [&self.a, &self.b], self.overwrite)?;
        let asked = Asked {
            pairs: self.pair.clone(),
            ratios: self.ratio.clone(),
            differences: self.difference.clone(),
        };
        let found = compare_runs(&self.a, &self.b, &asked)?;
        compare::write(&found, &comparison(&found), &dir)?;
        Ok(found)
    }
}
