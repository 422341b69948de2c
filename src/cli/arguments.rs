//! The command line: commands, their arguments and examples.

use super::compare::CompareArguments;
use super::halt::duration;
use super::merge::{MergeArguments, StatusArguments};
use super::new::NewArguments;
use super::options::{EngineArguments, Overrides};
use super::robot::RobotArguments;
use super::submit::SubmitArguments;
use clap::builder::{PossibleValuesParser, StyledStr};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;
use std::time::Duration;
use urts_mc::campaign::Setting;
use urts_mc::run::shard::AskedShard;
use urts_mc::run::tune::STRUCTURES;

/// Monte Carlo robustness of fault-tolerant controllers, pair by pair against PID baselines.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, after_help = first_steps())]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad usage or campaign file; 3 synthesis failed;\n\
4 a [[require]] does not hold, or compare finds a regression; 5 the run was asked to\n\
end, and the same command goes on with what is kept; 1 anything else.";

/// The examples of a command's help, one a line; a test runs them all.
fn examples(lines: &[&str]) -> String {
    let header = anstyle::Style::new().bold().underline();
    let mut text = format!("{header}Examples:{header:#}");
    for line in lines {
        text.push_str("\n  ");
        text.push_str(line);
    }
    text
}

fn first_steps() -> StyledStr {
    let examples = examples(&[
        "urts-mc run campaigns/smoke.toml",
        "urts-mc replay reports/smoke --episode 9 --controller pid",
    ]);
    format!("{examples}\n\n{EXIT_CODES}").into()
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a campaign and write its tables and its report
    #[command(after_help = examples(&[
        "urts-mc run campaigns/smoke.toml",
        "urts-mc run campaigns/uav-paper.toml --episodes 256 --backend cpu --out reports/trial",
        "urts-mc run campaigns/smoke.toml --set fault.0.onset_s=0 --set coupling= --out reports/early",
        "urts-mc run campaigns/smoke.toml --quiet --junit reports/smoke.xml",
    ]))]
    Run(RunArguments),
    /// Write a campaign to begin with, from one of the gallery
    #[command(after_help = examples(&[
        "urts-mc new mine --kind uav",
        "urts-mc new walk --from biped-turn",
        "urts-mc new --list",
        "urts-mc run gallery:smoke --out reports/gallery",
    ]))]
    New(NewArguments),
    /// Make one run of the shards that were flown into one directory, or into several
    #[command(after_help = examples(&[
        "urts-mc run campaigns/smoke.toml --out reports/shards --shard 1/2",
        "urts-mc run campaigns/smoke.toml --out reports/shards --shard 2/2",
        "urts-mc merge reports/shards",
    ]))]
    Merge(MergeArguments),
    /// Show how far a run is that is flown in parts, and which shards are missing
    #[command(after_help = examples(&[
        "urts-mc status reports/smoke",
        "urts-mc status reports/smoke --json",
    ]))]
    Status(StatusArguments),
    /// Print what begins the shards of a run on a cluster: for Slurm or Kubernetes
    #[command(after_help = examples(&[
        "urts-mc submit campaigns/uav-paper.toml --episodes 1000000 --slurm 8 --time 4h",
        "urts-mc submit campaigns/uav-paper.toml --kubernetes 8 --image registry/urts-mc:0.1 --backend gpu",
    ]))]
    Submit(SubmitArguments),
    /// Check a campaign, synthesize its gains, show what would be drawn; simulates nothing
    #[command(after_help = examples(&[
        "urts-mc check campaigns/uav-paper.toml",
        "urts-mc check campaigns/uav-paper.toml --episodes 4096 --json",
        "urts-mc check campaigns/smoke.toml --set sampling.design=sobol",
    ]))]
    Check(CheckArguments),
    /// Show what was understood of a robot's file, and whether it can walk
    #[command(after_help = examples(&[
        "urts-mc robot campaigns/robots/g1_12dof.toml",
        "urts-mc robot campaigns/robots/g1_12dof.toml --set reference.gait.step_length_m=0.3 --json",
        "urts-mc robot campaigns/robots/berkeley_humanoid.toml --svg reports/berkeley.svg",
    ]))]
    Robot(RobotArguments),
    /// Search the free parameters of a controller for a campaign's [tune]
    #[command(after_help = examples(&[
        "urts-mc tune campaigns/smoke.toml --controller pid",
        "urts-mc tune campaigns/smoke.toml --controller ftc --set tune.budget=26 --out reports/tuned",
    ]))]
    Tune(TuneArguments),
    /// Show the gains of a campaign: poles, margins, certificate, checks
    #[command(after_help = examples(&[
        "urts-mc synthesize campaigns/uav-paper.toml",
        "urts-mc synthesize --preset biped-paper --json",
    ]))]
    Synthesize(SynthesizeArguments),
    /// Simulate one episode of a run again and write its trajectories
    #[command(after_help = examples(&[
        "urts-mc replay reports/smoke --episode 9 --controller pid",
        "urts-mc replay reports/smoke --episode 3 --interval 0.05 --out episode-3.parquet",
    ]))]
    Replay(ReplayArguments),
    /// Compare two runs of the same draws, episode by episode
    #[command(after_help = examples(&[
        "urts-mc compare reports/smoke reports/smoke",
        "urts-mc compare reports/smoke reports/smoke --pair ftc=pid --ratio 'rmse p50 <= 0.9'",
    ]))]
    Compare(CompareArguments),
    /// Write the report of a run again, from its tables alone
    #[command(after_help = examples(&[
        "urts-mc report reports/smoke",
        "urts-mc report reports/smoke --full",
    ]))]
    Report {
        /// Output directory of the run
        run: PathBuf,
        /// Say everything in report.md, however long; without it it fits into
        /// a comment on a pull request
        #[arg(long, verbatim_doc_comment)]
        full: bool,
    },
    /// Draw the paper's figures again and compare its claims with measurements
    #[command(after_help = examples(&[
        "urts-mc paper --out reports/paper",
    ]))]
    Paper {
        /// Output directory
        #[arg(long, default_value = "reports/paper")]
        out: PathBuf,
        /// Write even where the output directory holds something else
        #[arg(long)]
        overwrite: bool,
    },
    /// Show how many episodes a claim about a failure rate needs
    #[command(after_help = examples(&[
        "urts-mc plan --failure-rate 0.01",
        "urts-mc plan --failure-rate 0.001 --confidence 0.99 --failures 10",
    ]))]
    Plan(PlanArguments),
    /// List the GPUs, and what --backend auto makes of them
    #[command(after_help = examples(&[
        "urts-mc devices",
        "urts-mc devices --json",
    ]))]
    Devices(DevicesArguments),
    /// List the columns of the tables: type, unit, meaning, and when a cell is empty
    #[command(after_help = examples(&[
        "urts-mc columns",
        "urts-mc columns --json",
    ]))]
    Columns {
        /// Print as JSON
        #[arg(long)]
        json: bool,
        /// Print as Markdown, as in the chapter of the documentation
        #[arg(long, conflicts_with = "json")]
        markdown: bool,
    },
    /// Print the JSON Schema of the campaign file
    #[command(after_help = examples(&[
        "urts-mc schema > campaign.schema.json",
    ]))]
    Schema,
    /// Print a script that completes this program's command line in a shell
    #[command(after_help = examples(&[
        "urts-mc completions bash > urts-mc.bash",
        "urts-mc completions fish",
    ]))]
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    #[command(flatten)]
    pub(crate) engine: EngineArguments,
    /// Simulate N random episodes again on the CPU in f64, and fail if they
    /// differ [default: 32 on a GPU, 0 on the CPU]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        verbatim_doc_comment
    )]
    pub(crate) cross_check: Option<u32>,
    /// Output directory [default: reports/<name of the campaign>]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Write even where the output directory holds something else,
    /// and replace the file of --junit
    #[arg(long, verbatim_doc_comment)]
    pub(crate) overwrite: bool,
    /// End soon after this time and keep what was flown, as on SIGINT,
    /// SIGTERM and SIGUSR1; the same command goes on
    #[arg(long, value_name = "3h50m", verbatim_doc_comment, value_parser = duration)]
    pub(crate) max_time: Option<Duration>,
    /// Fly only these parts, beside the processes of the other shards, into
    /// one directory for urts-mc merge: 3/8, or auto as a task of Slurm,
    /// PBS, Grid Engine, Kubernetes or AWS Batch; auto/8 says of how many
    #[arg(long, value_name = "K/N", verbatim_doc_comment, conflicts_with_all = ["restart", "csv", "cross_check", "junit"])]
    pub(crate) shard: Option<AskedShard>,
    /// Begin anew where the output directory keeps episodes of an
    /// unfinished run
    #[arg(long, verbatim_doc_comment)]
    pub(crate) restart: bool,
    /// Go on though another engine or version flew the episodes that are
    /// kept; the manifest says which
    #[arg(long, verbatim_doc_comment)]
    pub(crate) allow_mixed: bool,
    /// Write the episode and channel tables as CSV too
    #[arg(long)]
    pub(crate) csv: bool,
    /// Print the findings as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Write a JUnit file for CI systems: a test case for each [[require]],
    /// the cross-check and the simulation
    #[arg(long, value_name = "FILE", verbatim_doc_comment)]
    pub(crate) junit: Option<PathBuf>,
    /// Print more than fits a screen: pairs, strata, what matters, worst
    /// episodes, times
    #[arg(long, verbatim_doc_comment)]
    pub(crate) verbose: bool,
    /// Print nothing but errors and what --json asks for
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TuneArguments {
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// What is tuned: its free parameters are searched, whether the campaign
    /// names it or not
    #[arg(long, value_name = "NAME", verbatim_doc_comment, value_parser = PossibleValuesParser::new(STRUCTURES.iter().map(|own| own.name)))]
    pub(crate) controller: String,
    #[command(flatten)]
    pub(crate) engine: EngineArguments,
    /// Output directory [default: reports/<name of the campaign>-tune-<NAME>]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
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

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing but errors and what --json asks for
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    /// The failure rate to stay below, between 0 and 1
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, value_parser = rate)]
    pub(crate) failure_rate: f64,
    /// How sure the claim is to be, between 0 and 1
    #[arg(long, default_value_t = 0.95, allow_negative_numbers = true, value_parser = confidence)]
    pub(crate) confidence: f64,
    /// Up to how many failures are listed
    #[arg(long, default_value_t = 5, allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(..=1000))]
    pub(crate) failures: u64,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// A rate of failures.
fn rate(text: &str) -> Result<f64, String> {
    share(text, "0.01 for one percent")
}

/// How sure something is to be.
fn confidence(text: &str) -> Result<f64, String> {
    share(text, "0.95 for 95 percent")
}

/// A number between 0 and 1.
fn share(text: &str, example: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_string())?;
    if 0.0 < number && number < 1.0 {
        Ok(number)
    } else {
        Err(format!("must lie between 0 and 1, such as {example}"))
    }
}

#[derive(Debug, Args)]
pub(crate) struct DevicesArguments {
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SynthesizeArguments {
    /// The campaign file
    #[arg(required_unless_present = "preset")]
    pub(crate) campaign: Option<PathBuf>,
    /// Synthesize a preset instead of a campaign's
    /// gains
    #[arg(long, value_name = "NAME", verbatim_doc_comment, conflicts_with = "campaign", value_parser = ["uav-paper", "uav-physical", "biped-paper"])]
    pub(crate) preset: Option<String>,
    /// Set a key of the campaign to a TOML value; without
    /// a value, remove it. Repeatable
    #[arg(
        long,
        value_name = "KEY=VALUE",
        verbatim_doc_comment,
        conflicts_with = "preset"
    )]
    pub(crate) set: Vec<Setting>,
    /// Print as JSON; for a campaign in the format of gains.json
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArguments {
    /// Output directory of the run
    pub(crate) run: PathBuf,
    /// Index of the episode, from 0
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) episode: u32,
    /// The controller
    #[arg(long, default_value = "ftc")]
    pub(crate) controller: String,
    /// Seconds between samples, a multiple of the step
    /// [default: 0.01, or as near as the step allows]
    #[arg(
        long,
        value_name = "S",
        allow_negative_numbers = true,
        verbatim_doc_comment
    )]
    pub(crate) interval: Option<f64>,
    /// The Parquet file to write; the figures stand beside it as .html
    /// and .svg
    /// [default: <run>/replay-<episode>-<controller>.parquet]
    #[arg(long, value_name = "FILE", verbatim_doc_comment)]
    pub(crate) out: Option<PathBuf>,
    /// Replace the files that --out names
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing but errors and what --json asks for
    #[arg(long, short)]
    pub(crate) quiet: bool,
}
