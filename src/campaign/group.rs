//! A group of agents of one kind: what they are, what they follow, and what acts on them.

use super::common::Common;
use super::disturbances_and_faults::{Disturbance, Fault};
use super::file::{CouplingCoordinates, IntegralKind, ObserverStart};
use super::kinds::DisturbanceKind;
use super::quantity::RandomQuantity;
use crate::agent::{ActuationKind, Agent, ChannelGroup, ChannelRole};
use crate::reference::Reference;
use crate::synthesis::{ChannelDesign, Sensors};
use std::ops::{Deref, DerefMut, Range};
use std::path::PathBuf;
use std::sync::Arc;

/// A group of agents of one kind, which may act on each other. Groups of a campaign are simulated in the same episodes
/// and never act on each other, so that a group is all that its episodes need.
#[derive(Debug, Clone)]
pub struct AgentGroup(Arc<GroupParts>);

impl Deref for AgentGroup {
    type Target = GroupParts;

    fn deref(&self) -> &GroupParts {
        &self.0
    }
}

impl AgentGroup {
    pub(super) fn new(parts: GroupParts) -> Self {
        Self(Arc::new(parts))
    }

    /// The same with parts changed by somebody who knows that they fit each other: nothing is checked.
    #[doc(hidden)]
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut GroupParts)) -> Self {
        change(Arc::make_mut(&mut self.0));
        self
    }
}

/// The parts of an [`AgentGroup`].
#[derive(Debug, Clone)]
pub struct GroupParts {
    /// What it has in common with all others.
    pub(super) common: Arc<Common>,
    /// Its name; empty in a file without `[[group]]`.
    pub name: Arc<str>,
    /// The number in the campaign of its first agent.
    pub first_agent: usize,
    /// The number in the campaign of its first disturbance.
    pub first_disturbance: usize,
    /// The number in the campaign of its first fault.
    pub first_fault: usize,
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
    /// The groups of channels that share sensors, if there are any.
    pub sensors: Vec<ChannelSensors>,
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
    /// What counts as failure.
    pub verdict: Verdict,
}

impl Deref for GroupParts {
    type Target = Common;

    fn deref(&self) -> &Common {
        &self.common
    }
}

impl DerefMut for GroupParts {
    fn deref_mut(&mut self) -> &mut Common {
        Arc::make_mut(&mut self.common)
    }
}

/// Channels of one unit of a group of agents, as a campaign's statistics name them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelsOfCampaign {
    /// The group of agents, by index.
    pub group: usize,
    /// Their name: that of the role, with the group's in front where it has one.
    pub name: Arc<str>,
    /// What they are.
    pub role: ChannelRole,
    /// Which of an agent's channels.
    pub channels: Range<usize>,
    /// Which of the group's channel groups.
    pub place: usize,
}

impl GroupParts {
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

    /// A name with that of the group in front, where it has one.
    #[must_use]
    pub fn titled(&self, name: &str) -> String {
        match &*self.name {
            "" => name.to_string(),
            group => format!("{group} {name}"),
        }
    }

    /// What its agents are called, with their number, and its name where it has one.
    #[must_use]
    pub fn in_words(&self) -> String {
        let noun = self.agent.noun(self.team);
        match &*self.name {
            "" => format!("{} {noun}", self.team),
            name => format!("{} {noun} ({name})", self.team),
        }
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
    /// Smallest ratio of two controllers' errors that counts as a difference, at least 1.
    pub smallest_ratio: f64,
    /// RMS errors below this, m or rad, count as equal to it in comparisons.
    pub smallest_error: f64,
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
    /// How the controller "pid-placed" is placed.
    pub placed: PidPlaced,
    /// Additional controllers.
    pub named: Vec<NamedGains>,
}

/// The sensors of a group of channels that share some.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSensors {
    /// Name of the group: "position", "attitude", "left-leg" or "right-leg".
    pub name: &'static str,
    /// Which of the agent's channel groups has its weights.
    pub place: usize,
    /// The sensors.
    pub sensors: Sensors,
}

/// How the controller "pid-placed" is placed.
#[derive(Debug, Clone, PartialEq)]
pub struct PidPlaced {
    /// The poles of its error.
    pub poles: PlacedPoles,
    /// The poles of its observer, rad/s.
    pub observer_rad_s: f64,
}

/// Where the poles of "pid-placed" are.
#[derive(Debug, Clone, PartialEq)]
pub enum PlacedPoles {
    /// At this, rad/s.
    At(f64),
    /// Where its delay margin is that of this controller, which is synthesized; channel group by channel group.
    DelayMarginOf(String),
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
