//! What the channels of an agent are, and in which unit their errors count.

use serde::{Deserialize, Serialize};

/// Which channels of an agent a design belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChannelRole {
    /// x, y and z of a UAV, m.
    Position,
    /// Roll, pitch and yaw of a UAV, rad.
    Attitude,
    /// The twelve joints of a biped, rad.
    Joints,
}

impl ChannelRole {
    /// The name in files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Attitude => "attitude",
            Self::Joints => "joints",
        }
    }

    /// The unit of an error.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Position => "m",
            Self::Attitude | Self::Joints => "rad",
        }
    }
}
