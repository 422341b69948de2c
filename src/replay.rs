//! One episode of a run again, with its trajectories.

use crate::backend::cpu::{Cpu, Precision};
use crate::campaign::{Campaign, CampaignError, UAV_CHANNELS};
use crate::gains::{GainSet, GainsError};
use crate::manifest::Manifest;
use crate::model::Shown;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::output::OutputError;
use crate::tables::Table;
use std::path::Path;
use thiserror::Error;

/// Time between two samples where none is asked for, s.
const DEFAULT_INTERVAL_S: f64 = 0.01;

/// Why an episode cannot be replayed.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The directory holds no run.
    #[error(transparent)]
    Run(#[from] OutputError),
    /// The run's campaign cannot be read any more.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The run's gains cannot be read any more.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// There is no such episode, controller or rate.
    #[error("{option} {value}: {limit}; {remedy}")]
    Usage {
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to do instead.
        remedy: String,
    },
}

/// An episode flown again.
#[derive(Debug)]
pub struct Replay {
    /// The run's campaign.
    pub campaign: Campaign,
    /// Whether it was flown in the run's own arithmetic; else in double precision, because this processor lacks the run's lanes.
    pub same_arithmetic: bool,
    /// How each agent ended; equal to the run's rows, bit by bit in the same arithmetic.
    pub outcomes: Vec<AgentOutcome>,
    /// What every agent and channel showed.
    pub snapshots: Vec<Snapshot>,
}

/// Flies an episode of a run under one of its controllers again, on the run's backend and with the run's gains, and shows it
/// every `interval_s` (10 ms, or as near as the step allows).
///
/// # Errors
/// If the directory holds no run, or the run has no such episode or controller.
pub fn replay(
    dir: &Path,
    episode: u32,
    controller: &str,
    interval_s: Option<f64>,
) -> Result<Replay, ReplayError> {
    let manifest = Manifest::read(dir)?;
    let mut campaign = Campaign::parse(&manifest.campaign, Path::new(&manifest.campaign_path))?;
    campaign.seed = manifest.seed;
    campaign.episodes = manifest.episodes;
    if episode >= campaign.episodes {
        return Err(ReplayError::Usage {
            option: "--episode",
            value: episode.to_string(),
            limit: format!(
                "the run has {} episodes, numbered from 0",
                campaign.episodes
            ),
            remedy: format!("use 0 to {}", campaign.episodes - 1),
        });
    }
    let index = campaign
        .controllers
        .iter()
        .position(|name| name == controller)
        .ok_or_else(|| ReplayError::Usage {
            option: "--controller",
            value: controller.to_string(),
            limit: "the run has no such controller".to_string(),
            remedy: format!("use one of {}", campaign.controllers.join(", ")),
        })?;
    let every = interval_steps(&campaign, interval_s)?;
    let gains = GainSet::read(&campaign, &dir.join("gains.json"))?;
    // Other lanes round otherwise; if the run's are not to be had, the reference is the better stand-in.
    let precision = match manifest.simd {
        Some(simd) if !simd.is_available() => Precision::F64,
        _ => manifest.precision,
    };
    let cpu = Cpu::new(&campaign, &gains.loops(), precision, manifest.simd);
    let (outcomes, snapshots) = cpu.trace(episode, index, every);
    Ok(Replay {
        campaign,
        same_arithmetic: precision == manifest.precision,
        outcomes,
        snapshots,
    })
}

/// The steps between two samples.
fn interval_steps(campaign: &Campaign, interval_s: Option<f64>) -> Result<u32, ReplayError> {
    let step_s = campaign.time.step_s;
    let steps = f64::from(campaign.time.steps);
    let every = match interval_s {
        None => (DEFAULT_INTERVAL_S / step_s).round().clamp(1.0, steps),
        Some(interval_s) => interval_s / step_s,
    };
    // A decimal multiple of the step is one up to rounding.
    let whole = (every - every.round()).abs() < 1e-6 * every;
    if !(whole && every.round() >= 1.0 && every.round() <= steps) {
        return Err(ReplayError::Usage {
            option: "--interval",
            value: interval_s.unwrap_or(DEFAULT_INTERVAL_S).to_string(),
            limit: format!(
                "samples are whole steps of {step_s} s apart, within {} s",
                steps * step_s
            ),
            remedy: "use a multiple of the step".to_string(),
        });
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to lie within the steps"
    )]
    Ok(every.round() as u32)
}

impl Replay {
    /// The trajectories as a table: a row per instant, agent and channel.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut table = Table::default();
        for snapshot in &self.snapshots {
            for (agent, channels) in (0u64..).zip(&snapshot.agents) {
                for (channel, shown) in UAV_CHANNELS.iter().zip(channels) {
                    let Shown {
                        r,
                        x,
                        e,
                        e_rate,
                        e_hat,
                        f1,
                        f1_hat,
                        f2,
                        f2_hat,
                        u,
                    } = *shown;
                    let mut row = table.row();
                    row.real(
                        || "t_s".into(),
                        f64::from(snapshot.step) * self.campaign.time.step_s,
                    )
                    .count(|| "agent".into(), agent)
                    .word(|| "channel".into(), channel);
                    for (name, value) in [
                        ("r", r),
                        ("x", x),
                        ("e", e),
                        ("e_rate", e_rate),
                        ("e_hat", e_hat),
                        ("f1", f1),
                        ("f1_hat", f1_hat),
                        ("f2", f2),
                        ("f2_hat", f2_hat),
                        ("u", u),
                    ] {
                        row.real(|| name.into(), value);
                    }
                }
            }
        }
        table
    }
}
