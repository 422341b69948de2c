//! Disturbances and faults.

use super::file::Link;
use super::kinds::{DisturbanceKind, FaultKind, FaultTarget};
use super::quantity::RandomQuantity;
use std::sync::Arc;

/// An external disturbance.
#[derive(Debug, Clone, PartialEq)]
pub struct Disturbance {
    /// Form.
    pub kind: DisturbanceKind,
    /// Its parameters, in the order of [`DisturbanceKind::parameters`].
    pub parameters: Vec<RandomQuantity>,
}

/// A fault of an actuator, a sensor, the network or the plant.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Its name, different from all others.
    pub name: Arc<str>,
    /// What fails.
    pub target: FaultTarget,
    /// Which way between controller and plant, if it strikes one.
    pub link: Link,
    /// How.
    pub kind: FaultKind,
    /// Probability that an agent has it, per agent; 0: never, whatever a stratum says.
    pub probability: Vec<f64>,
    /// Whether strata leave it as it is.
    pub background: bool,
    /// Where; per agent.
    pub channels: Vec<FaultChannels>,
    /// When, s; one value per agent.
    pub onset_s: RandomQuantity,
    /// How long, s; one value per agent. None: to the end.
    pub duration_s: Option<RandomQuantity>,
    /// The time in which it comes, s; one value per agent. None: at once.
    pub ramp_s: Option<RandomQuantity>,
    /// Its parameters, in the order of [`FaultKind::parameters`].
    pub parameters: Vec<RandomQuantity>,
}

impl Fault {
    /// Whether a channel is drawn for it, in some agent.
    #[must_use]
    pub fn strikes_one(&self) -> bool {
        self.channels.contains(&FaultChannels::One)
    }

    /// Whether some agent never has it.
    #[must_use]
    pub fn spares_some(&self) -> bool {
        self.probability.contains(&0.0)
    }
}

/// The channels that a fault strikes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FaultChannels {
    /// One channel of each agent, drawn evenly.
    One,
    /// These channels (from 0).
    These(Vec<usize>),
}
