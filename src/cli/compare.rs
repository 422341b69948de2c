//! `urts-mc compare`: two runs of the same draws, episode by episode.

use super::console::{print, print_json};
use super::exit::{Code, Failure};
use clap::Args;
use std::path::{Path, PathBuf};
use urts_mc::report::junit::junit_of_comparison;
use urts_mc::report::{comparison, regressions, terminal};
use urts_mc::run::compare::{self, Asked, compare_runs};
use urts_mc::run::directory::OutputFile;

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
    /// Write even where the output directory holds something else
    #[arg(long)]
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
    let dir = compare::claim(&out, arguments.overwrite)?;
    let junit = arguments.junit.as_deref().map(OutputFile::claim);
    let junit = junit.transpose()?;
    let asked = Asked {
        pairs: arguments.pair.clone(),
        ratios: arguments.ratio.clone(),
        differences: arguments.difference.clone(),
    };
    let found = compare_runs(a, b, &asked)?;
    compare::write(&found, &comparison(&found), &dir)?;
    if let Some(file) = junit {
        file.write(junit_of_comparison(&found)?.as_bytes())?;
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
