//! Why there are no gains.

use crate::campaign::CampaignError;
use crate::synthesis::SynthesisError;
use std::path::PathBuf;
use thiserror::Error;

/// Why there are no gains.
#[derive(Debug, Error)]
pub enum GainsError {
    /// The synthesis failed.
    #[error("{}: synthesis of the {channels} channels: {source}", path.display())]
    Synthesis {
        /// The campaign file.
        path: PathBuf,
        /// The channels.
        channels: String,
        /// Why.
        source: Box<SynthesisError>,
    },
    /// Gains from a file do not pass the verification.
    #[error("{}: controllers.{controller}.{channels}: {source}", path.display())]
    Refused {
        /// The gains file.
        path: PathBuf,
        /// The controller in the file.
        controller: String,
        /// The channels.
        channels: String,
        /// Why.
        source: Box<SynthesisError>,
    },
    /// A gains file cannot be read or lacks what is needed.
    #[error("{}: {reason}", path.display())]
    File {
        /// The gains file.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The gains and the campaign do not go together.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}

impl GainsError {
    /// Whether the user's files are at fault rather than the synthesis.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::File { .. } | Self::Campaign(_))
    }
}
