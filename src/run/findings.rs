//! What a run found.

use super::manifest::Manifest;
use crate::results::Results;
use serde::Serialize;

/// What a run found; for programs it is written as it stands here.
#[derive(Debug, Serialize)]
pub struct Findings {
    /// The statistics.
    #[serde(flatten)]
    pub results: Results,
    /// How it was found.
    pub manifest: Manifest,
}
