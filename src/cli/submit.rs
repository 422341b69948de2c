//! `urts-mc submit`: what begins the shards of a run on a cluster.

use super::console::print;
use super::exit::{Code, Failure};
use super::halt::duration;
use super::options::{BackendChoice, EngineArguments, Overrides, PrecisionChoice, SimdChoice};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Duration;
use urts_mc::report::submission::{Submission, kubernetes, slurm};

#[derive(Debug, Args)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Print a script that submits N shards and their merge to Slurm
    #[arg(long, value_name = "N", required_unless_present = "kubernetes", conflicts_with = "kubernetes", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) slurm: Option<u32>,
    /// Print manifests of N shards and their merge for Kubernetes
    #[arg(long, value_name = "N", requires = "image", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) kubernetes: Option<u32>,
    /// The longest that a task may take; it ends a little before, and is
    /// begun again if it is not done
    #[arg(long, value_name = "4h", default_value = "1h", verbatim_doc_comment, value_parser = duration)]
    pub(crate) time: Duration,
    /// The container image with the program
    #[arg(long, value_name = "IMAGE")]
    pub(crate) image: Option<String>,
    /// The volume claim of the working directory, with the campaign in
    /// it
    #[arg(
        long,
        value_name = "NAME",
        default_value = "urts-mc",
        verbatim_doc_comment
    )]
    pub(crate) claim: String,
    /// The directory that all shards write
    /// [default: reports/<name of the campaign>]
    #[arg(long, verbatim_doc_comment)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) engine: EngineArguments,
}

/// Prints what would begin the shards; nothing is run.
pub(super) fn submit_command(arguments: &SubmitArguments) -> Result<Code, Failure> {
    let campaign = arguments.overrides.load()?;
    // Options that contradict each other are said here, not by a hundred tasks.
    arguments.engine.options_anywhere()?;
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| Path::new("reports").join(&campaign.name));
    let shards = arguments.slurm.or(arguments.kubernetes).unwrap_or(1);
    let here = std::env::current_exe().ok();
    let here = here.filter(|_| arguments.image.is_none());
    let submission = Submission {
        campaign: campaign.name.clone(),
        episodes: campaign.episodes,
        shards,
        program: here.map_or("urts-mc".to_string(), |path| path.display().to_string()),
        options: [arguments.overrides.words(), arguments.engine.words()].concat(),
        out: out.display().to_string(),
        time: arguments.time,
        gpu: arguments.engine.backend == BackendChoice::Gpu,
        image: arguments.image.clone(),
    };
    match arguments.slurm {
        Some(_) => print(&slurm(&submission))?,
        None => {
            let manifests = kubernetes(&submission, &arguments.claim);
            print(&format!("{}\n", serde_json::to_string_pretty(&manifests)?))?;
        }
    }
    Ok(Code::Done)
}

impl Overrides {
    /// The words of a command line that say the same.
    fn words(&self) -> Vec<String> {
        let mut words = vec![self.campaign.display().to_string()];
        let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
        if let Some(episodes) = self.episodes {
            option("episodes", episodes.to_string());
        }
        if let Some(seed) = self.seed {
            option("seed", seed.to_string());
        }
        for setting in &self.set {
            option("set", setting.to_string());
        }
        words
    }
}

impl EngineArguments {
    /// The words of a command line that say the same, as far as they differ from what is usual.
    fn words(&self) -> Vec<String> {
        let backend = match self.backend {
            BackendChoice::Auto => None,
            BackendChoice::Gpu => Some("gpu"),
            BackendChoice::Cpu => Some("cpu"),
        };
        let precision = match self.precision {
            PrecisionChoice::F32 => None,
            PrecisionChoice::F64 => Some("f64"),
        };
        let simd = match self.simd {
            SimdChoice::Auto => None,
            SimdChoice::Scalar => Some("scalar"),
            SimdChoice::Avx2 => Some("avx2"),
            SimdChoice::Avx512 => Some("avx512"),
        };
        let threads = (self.threads > 0).then(|| self.threads.to_string());
        let all = [
            ("backend", backend.map(String::from)),
            ("adapter", self.adapter.clone()),
            ("precision", precision.map(String::from)),
            ("simd", simd.map(String::from)),
            ("threads", threads),
        ];
        let given = all
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)));
        given
            .flat_map(|(name, value)| [format!("--{name}"), value])
            .collect()
    }
}
