//! `run --shard`, `merge` and `status`: a run by several processes.

use super::arguments::{MergeArguments, RunArguments, StatusArguments};
use super::console::{print, print_json, print_note};
use super::engine::of_threads;
use super::exit::{Code, Failure};
use super::halt::Halt;
use super::progress::ProgressLine;
use std::path::Path;
use urts_mc::campaign::Campaign;
use urts_mc::report::problems::shortcoming;
use urts_mc::report::requirements::unmet;
use urts_mc::report::terminal::{self, Detail};
use urts_mc::report::{Length, report};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::shard::{AskedShard, Shard, Shards, shard_of};
use urts_mc::run::status::Status;
use urts_mc::run::{Extras, Merging, fly_shard, merge, shards_begun};

/// The shard that is asked for, and what the engine calls the first; says what was taken from where.
fn asked(shard: AskedShard, out: &Path, quiet: bool) -> Result<(Shard, Shards), Failure> {
    let begun = shards_begun(out);
    let of = match shard {
        AskedShard::Given(shard) => {
            let first = begun.map_or(1, |own| own.first);
            let of = shard.of();
            return Ok((shard, Shards { of, first }));
        }
        AskedShard::Auto(of) => of,
    };
    let variable = |name: &str| std::env::var(name).ok();
    let found = shard_of(&variable, of, begun);
    let (shard, shards, said) =
        found.map_err(|error| Failure::usage(format!("--shard auto: {error}")))?;
    if !quiet {
        print_note(&said);
    }
    Ok((shard, shards))
}

/// Flies a shard of a campaign's run.
pub(super) fn run_shard(
    arguments: &RunArguments,
    campaign: &Campaign,
    out: &Path,
    shard: AskedShard,
) -> Result<Code, Failure> {
    let quiet = arguments.quiet;
    let options = arguments.engine.options()?;
    let shard = asked(shard, out, quiet)?;
    let halt = Halt::after(arguments.max_time)?;
    let dir = OutputDir::claim_shared(out, campaign, arguments.overwrite)?;
    let extras = Extras {
        allow_mixed: arguments.allow_mixed,
        halt: &|| halt.is_asked(),
        ..Extras::default()
    };
    let shown = ProgressLine::of_run(campaign, quiet);
    let flown = fly_shard(campaign, &options, &dir, shard, extras, &|at| {
        shown.tell(at)
    });
    drop(shown);
    let flown = flown?;
    drop(dir);
    let status = Status::of(out)?;
    if arguments.json {
        print_json(&status)?;
    } else if !quiet {
        flown.notes.iter().for_each(|note| print_note(note));
        print(&terminal::status(&status))?;
    }
    Ok(Code::Done)
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
    if arguments.json {
        print_json(&findings)?;
    } else if !arguments.quiet {
        let detail = match arguments.verbose {
            true => Detail::Everything,
            false => Detail::Screen,
        };
        print(&terminal::findings(&campaign, &findings, out, detail))?;
    }
    if let Some(error) = shortcoming(&findings.manifest, out) {
        return Err(Failure::new(Code::Other, error));
    }
    match unmet(&findings.manifest) {
        None => Ok(Code::Done),
        Some(unmet) => Err(Failure::new(Code::Unmet, unmet)),
    }
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
