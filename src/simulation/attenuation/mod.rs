//! The attenuation that an episode under the fault-tolerant controller shows, inequality (24) of the paper, beside the
//! level that its gains certify.
//!
#![doc = include_str!("README.md")]

mod applicability;
mod channel;

pub use applicability::{NotApplicable, is_smooth, obstacle};
pub use channel::{Attenuation, AttenuationInequality, Sample, Stretch};

use crate::agent::ChannelGroup;
use crate::backend::cpu::{Cpu, Precision};
use crate::campaign::AgentGroup;
use crate::controllers::{ChannelController, GainSet, SimulatedController};
use crate::draw::{Episode, draw};
use crate::model::episode::Snapshot;
use crate::synthesis::{ChannelDesign, poles};
use serde::{Deserialize, Serialize};

/// A pole times a step at which the central differences of its decay are right to 2 %.
const RESOLVED: f64 = 0.25;

/// What inequality (24) says, for readers without the paper.
pub const INEQUALITY: &str = "(24) of the paper: weighted errors and control effort are at most the square of the attenuation level times \
     the energy of the model error (the effect of faults, disturbances and wrong parameters), plus V(0) for the initial \
     state";

/// What (24) says about each channel of an episode, `[agent][channel]`.
pub type Attenuations = Vec<Vec<Result<Attenuation, NotApplicable>>>;

/// The trajectory of an episode in double precision, as (24) needs it.
#[derive(Debug, Default)]
pub struct Trajectory {
    /// The episode at every step.
    pub whole: Vec<Snapshot>,
    /// Its start at every step of a [`Start`], where the campaign's own step does not resolve it.
    pub start: Vec<Snapshot>,
}

/// The start of an episode in smaller steps: the fast poles of the loop make f1 move within a few milliseconds there,
/// and the taps repeat that until the last of them has begun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Steps for each of the campaign's.
    finer: u32,
    /// Steps of the campaign that it lasts.
    steps: u32,
}

impl Start {
    /// The start under a controller; none where the campaign's step resolves it.
    #[must_use]
    pub fn of(group: &AgentGroup, controller: &SimulatedController) -> Option<Self> {
        let poles = controller
            .groups
            .iter()
            .flat_map(|own| poles(&own.loop_gains));
        let fastest = poles.map(|pole| pole.norm()).fold(0.0, f64::max);
        let finer = (fastest * group.time.step_s / RESOLVED).ceil();
        let last_tap = |design: &ChannelDesign| {
            let [taps1, taps2] = design.smoothing.taps();
            taps1.max(taps2) as f64 * design.smoothing.spacing_s
        };
        let lasts_s = controller.groups.iter().map(|own| last_tap(&own.design));
        let steps = group.time.onset_step(lasts_s.fold(0.0, f64::max));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a step at which the integration is stable is at most three times what resolves it"
        )]
        (finer > 1.0).then_some(Self {
            finer: finer as u32,
            steps: steps.min(group.time.steps),
        })
    }

    /// A group of agents whose episodes are the start and nothing more. What is drawn stays the same.
    #[must_use]
    pub fn group(self, whole: &AgentGroup) -> AgentGroup {
        whole.clone().with(|group| {
            group.time.step_s /= f64::from(self.finer);
            group.time.steps = self.finer * self.steps;
            group.time.settle_step = 0;
        })
    }
}

/// A controller whose episodes (24) is asked about.
pub struct AttenuationAnalysis<'a> {
    group: &'a AgentGroup,
    controller: &'a SimulatedController,
    index: usize,
    /// Of each channel group.
    inequalities: Vec<Result<AttenuationInequality, NotApplicable>>,
    start: Option<Start>,
    /// What simulates the start.
    simulator: Option<Cpu>,
}

impl<'a> AttenuationAnalysis<'a> {
    /// Prepares controller number `index` of `gains`.
    #[must_use]
    pub fn new(group: &'a AgentGroup, gains: &'a GainSet, index: usize) -> Self {
        let controller = &gains.controllers[index];
        let start = Start::of(group, controller).filter(|_| controller.is_certified());
        let simulator = start.map(|start| {
            let group = start.group(group);
            Cpu::new(&group, &gains.loops(), Precision::F64, None)
        });
        Self {
            group,
            controller,
            index,
            inequalities: controller.groups.iter().map(inequality).collect(),
            start,
            simulator,
        }
    }

    /// What (24) says about an episode; `whole`, its trajectory at every step in double precision, is asked for only
    /// where there may be something to say.
    #[must_use]
    pub fn of_episode(&self, episode: u32, whole: impl FnOnce() -> Vec<Snapshot>) -> Attenuations {
        let drawn = draw(self.group, episode);
        let known = self.known(&drawn);
        let trajectory = if known.iter().flatten().any(Result::is_ok) {
            let start = self.simulator.as_ref();
            Trajectory {
                whole: whole(),
                start: start.map_or(Vec::new(), |cpu| cpu.trace(episode, self.index, 1).1),
            }
        } else {
            Trajectory::default()
        };
        self.judge(&drawn, &trajectory)
    }

    /// What (24) says about an episode with this trajectory.
    #[must_use]
    pub fn judge(&self, episode: &Episode, trajectory: &Trajectory) -> Attenuations {
        let step_s = self.group.time.step_s;
        let of_channel = |agent, channel, inequality: &AttenuationInequality| {
            let samples = |snapshots: &[Snapshot]| -> Vec<Sample> {
                let of_instant = |snapshot| sample(snapshot, agent, channel);
                snapshots.iter().map(of_instant).collect()
            };
            let (whole, first) = (samples(&trajectory.whole), samples(&trajectory.start));
            let stretch = |samples, step_s, from| Stretch {
                step_s,
                samples,
                from,
            };
            match self.start {
                None => inequality.attenuation(&[stretch(&whole, step_s, 0)]),
                Some(Start { finer, steps }) => inequality.attenuation(&[
                    stretch(&first, step_s / f64::from(finer), 0),
                    stretch(&whole, step_s, steps as usize),
                ]),
            }
        };
        let of_agent =
            |(agent, channels): (usize, Vec<Result<&AttenuationInequality, NotApplicable>>)| {
                let channels = channels.into_iter().enumerate();
                channels
                    .map(|(channel, inequality)| of_channel(agent, channel, inequality?))
                    .collect()
            };
        let known = self.known(episode).into_iter().enumerate();
        known.map(of_agent).collect()
    }

    /// The inequality of each channel, or what is known before the simulation to keep it from saying anything:
    /// `[agent][channel]`.
    fn known(&self, episode: &Episode) -> Vec<Vec<Result<&AttenuationInequality, NotApplicable>>> {
        let of_channel = |agent: usize, channel: usize| {
            let channels = self.group.group_of(channel);
            let inequality = self.inequalities[channels].as_ref().map_err(Clone::clone)?;
            obstacle(self.group, &episode.agents[agent], channel).map_or(Ok(inequality), Err)
        };
        let channels = self.group.channels().len();
        let of_agent = |agent| {
            (0..channels)
                .map(|channel| of_channel(agent, channel))
                .collect()
        };
        (0..self.group.team).map(of_agent).collect()
    }

    /// Sums up what it says about some episodes, a row per channel group.
    #[must_use]
    pub fn by_group(&self, episodes: &[Attenuations]) -> Vec<GroupAttenuation> {
        let channels = self.group.channel_groups().into_iter();
        let name = &self.controller.name;
        channels
            .zip(&self.controller.groups)
            .map(|(channels, own)| GroupAttenuation::of(self.group, name, &channels, own, episodes))
            .collect()
    }
}

fn inequality(own: &ChannelController) -> Result<AttenuationInequality, NotApplicable> {
    if own.gains.is_pid() {
        return Err(NotApplicable::NoEstimate);
    }
    let certificate = own.certificate().ok_or(NotApplicable::NoCertificate)?;
    AttenuationInequality::new(&own.design, &own.gains, certificate)
}

fn sample(snapshot: &Snapshot, agent: usize, channel: usize) -> Sample {
    let shown = &snapshot.agents[agent][channel];
    let held = &snapshot.internals[agent][channel];
    Sample {
        error: [held.integral, shown.e, shown.e_rate],
        estimate: held.observer,
        faults: [shown.f1, shown.f2],
        applied_feedback: held.applied_feedback,
    }
}

/// What (24) says about one channel group of some episodes under one controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupAttenuation {
    /// The controller.
    pub controller: String,
    /// The channels.
    pub group: String,
    /// Channels of agents of episodes that were looked at.
    pub flown: usize,
    /// Those among them to which (24) applies.
    pub applicable: usize,
    /// Those among these for which it does not hold.
    pub violated: usize,
    /// Largest level among them; none if it applies to none.
    pub largest: Option<f64>,
    /// The certified level.
    pub certified: Option<f64>,
    /// Why it does not apply to the first to which it does not.
    pub obstacle: Option<String>,
}

impl GroupAttenuation {
    fn of(
        group: &AgentGroup,
        controller: &str,
        channels: &ChannelGroup,
        own: &ChannelController,
        episodes: &[Attenuations],
    ) -> Self {
        let agents = episodes.iter().flatten();
        let all: Vec<_> = agents
            .flat_map(|all| &all[channels.channels.clone()])
            .collect();
        let applicable = || all.iter().filter_map(|found| found.as_ref().ok());
        let mut obstacles = all.iter().filter_map(|found| found.as_ref().err());
        Self {
            controller: controller.to_string(),
            group: group.titled(channels.role.name()),
            flown: all.len(),
            applicable: applicable().count(),
            violated: applicable().filter(|found| !found.holds()).count(),
            largest: applicable().map(Attenuation::level).reduce(f64::max),
            certified: own.certificate().map(|certificate| certificate.rho),
            obstacle: obstacles.next().map(ToString::to_string),
        }
    }
}
