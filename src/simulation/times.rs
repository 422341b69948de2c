//! How long the parts of a run took.

use serde::{Deserialize, Serialize};

/// Wall-clock times of a run, s.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Times {
    /// Synthesis and verification of the gains.
    pub synthesis_s: f64,
    /// Tabulating references and the episode loop itself.
    pub loop_s: f64,
    /// Cross-check.
    pub cross_check_s: f64,
    /// Keeping parts, which is done beside the loop, making of them the tables that grow with the episodes, and
    /// statistics.
    pub statistics_s: f64,
    /// Writing the other files.
    pub writing_s: f64,
}
