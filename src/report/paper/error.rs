//! Why the paper's figures cannot be made.

use crate::campaign::CampaignError;
use crate::controllers::GainsError;
use crate::run::error::OutputError;
use std::path::PathBuf;
use thiserror::Error;

/// Why the figures cannot be made.
#[derive(Debug, Error)]
pub enum PaperError {
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A campaign is invalid.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// Its gains cannot be had.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// The claims cannot be asked of a campaign.
    #[error(
        "{}: the claims are about agents that meet one sine and one smoothed square wave on every sensor, the same on all channels; \
         give it these",
        path.display()
    )]
    Unsuited {
        /// Where its text is from.
        path: PathBuf,
    },
}
