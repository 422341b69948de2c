//! What a command acts through.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the command acts through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ActuationKind {
    /// A force or torque on every channel, without limits.
    Full,
    /// UAV: thrust along the body axis and three torques, within limits.
    Thrust,
    /// Biped: torques within the robot's limits.
    Limited,
}
