//! The shipped designs: Section V of the paper, and one for the underactuated UAV.

use super::design::{ChannelDesign, geometric_q2};
use super::smoothing::Smoothing;
use crate::agent::ChannelRole;
use serde::{Deserialize, Serialize};

/// A named set of channel designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The paper's UAV gains on all six channels; assumes full actuation.
    UavPaper,
    /// The paper's UAV gains on attitude, slower position gains that an underactuated UAV can follow.
    UavPhysical,
    /// The paper's robot gains on all joints.
    BipedPaper,
}

impl Preset {
    /// Every preset.
    pub const ALL: [Self; 3] = [Self::UavPaper, Self::UavPhysical, Self::BipedPaper];

    /// The name in campaign files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::UavPaper => "uav-paper",
            Self::UavPhysical => "uav-physical",
            Self::BipedPaper => "biped-paper",
        }
    }

    /// The designs by role, in the order of an agent's channels.
    #[must_use]
    pub fn designs(self) -> Vec<(ChannelRole, ChannelDesign)> {
        match self {
            Self::UavPaper => vec![
                (ChannelRole::Position, uav_paper()),
                (ChannelRole::Attitude, uav_paper()),
            ],
            Self::UavPhysical => vec![
                (ChannelRole::Position, uav_position_physical()),
                (ChannelRole::Attitude, uav_paper()),
            ],
            Self::BipedPaper => vec![(ChannelRole::Joints, biped_paper())],
        }
    }
}

fn uav_paper() -> ChannelDesign {
    let smoothing = Smoothing::paper();
    ChannelDesign {
        q1: [10.0, 1000.0, 100.0],
        q2: geometric_q2(&smoothing, [0.1, 10.0, 1.0], 1.0, 20.0),
        r: 0.02,
        rho: 30.0,
        nu: 1e-4,
        eps2: 0.01,
        sensor_fault_input: [0.0, 0.1, 1.0],
        pid_nu: 1e-2,
        smoothing,
    }
}

/// A thousand times the control weight at the same ratio R / rho^2, and a
/// hundredth of the bandwidth: what a thrust vector behind a tilt can follow.
fn uav_position_physical() -> ChannelDesign {
    ChannelDesign {
        r: 20.0,
        rho: 30.0 * 1000.0_f64.sqrt(),
        nu: 3e-2,
        pid_nu: 1e-1,
        ..uav_paper()
    }
}

fn biped_paper() -> ChannelDesign {
    let smoothing = Smoothing::paper();
    ChannelDesign {
        q1: [50.0, 5000.0, 500.0],
        q2: geometric_q2(&smoothing, [5.0, 500.0, 50.0], 5.0, 5.0),
        r: 0.002,
        rho: 30.0,
        nu: 1e-4,
        eps2: 0.01,
        sensor_fault_input: [0.0, 0.0, 1.0],
        pid_nu: 1e-2,
        smoothing,
    }
}
