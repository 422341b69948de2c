//! A campaign as the rest of the program sees it: checked and complete.

use super::disturbances_and_faults::{Disturbance, Fault};
use super::file::{CouplingCoordinates, IntegralKind, ObserverStart};
use super::kinds::DisturbanceKind;
use super::overlay::Setting;
use super::plan::{Sampling, Stop, Strata};
use super::quantity::RandomQuantity;
use super::time::Time;
use crate::agent::{ActuationKind, Agent, ChannelGroup};
use crate::reference::Reference;
use crate::synthesis::ChannelDesign;
use std::ops::Deref;
use std::path::PathBuf;
use std::sync::Arc;

/// Name of the paper's fault-tolerant controller.
pub const FTC: &str = "ftc";
/// Name of the PID computed-torque controller, the paper's text read plainly.
pub const PID: &str = "pid";
/// Name of the PID whose observer distrusts the faulty velocity channel.
pub const PID_TUNED: &str = "pid-tuned";

/// The controllers that need no file.
pub const BUILT_IN: [&str; 3] = [FTC, PID, PID_TUNED];

/// A validated campaign. Its parts are there to be read; what changes one of them checks it ([`Campaign::with_seed`],
/// [`Campaign::with_episodes`], or settings laid over the file).
#[derive(Debug, Clone)]
pub struct Campaign(Arc<Validated>);

impl Deref for Campaign {
    type Target = Validated;

    fn deref(&self) -> &Validated {
        &self.0
    }
}

impl Campaign {
    pub(super) fn new(validated: Validated) -> Self {
        Self(Arc::new(validated))
    }

    /// The same with parts changed by somebody who knows that they fit each other: nothing is checked.
    #[doc(hidden)]
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Validated)) -> Self {
        change(Arc::make_mut(&mut self.0));
        self
    }
}

/// The parts of a [`Campaign`].
#[derive(Debug, Clone)]
pub struct Validated {
    /// The file, as it was named on the command line.
    pub path: PathBuf,
    /// The file's text.
    pub text: String,
    /// The settings laid over it with `--set`, in their order.
    pub overlay: Vec<Setting>,
    /// Name.
    pub name: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Number of episodes, at least 1.
    pub episodes: u32,
    /// Names of the controllers, all different, at least one.
    pub controllers: Vec<String>,
    /// Duration and step.
    pub time: Time,
    /// What the agents are, as the controller models them.
    pub agent: Agent,
    /// Names of an agent's channels.
    pub(super) channels: Vec<Arc<str>>,
    /// Agents per episode, at least 1.
    pub team: usize,
    /// Where each agent is to go.
    pub reference: Reference,
    /// Where the gains come from.
    pub synthesis: GainSource,
    /// True mass over modelled mass, per agent.
    pub mass_scale: RandomQuantity,
    /// True inertia over modelled inertia, per agent.
    pub inertia_scale: RandomQuantity,
    /// Coupling strength, per agent.
    pub kappa: RandomQuantity,
    /// From where the coupling counts x.
    pub coordinates: CouplingCoordinates,
    /// What is between measurement and command, beside the controller.
    pub control: Control,
    /// Initial errors.
    pub initial: Initial,
    /// External disturbances, summed.
    pub disturbances: Vec<Disturbance>,
    /// Faults.
    pub faults: Vec<Fault>,
    /// Parts of the episodes with faults of their own.
    pub strata: Strata,
    /// How the random numbers of the episodes are chosen.
    pub sampling: Sampling,
    /// When the run may end early, if it may.
    pub stop: Option<Stop>,
    /// What counts as failure.
    pub verdict: Verdict,
    /// Conditions on the result.
    pub requirements: Vec<Requirement>,
}

impl Validated {
    /// Names of the channels of one agent, in the order of every table and list.
    #[must_use]
    pub fn channels(&self) -> &[Arc<str>] {
        &self.channels
    }

    /// The groups of channels whose errors may be averaged: metres and radians are never mixed. Each has gains of its
    /// own.
    #[must_use]
    pub fn channel_groups(&self) -> Vec<ChannelGroup> {
        self.agent.channel_groups()
    }

    /// The index of a channel's group.
    #[must_use]
    pub fn group_of(&self, channel: usize) -> usize {
        let groups = self.channel_groups();
        let own = groups
            .iter()
            .position(|own| own.channels.contains(&channel));
        own.unwrap_or_default()
    }

    /// The unit of a channel's error, m or rad.
    #[must_use]
    pub fn unit(&self, channel: usize) -> &'static str {
        let groups = self.channel_groups();
        groups
            .get(self.group_of(channel))
            .map_or("", |own| own.role.unit())
    }

    /// Whether limits cut the commands.
    #[must_use]
    pub fn is_limited(&self) -> bool {
        self.agent.actuation() != ActuationKind::Full
    }

    /// Whether the agents of a team act on each other in some episode.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        self.team > 1 && !self.kappa.is_zero()
    }

    /// Whether agents blow on each other, so that their distances matter.
    #[must_use]
    pub fn has_vortices(&self) -> bool {
        let blows = |one: &Disturbance| one.kind == DisturbanceKind::RotorVortex;
        self.disturbances.iter().any(blows)
    }
}

/// What is between measurement and command, beside the controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// What the first output integrates.
    pub integral: IntegralKind,
    /// Time that a command takes to the actuator, s; per agent.
    pub delay_s: Option<RandomQuantity>,
    /// Steps for which a command is held; 1 for a controller that never rests.
    pub hold_steps: u32,
}

/// Initial errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Initial {
    /// x - r, m or rad.
    pub error: RandomQuantity,
    /// x' - r', m/s or rad/s.
    pub error_rate: RandomQuantity,
    /// Integral of x - r, m s or rad s.
    pub error_integral: RandomQuantity,
    /// What the observers start from.
    pub observer: ObserverStart,
}

/// What counts as failure.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Largest |e| from settle_s on, per channel; infinite where there is no limit.
    pub max_error: Vec<f64>,
    /// Largest RMS error from settle_s on, per channel; infinite where there is no limit.
    pub max_rmse: Vec<f64>,
    /// |e| at or below this counts as settled, per channel.
    pub settled_error: Vec<f64>,
}

/// A condition on the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// The controller that has to meet it.
    pub controller: String,
    /// The stratum in which it has to, or [`ALL`](super::ALL) episodes.
    pub stratum: Arc<str>,
    /// Upper limit of the one-sided 95 % bound of the failure rate: Clopper-Pearson's, or that of the confidence
    /// sequence where `[stop]` decides on the number of episodes.
    pub failure_rate_upper_95: f64,
}

/// Where the gains come from.
#[derive(Debug, Clone, PartialEq)]
pub struct GainSource {
    /// Weights of each channel group.
    pub designs: Vec<ChannelDesign>,
    /// Name of the preset that the weights start from.
    pub preset: String,
    /// File that replaces the synthesized gains.
    pub gains: Option<PathBuf>,
    /// Additional controllers.
    pub named: Vec<NamedGains>,
}

/// An additional controller from a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedGains {
    /// Its name in this campaign.
    pub name: String,
    /// The file.
    pub gains: PathBuf,
    /// Which of the file's controllers.
    pub controller: String,
}
