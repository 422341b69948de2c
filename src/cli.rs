//! The commands.

use crate::failure::{Code, Failure};
use crate::show;
use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeMap;
use std::fs;
use std::io::{IsTerminal, Write, stdout};
use std::path::{Path, PathBuf};
use std::time::Duration;
use urts_mc::backend::cpu::{Precision, Simd};
use urts_mc::backend::gpu::{Tuning, adapters};
use urts_mc::campaign::Campaign;
use urts_mc::flight::{Backend, Settings};
use urts_mc::gains::GainSet;
use urts_mc::output::{OutputDir, OutputError};
use urts_mc::replay::replay;
use urts_mc::run::{Extras, run};
use urts_mc::synthesis::{Preset, synthesize};

/// Monte Carlo robustness of fault-tolerant controllers, pair by pair against PID baselines.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad usage or campaign file; 3 synthesis failed; 4 a [[require]] of the \
campaign does not hold; 1 anything else.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Fly a campaign and write its tables
    Run(RunArguments),
    /// Check a campaign, synthesize its gains and show what would be drawn; flies nothing
    Check(CheckArguments),
    /// Show the gains of a campaign: poles, margins, certificate, checks
    Synthesize(SynthesizeArguments),
    /// Fly one episode of a run again and write its trajectories
    Replay(ReplayArguments),
    /// Tell how many episodes a claim about a failure rate needs
    Plan(PlanArguments),
    /// List the GPUs, and what --backend auto makes of them
    Devices(DevicesArguments),
    /// Print the JSON Schema of the campaign file
    Schema,
}

#[derive(Debug, Args)]
struct Overrides {
    /// The campaign file
    campaign: PathBuf,
    /// Fly this many episodes instead of the campaign's
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    episodes: Option<u32>,
    /// Use this seed instead of the campaign's
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
}

#[derive(Debug, Args)]
struct RunArguments {
    #[command(flatten)]
    overrides: Overrides,
    /// Where to fly: auto takes a hardware GPU if there is one and the CPU otherwise
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// The GPU whose name contains this; the only way to a software one
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Number format of the episode loop; f64 is the reference, on the CPU
    #[arg(long, value_enum, default_value = "f32")]
    precision: PrecisionChoice,
    /// Layout of the CPU's single-precision episodes; the result is the same for avx2 and avx512
    #[arg(long, value_enum, default_value = "auto")]
    simd: SimdChoice,
    /// Fly N random episodes again on the CPU in f64 and fail if they differ [default: 32 on a GPU, 0 on the CPU]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    cross_check: Option<u32>,
    /// Threads; 0 takes all cores. The result does not depend on it
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,
    /// Output directory [default: reports/<name of the campaign>]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write even where the output directory holds another campaign's run or other files
    #[arg(long)]
    overwrite: bool,
    /// Write the episode and channel tables as CSV too
    #[arg(long)]
    csv: bool,
    /// Print the findings as JSON on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct CheckArguments {
    #[command(flatten)]
    overrides: Overrides,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct PlanArguments {
    /// The failure rate to stay below, between 0 and 1
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, value_parser = share)]
    failure_rate: f64,
    /// How sure the claim is to be, between 0 and 1
    #[arg(long, default_value_t = 0.95, allow_negative_numbers = true, value_parser = share)]
    confidence: f64,
    /// Up to how many failures are listed
    #[arg(long, default_value_t = 5, allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(..=1000))]
    failures: u64,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// A number between 0 and 1.
fn share(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_string())?;
    if 0.0 < number && number < 1.0 {
        Ok(number)
    } else {
        Err("must lie between 0 and 1, such as 0.01 for one percent".to_string())
    }
}

#[derive(Debug, Args)]
struct DevicesArguments {
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct SynthesizeArguments {
    /// The campaign file
    #[arg(required_unless_present = "preset")]
    campaign: Option<PathBuf>,
    /// Synthesize a preset instead of a campaign's gains
    #[arg(long, conflicts_with = "campaign", value_parser = ["uav-paper", "uav-physical", "biped-paper"])]
    preset: Option<String>,
    /// Print as JSON, in the format of gains.json
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct ReplayArguments {
    /// Output directory of the run
    run: PathBuf,
    /// Index of the episode, from 0
    #[arg(long, allow_negative_numbers = true)]
    episode: u32,
    /// The controller
    #[arg(long, default_value = "ftc")]
    controller: String,
    /// Seconds between samples, a multiple of the step [default: 0.01, or as near as the step allows]
    #[arg(long, allow_negative_numbers = true)]
    interval: Option<f64>,
    /// The Parquet file to write [default: <run>/replay-<episode>-<controller>.parquet]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace the file that --out names
    #[arg(long)]
    overwrite: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BackendChoice {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PrecisionChoice {
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SimdChoice {
    Auto,
    Scalar,
    Avx2,
    Avx512,
}

/// Carries out a command.
///
/// # Errors
/// Whatever stops it, with the exit code that it means.
pub(crate) fn execute(arguments: Arguments) -> Result<Code, Failure> {
    match arguments.command {
        Command::Run(arguments) => run_command(&arguments),
        Command::Check(arguments) => check_command(&arguments),
        Command::Synthesize(arguments) => synthesize_command(&arguments),
        Command::Replay(arguments) => replay_command(&arguments),
        Command::Plan(arguments) => plan_command(&arguments),
        Command::Devices(arguments) => devices_command(&arguments),
        Command::Schema => {
            print_json(&Campaign::schema())?;
            Ok(Code::Done)
        }
    }
}

impl Overrides {
    fn load(&self) -> Result<Campaign, Failure> {
        let mut campaign = Campaign::load(&self.campaign)?;
        if let Some(episodes) = self.episodes {
            campaign.set_episodes(episodes)?;
        }
        campaign.seed = self.seed.unwrap_or(campaign.seed);
        Ok(campaign)
    }
}

fn run_command(arguments: &RunArguments) -> Result<Code, Failure> {
    let campaign = arguments.overrides.load()?;
    let settings = arguments.settings()?;
    let path = arguments
        .out
        .clone()
        .unwrap_or_else(|| Path::new("reports").join(&campaign.name));
    let out = OutputDir::claim(&path, &campaign, arguments.overwrite)?;
    let extras = Extras {
        csv: arguments.csv,
        cross_check: arguments.cross_check,
    };

    let progress = progress_bar(campaign.episodes);
    let findings = run(&campaign, &settings, &out, extras, &|episodes| {
        progress.inc(u64::from(episodes));
    });
    progress.finish_and_clear();
    let findings = findings?;
    if arguments.json {
        print_json(&show::findings_json(&findings))?;
    } else {
        print(&show::findings(&campaign, &findings, &path))?;
    }
    if let Some(error) = show::shortcoming(&findings, &path) {
        return Err(Failure {
            error: anyhow::Error::msg(error),
            code: Code::Other,
        });
    }
    if findings.unmet.is_empty() {
        Ok(Code::Done)
    } else {
        Err(Failure {
            error: anyhow::Error::msg(show::unmet(&campaign, &findings)),
            code: Code::Unmet,
        })
    }
}

impl RunArguments {
    /// The settings; options that contradict each other are refused.
    fn settings(&self) -> Result<Settings, Failure> {
        let precision = match self.precision {
            PrecisionChoice::F32 => Precision::F32,
            PrecisionChoice::F64 => Precision::F64,
        };
        let simd = match self.simd {
            SimdChoice::Auto => None,
            SimdChoice::Scalar => Some(Simd::Scalar),
            SimdChoice::Avx2 => Some(Simd::Avx2),
            SimdChoice::Avx512 => Some(Simd::Avx512),
        };
        if let Some(simd) = simd.filter(|simd| !simd.is_available()) {
            let name = format!("{simd:?}").to_lowercase();
            return Err(Failure::usage(format!(
                "--simd {name}: this processor lacks it; use auto"
            )));
        }
        let backend = match (self.backend, &self.adapter) {
            (BackendChoice::Gpu, adapter) => Backend::Gpu {
                adapter: adapter.clone(),
            },
            (_, Some(name)) => {
                return Err(Failure::usage(format!(
                    "--adapter {name}: only a GPU has adapters; add --backend gpu"
                )));
            }
            (BackendChoice::Auto, None) => Backend::Auto,
            (BackendChoice::Cpu, None) => Backend::Cpu,
        };
        if self.backend == BackendChoice::Gpu && precision == Precision::F64 {
            return Err(Failure::usage(
                "--precision f64: the shaders are in single precision; use --backend cpu".into(),
            ));
        }
        if self.backend == BackendChoice::Gpu && simd.is_some() {
            return Err(Failure::usage(
                "--simd: lays out the episodes of the CPU; use --backend cpu".into(),
            ));
        }
        if precision == Precision::F64 && self.cross_check.is_some_and(|count| count > 0) {
            return Err(Failure::usage(
                "--cross-check: compares with f64, which this run is; leave it out".into(),
            ));
        }
        Ok(Settings {
            backend,
            precision,
            simd,
            threads: usize::from(self.threads),
            tuning: Tuning::default(),
        })
    }
}

fn plan_command(arguments: &PlanArguments) -> Result<Code, Failure> {
    let PlanArguments {
        failure_rate,
        confidence,
        failures,
        json,
    } = *arguments;
    if json {
        print_json(&show::runs_json(failure_rate, confidence, failures))?;
    } else {
        print(&show::runs(failure_rate, confidence, failures))?;
    }
    Ok(Code::Done)
}

fn devices_command(arguments: &DevicesArguments) -> Result<Code, Failure> {
    let adapters = adapters();
    if arguments.json {
        print_json(&adapters)?;
    } else {
        print(&show::devices(&adapters, Simd::widest()))?;
    }
    Ok(Code::Done)
}

/// A bar with rate and time left, on a terminal only.
fn progress_bar(episodes: u32) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::with_draw_target(
            Some(u64::from(episodes)),
            ProgressDrawTarget::hidden(),
        );
    }
    let bar = ProgressBar::new(u64::from(episodes));
    let template = "{bar:32} {human_pos}/{human_len} episodes  {per_sec}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn check_command(arguments: &CheckArguments) -> Result<Code, Failure> {
    let campaign = arguments.overrides.load()?;
    let gains = GainSet::obtain(&campaign)?;
    if arguments.json {
        print_json(&show::plan_json(&campaign))?;
    } else {
        print(&show::plan(&campaign, &gains))?;
    }
    Ok(Code::Done)
}

fn synthesize_command(arguments: &SynthesizeArguments) -> Result<Code, Failure> {
    let Some(path) = &arguments.campaign else {
        return synthesize_preset(arguments);
    };
    let campaign = Campaign::load(path)?;
    let gains = GainSet::obtain(&campaign)?;
    if arguments.json {
        print_json(&gains.to_file(&campaign))?;
    } else {
        print(&show::gains(&campaign, &gains))?;
    }
    Ok(Code::Done)
}

fn synthesize_preset(arguments: &SynthesizeArguments) -> Result<Code, Failure> {
    let preset = Preset::ALL
        .into_iter()
        .find(|known| Some(known.name()) == arguments.preset.as_deref());
    let mut done = Vec::new();
    for (role, design) in preset.map(Preset::designs).unwrap_or_default() {
        let synthesis = synthesize(&design).map_err(|error| Failure {
            error: error.into(),
            code: Code::Synthesis,
        })?;
        done.push((role.name(), synthesis));
    }
    if arguments.json {
        print_json(&done.into_iter().collect::<BTreeMap<_, _>>())?;
    } else {
        for (role, synthesis) in &done {
            print(&show::synthesis(role, synthesis))?;
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
    } = arguments;
    if let Some(out) = out.as_ref().filter(|out| out.exists() && !overwrite) {
        return Err(Failure::usage(format!(
            "--out {}: exists already; give another file, or replace it with --overwrite",
            out.display()
        )));
    }
    let replayed = replay(run, *episode, controller, *interval)?;
    let path = out
        .clone()
        .unwrap_or_else(|| run.join(format!("replay-{episode}-{controller}.parquet")));
    let name = path.file_name().map_or_else(
        || "replay.parquet".into(),
        |name| name.to_string_lossy().into_owned(),
    );
    let dir = path
        .parent()
        .filter(|dir| !dir.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    fs::create_dir_all(dir).map_err(|source| OutputError::Unwritable {
        path: dir.to_path_buf(),
        source,
    })?;
    OutputDir::existing(dir).write_parquet(&name, &replayed.table())?;
    print(&show::replay(&replayed, *episode, controller, &path))?;
    Ok(Code::Done)
}

fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Prints to standard output; a reader that went away is not an error.
fn print(text: &str) -> Result<(), Failure> {
    match stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
