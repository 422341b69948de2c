//! A campaign: everything that decides the result of a run, checked, in SI units, with nothing optional left.

mod check;
pub mod distribution;
pub mod error;
pub mod file;
mod kinds;
pub mod lints;
mod plan;
mod validate;

pub use check::Parameter;
pub use distribution::Distribution;
pub use error::CampaignError;
pub use file::{
    CouplingCoordinates, DisturbanceKind, FaultKind, FaultTarget, IntegralKind, Link,
    ObserverStart, SamplingScope,
};
pub use plan::{ALL, Goal, Sampling, Stop, Strata, Stratum, StratumFaults};

use crate::agent::{ActuationKind, Agent, ChannelGroup};
use crate::reference::Reference;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the paper's fault-tolerant controller.
pub const FTC: &str = "ftc";
/// Name of the PID computed-torque controller, the paper's text read plainly.
pub const PID: &str = "pid";
/// Name of the PID whose observer distrusts the faulty velocity channel.
pub const PID_TUNED: &str = "pid-tuned";

/// A validated campaign.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// The file, as it was named on the command line.
    pub path: PathBuf,
    /// The file's text.
    pub text: String,
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
    channels: Vec<Arc<str>>,
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

impl Campaign {
    /// Reads and checks a campaign file.
    ///
    /// # Errors
    /// The first thing that is wrong with it, with file, key, value, limit and remedy.
    pub fn load(path: &Path) -> Result<Self, CampaignError> {
        let text = std::fs::read_to_string(path).map_err(|source| CampaignError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        let campaign = Self::parse(&text, path)?;
        campaign.require_files()?;
        Ok(campaign)
    }

    /// Refuses a campaign whose gains files are not there. A run's campaign is parsed again without this: its gains are in
    /// the run's own directory.
    fn require_files(&self) -> Result<(), CampaignError> {
        let own = self
            .synthesis
            .gains
            .iter()
            .map(|path| ("synthesis.gains".to_string(), path));
        let named = &self.synthesis.named;
        let of_named = named.iter().map(|named| {
            (
                format!("synthesis.named.{}.gains", named.name),
                &named.gains,
            )
        });
        let check = check::Check {
            path: &self.path,
            text: &self.text,
            channels: Vec::new(),
        };
        match own.chain(of_named).find(|(_, path)| !path.is_file()) {
            Some((key, path)) => {
                let limit = if path.is_dir() {
                    "a directory, not a file"
                } else {
                    "no such file"
                };
                // As it was written: beside the campaign.
                let folder = self.path.parent().unwrap_or(Path::new(""));
                let name = path.strip_prefix(folder).unwrap_or(path);
                Err(check.invalid(
                    key,
                    format!("{:?}", name.display().to_string()),
                    limit,
                    "name a gains.json, relative to the campaign",
                ))
            }
            None => Ok(()),
        }
    }

    /// Checks the text of a campaign file; `path` is for messages and for the files that it names.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, CampaignError> {
        Self::parse_with_robot(text, path, None)
    }

    /// The same with the text of the robot's file, where that is at hand and the file may not be there.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn parse_with_robot(
        text: &str,
        path: &Path,
        robot: Option<&str>,
    ) -> Result<Self, CampaignError> {
        let file = toml::from_str(text).map_err(|error| error::syntax(path, &error))?;
        validate::validate(file, text, path, robot)
    }

    /// Flies another number of episodes than the file's.
    ///
    /// # Errors
    /// If the sampling design cannot divide so many into equal replicates.
    pub fn set_episodes(&mut self, episodes: u32) -> Result<(), CampaignError> {
        let check = check::Check {
            path: &self.path,
            text: &self.text,
            channels: Vec::new(),
        };
        check.divides(self.sampling, episodes)?;
        self.episodes = episodes;
        Ok(())
    }

    /// The JSON Schema of the campaign file.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(file::CampaignFile).to_value()
    }

    /// Names of the channels of one agent, in the order of every table and list.
    #[must_use]
    pub fn channels(&self) -> &[Arc<str>] {
        &self.channels
    }

    /// The groups of channels whose errors may be averaged: metres and radians are never mixed. Each has gains of its own.
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

/// Duration and step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// Integration step, s.
    pub step_s: f64,
    /// Steps of an episode.
    pub steps: u32,
    /// First step of the metrics.
    pub settle_step: u32,
}

impl Time {
    /// The step at which a fault of this onset begins; t = k dt is never accumulated, and a hair below a step belongs
    /// to it.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "onsets are validated to lie in the run"
    )]
    pub fn onset_step(&self, onset_s: f64) -> u32 {
        (onset_s / self.step_s - 1e-9).ceil().max(0.0) as u32
    }

    /// The time of a step's beginning, s, as people write it: 0.3, not 0.30000000000000004.
    #[must_use]
    pub fn shown_s(&self, step: u32) -> f64 {
        file::without_dust(f64::from(step) * self.step_s)
    }

    /// A length of time in steps: the nearest number of them, at least one.
    #[must_use]
    pub fn whole_steps(&self, length_s: f64) -> f64 {
        (length_s / self.step_s).round().max(1.0)
    }
}

/// A random quantity of each agent and channel: who shares a draw, and each one's distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomQuantity {
    /// Who shares a draw.
    pub per: SamplingScope,
    /// Channels per agent (1 for a quantity of the agent).
    pub channels: usize,
    /// Distribution of each agent and channel, agent by agent.
    pub distributions: Vec<Distribution>,
}

impl RandomQuantity {
    /// The distribution of an agent's channel.
    #[must_use]
    pub fn of(&self, agent: usize, channel: usize) -> &Distribution {
        &self.distributions[agent * self.channels + channel]
    }

    /// Whether it is zero in every episode.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.distributions.iter().all(|d| d.support() == (0.0, 0.0))
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
    /// Whether some faults begin inside the run rather than with it.
    #[must_use]
    pub fn begins_later(&self) -> bool {
        self.onset_s
            .distributions
            .iter()
            .any(|onset| onset.support().1 > 0.0)
    }

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
    /// The stratum in which it has to, or [`ALL`] episodes.
    pub stratum: Arc<str>,
    /// Upper limit of the one-sided 95 % bound of the failure rate: Clopper-Pearson's, or that of the confidence sequence where
    /// `[stop]` decides on the number of episodes.
    pub failure_rate_upper_95: f64,
}

/// Where the gains come from.
#[derive(Debug, Clone, PartialEq)]
pub struct GainSource {
    /// Weights of each channel group.
    pub designs: Vec<crate::synthesis::ChannelDesign>,
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
