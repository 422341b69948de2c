//! Where the time of a GPU's work went.

use serde::{Deserialize, Serialize};

/// Wall-clock times of a simulation on a GPU, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GpuTimes {
    /// Shaders to machine code.
    pub compile_s: f64,
    /// Drawing episodes and sending them.
    pub upload_s: f64,
    /// The episode loop.
    pub kernel_s: f64,
    /// Receiving outcomes.
    pub read_back_s: f64,
}
