//! The commands.

mod arguments;
mod compare;
mod completions;
mod console;
mod engine;
pub(crate) mod exit;
mod halt;
mod junit;
mod merge;
mod new;
mod options;
mod progress;
mod robot;
mod said;
mod shards;
mod submit;

pub(crate) use arguments::Arguments;
pub(crate) use console::print_error;

use arguments::{
    CheckArguments, Command, DevicesArguments, PlanArguments, ReplayArguments, RunArguments,
    SynthesizeArguments, TuneArguments,
};
use completions::completions;
use console::{print, print_json, print_note};
use exit::{Code, Failure};
use halt::Halt;
use junit::{JunitFile, reported};
use merge::{merge_command, status_command};
use options::Overrides;
use progress::ProgressLine;
use said::{Said, judged};
use shards::run_shard;
use std::collections::BTreeMap;
use std::path::Path;
use urts_mc::backend::cpu::{Precision, Simd};
use urts_mc::backend::gpu::adapters;
use urts_mc::campaign::Campaign;
use urts_mc::campaign::lints::cautions;
use urts_mc::controllers::{FullOrderFile, GainSet, full_order};
use urts_mc::report::paper::{claim_dir, paper};
use urts_mc::report::{Length, columns, columns_chapter, report, terminal, trace, tuning};
use urts_mc::results::can_be_judged;
use urts_mc::results::dictionary::DICTIONARY;
use urts_mc::results::extent::Extent;
use urts_mc::run::directory::OutputDir;
use urts_mc::run::error::OutputError;
use urts_mc::run::output_file::OutputFile;
use urts_mc::run::replay::replay;
use urts_mc::run::replay_files::ReplayFiles;
use urts_mc::run::tune::{self, Structure};
use urts_mc::run::{Extras, Findings, Labels, Progress, run};
use urts_mc::synthesis::{Preset, synthesize};

/// Carries out a command.
///
/// # Errors
/// Whatever stops it, with the exit code that it means.
pub(crate) fn execute(arguments: Arguments) -> Result<Code, Failure> {
    let elsewhere = elsewhere(&arguments.command);
    carry_out(arguments.command).map_err(|failure| failure.of_place(elsewhere))
}

/// What to do where a command cannot write what it has to.
fn elsewhere(command: &Command) -> &'static str {
    match command {
        Command::Report { .. } => {
            "a report stands beside the tables of its run: make their directory writable, or copy it"
        }
        Command::Replay(_) => "give another file with --out",
        Command::Robot(_) => "give another file with --svg",
        _ => "give another directory with --out",
    }
}

fn carry_out(command: Command) -> Result<Code, Failure> {
    match command {
        Command::Run(arguments) => run_command(&arguments),
        Command::New(arguments) => new::new_command(&arguments),
        Command::Merge(arguments) => merge_command(&arguments),
        Command::Status(arguments) => status_command(&arguments),
        Command::Submit(arguments) => submit::submit_command(&arguments),
        Command::Check(arguments) => check_command(&arguments),
        Command::Tune(arguments) => tune_command(&arguments),
        Command::Robot(arguments) => robot::robot_command(&arguments),
        Command::Compare(arguments) => compare::compare_command(&arguments),
        Command::Synthesize(arguments) => synthesize_command(&arguments),
        Command::Replay(arguments) => replay_command(&arguments),
        Command::Report { run, full } => {
            let length = if full { Length::Full } else { Length::Brief };
            let _held = OutputDir::of_run(&run)?;
            report(&run, length)?;
            print(&terminal::report(&run))?;
            Ok(Code::Done)
        }
        Command::Paper { out, overwrite } => {
            let claims = paper(&claim_dir(&out, overwrite)?)?;
            print(&terminal::paper(&claims, &out))?;
            Ok(Code::Done)
        }
        Command::Plan(arguments) => plan_command(&arguments),
        Command::Devices(arguments) => devices_command(&arguments),
        Command::Columns { json: true, .. } => {
            print_json(&DICTIONARY)?;
            Ok(Code::Done)
        }
        Command::Columns { markdown, .. } => {
            print(&if markdown {
                columns_chapter()
            } else {
                columns()
            })?;
            Ok(Code::Done)
        }
        Command::Schema => {
            print_json(&Campaign::schema())?;
            Ok(Code::Done)
        }
        Command::Completions { shell } => {
            print(&completions(shell))?;
            Ok(Code::Done)
        }
    }
}

impl Overrides {
    fn load(&self) -> Result<Campaign, Failure> {
        let campaign = Campaign::load_asked(&self.campaign, &self.set, self.episodes)?;
        let seed = self.seed.unwrap_or(campaign.seed);
        Ok(campaign.with_seed(seed))
    }
}

fn run_command(arguments: &RunArguments) -> Result<Code, Failure> {
    // A stale JUnit file is removed before anything can fail.
    let campaign = match arguments.overrides.load() {
        Ok(campaign) => campaign,
        Err(failure) => {
            let report = arguments.junit(arguments.out.as_deref())?;
            let file = &arguments.overrides.campaign;
            let name = file.file_stem().unwrap_or_default().display().to_string();
            return Err(reported(report, &name, failure));
        }
    };
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| Path::new("reports").join(&campaign.name));
    if let Some(shard) = arguments.shard {
        return run_shard(arguments, &campaign, &out, shard);
    }
    let report = arguments.junit(Some(&out))?;
    let findings = match arguments.simulate(&campaign, &out) {
        Ok(findings) => findings,
        Err(failure) => return Err(reported(report, &campaign.name, failure)),
    };
    let written = report.map_or(Ok(()), |report| report.write(&findings.manifest, &out));
    let said = Said {
        json: arguments.json,
        quiet: arguments.quiet,
        verbose: arguments.verbose,
    };
    said.print(&campaign, &findings, &out)?;
    written?;
    judged(&findings, &out)
}

impl RunArguments {
    /// The file of `--junit`; `out` is the run's directory, if it is known.
    fn junit(&self, out: Option<&Path>) -> Result<Option<JunitFile>, Failure> {
        let runs: Vec<&Path> = out.into_iter().collect();
        JunitFile::claim(self.junit.as_deref(), self.overwrite, &runs)
    }

    /// Simulates a campaign into a directory and writes its report.
    fn simulate(&self, campaign: &Campaign, out: &Path) -> Result<Findings, Failure> {
        let options = self.engine.options()?;
        if options.precision == Precision::F64 && self.cross_check.is_some_and(|count| count > 0) {
            return Err(Failure::usage(
                "--cross-check: compares with f64, which this run is; leave it out".into(),
            ));
        }
        let halt = Halt::after(self.max_time)?;
        let out = OutputDir::claim(out, campaign, self.overwrite)?;
        let extras = Extras {
            csv: self.csv,
            cross_check: self.cross_check,
            restart: self.restart,
            overwrite: self.overwrite,
            allow_mixed: self.allow_mixed,
            halt: &|| halt.is_asked(),
            ..Extras::default()
        };
        if !self.quiet {
            cautions(campaign).iter().for_each(|said| print_note(said));
        }
        let shown = ProgressLine::of_run(campaign, self.quiet);
        let findings = run(campaign, &options, &out, extras, &|at| {
            if let (Progress::Kept(kept), false) = (at, self.quiet)
                && kept > 0
            {
                let asked = campaign.episodes;
                print_note(&format!(
                    "goes on after {kept} of {asked} episodes that are kept in {}",
                    out.path().display()
                ));
            }
            shown.tell(at);
        })?;
        report(out.path(), Length::Brief)?;
        Ok(findings)
    }
}

fn tune_command(arguments: &TuneArguments) -> Result<Code, Failure> {
    let campaign = arguments.overrides.load()?;
    let options = arguments.engine.options()?;
    let asked = tune::asked(&campaign)?;
    let name = &arguments.controller;
    let structure = Structure::named(name)
        .ok_or_else(|| Failure::usage(format!("--controller {name}: unknown")))?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| Path::new("reports").join(format!("{}-tune-{name}", campaign.name)));
    let dir = tune::claim(&out, &campaign, arguments.overwrite)?;
    let shown = ProgressLine::of_search(asked.budget, arguments.quiet);
    let found = tune::tune(&campaign, structure, &options, &|tried, best| {
        shown.tell_best(tried, best);
    });
    drop(shown);
    let found = found?;
    tune::write(&found, &tuning(&found), &dir)?;
    if arguments.json {
        print_json(&tune::json(&found)?)?;
    } else if !arguments.quiet {
        print(&terminal::tuning(&found, &out))?;
    }
    Ok(Code::Done)
}

fn plan_command(arguments: &PlanArguments) -> Result<Code, Failure> {
    let PlanArguments {
        failure_rate,
        confidence,
        failures,
        json,
    } = *arguments;
    if json {
        print_json(&terminal::runs_json(failure_rate, confidence, failures))?;
    } else {
        print(&terminal::runs(failure_rate, confidence, failures))?;
    }
    Ok(Code::Done)
}

fn devices_command(arguments: &DevicesArguments) -> Result<Code, Failure> {
    let adapters = adapters();
    if arguments.json {
        print_json(&adapters)?;
    } else {
        print(&terminal::devices(&adapters, Simd::widest()))?;
    }
    Ok(Code::Done)
}

fn check_command(arguments: &CheckArguments) -> Result<Code, Failure> {
    let campaign = arguments.overrides.load()?;
    let shown = ProgressLine::of_work("synthesizing gains", arguments.quiet);
    let gains = GainSet::of_groups(&campaign);
    drop(shown);
    let gains = gains?;
    can_be_judged(&campaign, &gains)?;
    let extent = Extent::of(&campaign);
    extent.fits_here(&campaign)?;
    if arguments.json {
        print_json(&terminal::plan_json(&campaign, &gains, extent))?;
    } else if !arguments.quiet {
        print(&terminal::plan(&campaign, &gains, extent))?;
    }
    Ok(Code::Done)
}

fn synthesize_command(arguments: &SynthesizeArguments) -> Result<Code, Failure> {
    let Some(path) = &arguments.campaign else {
        return synthesize_preset(arguments);
    };
    let campaign = Campaign::load_with(path, &arguments.set)?;
    if campaign
        .groups()
        .iter()
        .any(|group| !group.sensors.is_empty())
    {
        return synthesize_shared_sensors(&campaign, arguments.json);
    }
    let shown = ProgressLine::of_work("synthesizing gains", false);
    let gains = GainSet::of_groups(&campaign);
    drop(shown);
    let gains = gains?;
    if arguments.json {
        print_json(&GainSet::to_file(&campaign, &gains))?;
    } else {
        print(&terminal::gains(&campaign, &gains))?;
    }
    Ok(Code::Done)
}

/// The controllers of the channels that share sensors, and no others.
fn synthesize_shared_sensors(campaign: &Campaign, json: bool) -> Result<Code, Failure> {
    let shown = ProgressLine::of_work("synthesizing gains of channels that share sensors", false);
    let found: Result<Vec<_>, _> = campaign.groups().iter().map(full_order).collect();
    drop(shown);
    let found = found?;
    if json {
        print_json(&FullOrderFile::of(campaign, &found))?;
    } else {
        print(&terminal::full_order(campaign, &found))?;
    }
    Ok(Code::Done)
}

fn synthesize_preset(arguments: &SynthesizeArguments) -> Result<Code, Failure> {
    let preset = Preset::ALL
        .into_iter()
        .find(|known| Some(known.name()) == arguments.preset.as_deref());
    let shown = ProgressLine::of_work("synthesizing gains", false);
    let mut done = Vec::new();
    for (role, design) in preset.map(Preset::designs).unwrap_or_default() {
        let synthesis = synthesize(&design)?;
        done.push((role.name(), synthesis));
    }
    drop(shown);
    if arguments.json {
        print_json(&done.into_iter().collect::<BTreeMap<_, _>>())?;
    } else {
        for (role, synthesis) in &done {
            print(&terminal::synthesis(role, synthesis))?;
        }
    }
    Ok(Code::Done)
}

fn replay_command(arguments: &ReplayArguments) -> Result<Code, Failure> {
    let ReplayArguments {
        run,
        episode,
        controller,
        interval,
        out,
        overwrite,
        json,
        quiet,
    } = arguments;
    let table = match out {
        Some(out) => out.clone(),
        None => run.join(format!("replay-{episode}-{controller}.parquet")),
    };
    let files = ReplayFiles::beside(table);
    let _held = match (OutputDir::of_run(run), out) {
        (Ok(held), _) => Some(held),
        // A run can be read where nothing can be written.
        (Err(OutputError::Unwritable { .. }), Some(_)) => None,
        (Err(error), _) => return Err(error.into()),
    };
    if out.is_some() {
        files.may_be_written(*overwrite)?;
    }
    let shown = ProgressLine::of_work("simulating the episode again", *quiet);
    let replayed = replay(run, *episode, controller, *interval);
    drop(shown);
    let replayed = replayed?;
    let labels = Labels::new(&replayed.campaign, "replay");
    OutputFile::claim(&files.table)?.write_parquet(&replayed.table(), &labels)?;
    let figures = trace(&replayed);
    OutputFile::claim(&files.page)?.write(figures.html.as_bytes())?;
    OutputFile::claim(&files.picture)?.write(figures.svg.as_bytes())?;
    let shown = (run.as_path(), *episode, controller.as_str());
    if *json {
        print_json(&terminal::replay_json(&replayed, shown, &files))?;
    } else if !quiet {
        print(&terminal::replay(&replayed, shown, &files))?;
    }
    Ok(Code::Done)
}
