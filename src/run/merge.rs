//! The shards of a run into one.

use super::conclusion::Conclusion;
use super::directory::OutputDir;
use super::error::OutputError;
use super::failure::RunError;
use super::findings::Findings;
use super::parts::{Parts, plan_of, shards_of};
use super::progress::Progress;
use super::status::Status;
use super::tables::FILE_ROWS;
use crate::campaign::{Campaign, CampaignError};
use crate::controllers::{GainSet, cautions};
use crate::results::extent::Extent;
use crate::simulation::{RunOptions, SimulationError, Times, threads};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why shards do not make a run.
#[derive(Debug, Error)]
pub enum MergeError {
    /// A directory cannot be read or written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// This version does not read the campaign.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// What was made of the parts cannot be concluded.
    #[error(transparent)]
    Run(Box<RunError>),
    /// No threads.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// There is nothing to merge.
    #[error("{}: keeps no episodes of an unfinished run; name the directory that the shards were flown into", path.display())]
    Nothing {
        /// The directory.
        path: PathBuf,
    },
    /// Two directories are not of the same run.
    #[error("{}: is not of the run in {}: {what}; merge what was flown of one campaign, seed and version", other.display(), path.display())]
    Differ {
        /// The first directory.
        path: PathBuf,
        /// The other.
        other: PathBuf,
        /// In what it differs.
        what: String,
    },
    /// Episodes were simulated by several programs or engines.
    #[error("{}: its episodes were simulated by {what}; let them stand in one run with --allow-mixed, or fly them again", path.display())]
    Mixed {
        /// The directory.
        path: PathBuf,
        /// By which.
        what: String,
    },
    /// Episodes are missing.
    #[error("{}: {missing} of {asked} episodes are missing ({ranges}){remedy}", path.display())]
    Gaps {
        /// The directory.
        path: PathBuf,
        /// How many.
        missing: u32,
        /// Of how many.
        asked: u32,
        /// Which.
        ranges: String,
        /// What to do.
        remedy: String,
    },
}

impl From<RunError> for MergeError {
    fn from(error: RunError) -> Self {
        Self::Run(Box::new(error))
    }
}

/// What a merge does beside making one run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Merging {
    /// Whether the large tables are written as CSV too.
    pub csv: bool,
    /// Whether a directory that holds something else is written.
    pub overwrite: bool,
    /// Whether episodes of several engines or versions may stand in one run.
    pub allow_mixed: bool,
}

/// Makes one run, in `out`, of the parts that are kept in some directories; `out` may be one of them.
///
/// # Errors
/// If the parts are not of one run, or not all of it, or are not what was written; then they stay as they are.
pub fn merge(
    dirs: &[PathBuf],
    out: &Path,
    options: &RunOptions,
    merging: Merging,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<(Campaign, Findings), MergeError> {
    let nothing = |path: &Path| MergeError::Nothing {
        path: path.to_path_buf(),
    };
    let first = dirs.first().ok_or_else(|| nothing(out))?;
    let plan = plan_of(first)?.ok_or_else(|| nothing(first))?;
    let campaign = plan.campaign()?;
    for other in &dirs[1..] {
        let there = plan_of(other)?.ok_or_else(|| nothing(other))?;
        let differs = plan.difference(&there, &campaign);
        let episodes = || format!("{} episodes", there.episodes);
        let what = differs.or_else(|| (there.episodes != plan.episodes).then(episodes));
        if let Some(what) = what {
            return Err(MergeError::Differ {
                path: first.clone(),
                other: other.clone(),
                what,
            });
        }
    }
    Extent::of(&campaign).fits_here(&campaign)?;
    let out = OutputDir::claim(out, &campaign, merging.overwrite)?;
    let mut parts = Parts::gathered(dirs, &out, &campaign, plan)?;
    complete(&parts, first)?;
    let by = parts.simulated_by();
    if by.len() > 1 && !merging.allow_mixed {
        let by = by
            .iter()
            .map(|(program, engine)| format!("{program} on {engine}"));
        return Err(MergeError::Mixed {
            path: first.clone(),
            what: by.collect::<Vec<_>>().join(" and "),
        });
    }
    let path = parts.gains();
    let gains = GainSet::read(&campaign, &path).map_err(RunError::Gains)?;
    let gains_file = fs::read(&path);
    let gains_file = gains_file.map_err(|source| OutputError::Unwritable {
        path: path.clone(),
        source,
    })?;
    if blake3::hash(&gains_file).to_hex().as_str() != parts.plan().gains_blake3 {
        let reason = "its content was changed".to_string();
        return Err(OutputError::DamagedPart { path, reason }.into());
    }
    let mut notes = cautions(&campaign, &gains);
    notes.append(&mut parts.notes);
    let pool = threads(options)?;
    let conclusion = Conclusion {
        campaign: &campaign,
        gains: &gains,
        gains_file: &gains_file,
        pool: &pool,
        out: &out,
        csv: merging.csv,
        file_rows: FILE_ROWS,
        notes,
        interrupted: None,
        times: Times {
            loop_s: parts.loop_s(),
            ..Times::default()
        },
        check: &|_, _| (None, None),
        progress,
    };
    let findings = conclusion.of(&parts)?;
    parts.remove()?;
    Ok((campaign, findings))
}

/// Refuses parts among which some are missing.
fn complete(parts: &Parts, dir: &Path) -> Result<(), MergeError> {
    let missing = parts.missing();
    if missing.is_empty() {
        return Ok(());
    }
    const SHOWN: usize = 5;
    let of_range = |own: &Range<u32>| format!("{} to {}", own.start, own.end - 1);
    let mut ranges: Vec<String> = missing.iter().take(SHOWN).map(of_range).collect();
    if missing.len() > SHOWN {
        ranges.push(format!("and {} more ranges", missing.len() - SHOWN));
    }
    let notes = parts.notes.iter().map(|note| format!("; {note}"));
    let notes: String = notes.collect();
    let again = Status::of(dir).map(|status| status.missing()).ok();
    let again = again.filter(|again| !again.is_empty());
    let remedy = match (shards_of(dir), again) {
        (Some(_), Some(again)) => format!("; submit the shards {again} again (--array={again})"),
        (Some(_), None) => "; wait for the shards that are at it".to_string(),
        (None, _) => "; run the campaign again, which goes on with what is kept".to_string(),
    };
    Err(MergeError::Gaps {
        path: dir.to_path_buf(),
        missing: missing.iter().map(|own| own.end - own.start).sum(),
        asked: parts.asked(),
        ranges: ranges.join(", "),
        remedy: notes + &remedy,
    })
}
