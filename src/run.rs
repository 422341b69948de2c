//! A whole run: gains, episodes, tables, statistics, files.

use crate::backend::cpu::{Cpu, Precision, Simd};
use crate::campaign::{Campaign, Requirement};
use crate::comparison::{self, FailureRate, MetricQuantiles, PairedComparison};
use crate::gains::{GainSet, GainsError};
use crate::manifest::{GIT_REVISION, Manifest, Times, campaign_hash};
use crate::output::{MANIFEST, OutputDir, OutputError};
use crate::tables::Tables;
use std::time::Instant;
use thiserror::Error;

/// Episodes between two additions to the tables: enough to keep many cores busy, few enough to keep memory small.
const BATCH: u32 = 2048;

/// How a campaign is to be flown.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Number format of the episode loop.
    pub precision: Precision,
    /// Layout of single-precision episodes; the widest of this processor if not given.
    pub simd: Option<Simd>,
    /// Threads of the episode loop; all cores if zero.
    pub threads: usize,
}

/// Why a run ended early.
#[derive(Debug, Error)]
pub enum RunError {
    /// No gains.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// No directory to write.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// No threads.
    #[error("--threads {threads}: the threads cannot be started ({source}); use fewer")]
    Threads {
        /// As many as were asked for.
        threads: usize,
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
    /// The manifest cannot be encoded.
    #[error("the manifest cannot be encoded")]
    Manifest(#[from] serde_json::Error),
}

/// What a run found.
#[derive(Debug)]
pub struct Findings<'a> {
    /// How every controller fared.
    pub summary: Vec<MetricQuantiles>,
    /// How every pair compares.
    pub comparisons: Vec<PairedComparison>,
    /// Requirements that do not hold.
    pub unmet: Vec<(&'a Requirement, FailureRate)>,
    /// How it was found.
    pub manifest: Manifest,
}

/// Flies a campaign with gains at hand; `done` is told of finished episodes.
///
/// # Errors
/// If the threads cannot be started.
pub fn fly(
    campaign: &Campaign,
    gains: &GainSet,
    settings: Settings,
    done: &(dyn Fn(u32) + Sync),
) -> Result<Flight, RunError> {
    let threads = settings.threads;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| RunError::Threads { threads, source })?;
    let mut times = Times::default();
    let start = Instant::now();
    let cpu = Cpu::new(campaign, &gains.loops(), settings.precision, settings.simd);
    let mut tables = Tables::new(campaign);
    times.loop_s += start.elapsed().as_secs_f64();
    let mut first = 0;
    while first < campaign.episodes {
        let next = first.saturating_add(BATCH).min(campaign.episodes);
        let start = Instant::now();
        let flown = pool.install(|| cpu.fly(first..next, done));
        times.loop_s += start.elapsed().as_secs_f64();
        let start = Instant::now();
        for episode in &flown {
            tables.add(campaign, episode);
        }
        times.statistics_s += start.elapsed().as_secs_f64();
        first = next;
    }
    Ok(Flight {
        tables,
        times,
        simd: cpu.simd(),
        threads: pool.current_num_threads(),
    })
}

/// The tables of a flown campaign, and how they came about.
#[derive(Debug)]
pub struct Flight {
    /// The tables.
    pub tables: Tables,
    /// Times so far.
    pub times: Times,
    /// Layout that was used.
    pub simd: Option<Simd>,
    /// Threads that were used.
    pub threads: usize,
}

/// Runs a campaign into a directory. `csv` also writes the two big tables as CSV.
///
/// # Errors
/// If gains cannot be had, or files cannot be written.
pub fn run<'a>(
    campaign: &'a Campaign,
    settings: Settings,
    out: &OutputDir,
    csv: bool,
    done: &(dyn Fn(u32) + Sync),
) -> Result<Findings<'a>, RunError> {
    let start = Instant::now();
    let gains = GainSet::obtain(campaign)?;
    let synthesis_s = start.elapsed().as_secs_f64();

    let Flight {
        tables,
        mut times,
        simd,
        threads,
    } = fly(campaign, &gains, settings, done)?;
    times.synthesis_s = synthesis_s;

    let start = Instant::now();
    let summary = comparison::summarise(campaign, &tables.scores);
    let comparisons = comparison::compare(campaign, &tables.scores);
    let unmet = comparison::unmet(campaign, &tables.scores);
    times.statistics_s += start.elapsed().as_secs_f64();

    let start = Instant::now();
    out.begin()?;
    let summary_table = comparison::summary_table(&summary);
    let comparison_table = comparison::comparison_table(&comparisons);
    for (name, table, with_csv) in [
        ("episodes", &tables.episodes, csv),
        ("channels", &tables.channels, csv),
        ("summary", &summary_table, true),
        ("comparison", &comparison_table, true),
    ] {
        // One controller has nothing to be compared with.
        if table.is_empty() {
            continue;
        }
        out.write_parquet(&format!("{name}.parquet"), table)?;
        if with_csv {
            out.write_csv(&format!("{name}.csv"), table)?;
        }
    }
    out.write(
        "gains.json",
        &pretty(&gains.to_file(&campaign.synthesis.designs))?,
    )?;
    times.writing_s = start.elapsed().as_secs_f64();
    let manifest = Manifest {
        name: campaign.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        git_revision: GIT_REVISION.map(String::from),
        campaign_path: campaign.path.display().to_string(),
        campaign_blake3: campaign_hash(campaign),
        campaign: campaign.text.clone(),
        seed: campaign.seed,
        episodes: campaign.episodes,
        backend: "cpu".to_string(),
        precision: settings.precision,
        simd,
        threads,
        times,
    };
    out.write(MANIFEST, &pretty(&manifest)?)?;
    Ok(Findings {
        summary,
        comparisons,
        unmet,
        manifest,
    })
}

fn pretty(value: &impl serde::Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec_pretty(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}
