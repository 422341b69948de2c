//! `merge` and `status`: what shards have flown.

use super::console::{print, print_json};
use super::engine::of_threads;
use super::exit::{Code, Failure};
use super::progress::ProgressLine;
use super::said::{Said, judged};
use clap::Args;
use std::path::{Path, PathBuf};
use urts_mc::report::terminal;
use urts_mc::report::{Length, report};
use urts_mc::run::status::Status;
use urts_mc::run::{Merging, merge};

#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// Where the shards were flown
    #[arg(required = true, value_name = "DIR")]
    pub(crate) dirs: Vec<PathBuf>,
    /// Output directory [default: the first DIR]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Write even where the output directory holds something else
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Let episodes of several engines or versions stand in one run; the
    /// manifest says which
    #[arg(long, verbatim_doc_comment)]
    pub(crate) allow_mixed: bool,
    /// Write the episode and channel tables as CSV too
    #[arg(long)]
    pub(crate) csv: bool,
    /// Threads; 0 takes all cores. The result is the same
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(..=1024))]
    pub(crate) threads: u16,
    /// Print the findings as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Print more than fits a screen
    #[arg(long)]
    pub(crate) verbose: bool,
    /// Print nothing but errors and what --json asks for
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct StatusArguments {
    /// Output directory of the run
    pub(crate) run: PathBuf,
    /// Print the numbers of the shards that nobody flies, as an array takes
    /// them: 3,5-7
    #[arg(long, verbatim_doc_comment, conflicts_with = "json")]
    pub(crate) missing: bool,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing but errors and what --json asks for; the exit code
    /// says whether episodes are missing
    #[arg(long, short, verbatim_doc_comment)]
    pub(crate) quiet: bool,
}

/// Makes one run of shards.
pub(super) fn merge_command(arguments: &MergeArguments) -> Result<Code, Failure> {
    let first = arguments.dirs.first().map(std::path::PathBuf::as_path);
    let out = arguments.out.as_deref().or(first).unwrap_or(Path::new("."));
    let options = of_threads(arguments.threads);
    let merging = Merging {
        csv: arguments.csv,
        overwrite: arguments.overwrite,
        allow_mixed: arguments.allow_mixed,
    };
    let shown = ProgressLine::of_work("reading parts", arguments.quiet);
    let merged = merge(&arguments.dirs, out, &options, merging, &|at| {
        shown.tell(at)
    });
    drop(shown);
    let (campaign, findings) = merged?;
    report(out, Length::Brief)?;
    let said = Said {
        json: arguments.json,
        quiet: arguments.quiet,
        verbose: arguments.verbose,
    };
    said.print(&campaign, &findings, out)?;
    judged(&findings, out)
}

/// Tells how far a run is.
pub(super) fn status_command(arguments: &StatusArguments) -> Result<Code, Failure> {
    let status = Status::of(&arguments.run)?;
    if arguments.json {
        print_json(&status)?;
    } else if arguments.missing {
        print(&format!("{}\n", status.missing()))?;
    } else if !arguments.quiet {
        print(&terminal::status(&status))?;
    }
    Ok(match status.kept == status.asked || arguments.missing {
        true => Code::Done,
        false => Code::Partial,
    })
}
