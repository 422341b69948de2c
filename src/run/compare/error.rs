//! Why two runs cannot be compared.

use crate::campaign::CampaignError;
use crate::controllers::GainsError;
use crate::run::error::OutputError;
use std::path::PathBuf;
use thiserror::Error;

/// Why two runs cannot be compared.
#[derive(Debug, Error)]
pub enum CompareError {
    /// A directory holds no run, or the findings cannot be written.
    #[error(transparent)]
    Run(#[from] OutputError),
    /// A run's campaign cannot be read any more.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// A run's gains cannot be read any more.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// A run did not write what a comparison reads.
    #[error(
        "{}: has not all tables ([output] detail = \"{detail}\"), and runs are compared by those of episodes and \
         channels: fly it again with --set output.detail=all", path.display()
    )]
    Detail {
        /// Its directory.
        path: PathBuf,
        /// What it wrote.
        detail: &'static str,
    },
    /// The runs did not meet the same.
    #[error(
        "{} and {} differ in {}; episodes can be compared pair by pair only where both runs met the same: run one of \
         them again with the other's campaign, seed and version, and other controllers or gains",
        a.display(), b.display(), what.join("; ")
    )]
    Differ {
        /// The first run.
        a: PathBuf,
        /// The second run.
        b: PathBuf,
        /// In what they differ.
        what: Vec<String>,
    },
    /// There is no such controller or measure.
    #[error("{option} {value}: {limit}; {remedy}")]
    Usage {
        /// The option.
        option: String,
        /// Its value.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to do instead.
        remedy: String,
    },
    /// The findings cannot be encoded.
    #[error("the findings cannot be encoded")]
    Json(#[from] serde_json::Error),
}

impl CompareError {
    pub(super) fn usage(option: &str, value: &str, limit: &str, remedy: &str) -> Self {
        Self::Usage {
            option: option.to_string(),
            value: value.to_string(),
            limit: limit.to_string(),
            remedy: remedy.to_string(),
        }
    }

    /// What is wrong with a measure, as that of an option.
    pub(super) fn of_option(option: &str, error: CampaignError) -> Self {
        match error {
            CampaignError::Invalid {
                value,
                limit,
                remedy,
                ..
            } => Self::usage(option, &value, &limit, &remedy),
            other => other.into(),
        }
    }
}
