//! `run --shard`: a run by several processes.

use super::arguments::RunArguments;
use super::console::{print, print_json, print_note};
use super::exit::{Code, Failure};
use super::halt::Halt;
use super::progress::ProgressLine;
use std::path::Path;
use urts_mc::campaign::Campaign;
use urts_mc::report::terminal;
use urts_mc::run::directory::OutputDir;
use urts_mc::run::shard::{AskedShard, Shard, Shards, shard_of};
use urts_mc::run::status::Status;
use urts_mc::run::{Extras, fly_shard, shards_begun};

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
