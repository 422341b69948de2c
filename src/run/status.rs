//! How far a run is that is flown in parts.

use super::error::OutputError;
use super::manifest::Manifest;
use super::parts::{Parts, pilot_of, plan_of, shards_of, was_left};
use super::shard::Shard;
use crate::campaign::CampaignError;
use serde::Serialize;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why nothing is known of a run.
#[derive(Debug, Error)]
pub enum StatusError {
    /// The directory holds none.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// This version does not read its campaign.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}

/// How far a run is; for programs it is written as it stands here.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Status {
    /// Its directory.
    pub path: PathBuf,
    /// Name of its campaign.
    pub campaign: String,
    /// Episodes that were asked for.
    pub asked: u32,
    /// Episodes that are kept.
    pub kept: u32,
    /// Whether its files are written: nothing is left to be done.
    pub is_whole: bool,
    /// Episodes that one process simulates in a second, as those that are kept took; none where none are.
    pub rate_per_s: Option<f64>,
    /// What is left takes about so long with the processes that are at it, s; none without a rate or a process.
    pub left_s: Option<f64>,
    /// The process that writes the whole run, if there is one.
    pub process: Option<String>,
    /// The shards in which it was begun; none where it was not.
    pub shards: Vec<ShardStatus>,
    /// What the engine that began the shards calls the first.
    pub first: u32,
}

/// How far a shard is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShardStatus {
    /// Which, from 1.
    pub number: u32,
    /// Its episodes.
    pub asked: u32,
    /// Those that are kept.
    pub kept: u32,
    /// How it is.
    pub state: ShardState,
    /// The process that flies it, if there is one.
    pub process: Option<String>,
}

/// How a shard is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ShardState {
    /// All its episodes are kept.
    Done,
    /// A process is at it.
    Running,
    /// Its process ended without a word.
    Failed,
    /// Its process ended before all was flown, as it was asked to.
    Partial,
    /// No process has begun it.
    Waiting,
}

impl ShardState {
    /// In a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Running => "running",
            Self::Failed => "failed",
            Self::Partial => "partial",
            Self::Waiting => "waiting",
        }
    }
}

impl Status {
    /// Looks at a directory; what is there is not verified.
    ///
    /// # Errors
    /// If it holds no run, finished or not, that this version reads.
    pub fn of(dir: &Path) -> Result<Self, StatusError> {
        let Some(plan) = plan_of(dir)? else {
            let manifest = Manifest::read(dir)?;
            return Ok(Self {
                path: dir.to_path_buf(),
                campaign: manifest.name,
                asked: manifest.episodes_asked,
                kept: manifest.episodes,
                is_whole: true,
                rate_per_s: None,
                left_s: None,
                process: None,
                shards: Vec::new(),
                first: 1,
            });
        };
        let campaign = plan.campaign()?;
        let parts = Parts::seen(dir, &campaign, plan);
        let begun = shards_of(dir);
        let of = begun.map_or(0, |own| own.of.min(Shard::MOST));
        let all = (1..=of).filter_map(|number| Shard::new(number, of));
        let shards: Vec<ShardStatus> = all.map(|shard| of_shard(dir, &parts, shard)).collect();
        let process = parts.pilot();
        let at_it = shards.iter().filter(|own| own.process.is_some()).count();
        let at_it = at_it + usize::from(process.is_some());
        let kept = parts.kept();
        let rate_per_s =
            (kept > 0 && parts.loop_s() > 0.0).then(|| f64::from(kept) / parts.loop_s());
        let left = f64::from(parts.asked() - kept);
        let left_s = rate_per_s.filter(|_| at_it > 0);
        Ok(Self {
            path: dir.to_path_buf(),
            campaign: campaign.name.clone(),
            asked: parts.asked(),
            kept,
            is_whole: false,
            rate_per_s,
            left_s: left_s.map(|rate| left / rate / at_it as f64),
            process,
            shards,
            first: begun.map_or(1, |own| own.first),
        })
    }

    /// The numbers of the shards that nobody flies though episodes are missing, as an engine's array names them; empty
    /// if there are none.
    #[must_use]
    pub fn missing(&self) -> String {
        let missing = self.shards.iter().filter(|own| {
            matches!(
                own.state,
                ShardState::Failed | ShardState::Partial | ShardState::Waiting
            )
        });
        let numbers: Vec<u32> = missing.map(|own| own.number - 1 + self.first).collect();
        let runs = numbers.chunk_by(|a, b| a + 1 == *b);
        let of_run = |run: &[u32]| match run {
            [one] => one.to_string(),
            run => format!("{}-{}", run[0], run[run.len() - 1]),
        };
        runs.map(of_run).collect::<Vec<_>>().join(",")
    }
}

fn of_shard(dir: &Path, parts: &Parts, shard: Shard) -> ShardStatus {
    let own = shard.parts(parts.count());
    let [asked, kept] = [Parts::episodes_of, Parts::kept_of]
        .map(|of: fn(&Parts, u32) -> u32| own.clone().map(|index| of(parts, index)).sum::<u32>());
    let process = pilot_of(dir, shard);
    let state = match process {
        _ if kept == asked => ShardState::Done,
        Some(_) => ShardState::Running,
        None if was_left(dir, shard) => ShardState::Failed,
        None if kept > 0 => ShardState::Partial,
        None => ShardState::Waiting,
    };
    ShardStatus {
        number: shard.number(),
        asked,
        kept,
        state,
        process,
    }
}
