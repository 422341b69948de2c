//! Why a run ended early, and what is kept of it.

use super::error::OutputError;
use crate::backend::gpu::GpuError;
use crate::campaign::CampaignError;
use crate::controllers::GainsError;
use crate::simulation::SimulationError;
use crate::util::format;
use std::path::PathBuf;
use thiserror::Error;

/// Why a run ended early.
#[derive(Debug, Error)]
pub enum RunError {
    /// No gains.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// Something is required that is not known of the gains.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// No directory to write.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Nothing simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Fewer episodes simulated than the directory holds already.
    #[error(
        "{reason}; {simulated} episodes were finished, and {} keeps the {earlier} of an earlier run; use --backend cpu",
        path.display()
    )]
    Interrupted {
        /// Why no more were simulated.
        reason: GpuError,
        /// Episodes that were simulated.
        simulated: u32,
        /// The directory.
        path: PathBuf,
        /// Episodes that it holds.
        earlier: u32,
    },
    /// It was asked to end before it had flown all.
    #[error("{kept} of {asked} episodes are kept in {}; the same command goes on with them", path.display())]
    Partial {
        /// Episodes that are kept.
        kept: u32,
        /// Episodes that were asked for.
        asked: u32,
        /// The directory.
        path: PathBuf,
    },
    /// Its files cannot be written, though its episodes are kept.
    #[error(
        "{source}; {kept} of {asked} episodes are kept in {}: make room, about {} in all, and the same command goes on",
        path.display(),
        format::bytes(*needed_bytes)
    )]
    Stuck {
        /// Why not.
        source: OutputError,
        /// Episodes that are kept.
        kept: u32,
        /// Episodes that were asked for.
        asked: u32,
        /// The directory.
        path: PathBuf,
        /// What the rest takes, about.
        needed_bytes: u64,
    },
    /// The manifest cannot be encoded.
    #[error("the manifest cannot be encoded")]
    Manifest(#[from] serde_json::Error),
}
