//! The numbers that the statistics of a run read.

use super::bad_episode::BadEpisode;
use crate::agent::ChannelGroup;
use crate::campaign::{AgentGroup, Campaign, Time};
use crate::model::episode::AgentOutcome;
use crate::statistics::rms;
use std::cmp::Ordering;
use std::hash::{DefaultHasher, Hash, Hasher};

pub use super::agent_scores::{AgentScores, ChannelScores, Status, status};

/// Worst episodes that are remembered of each controller.
const WORST: usize = 10;

/// The numbers that the statistics of a run read: of a team's episode, not of each agent. Episodes are in order; so are
/// groups, controllers and channels.
#[derive(Debug, Clone, Default)]
pub struct Scores {
    /// Worst status of all agents, `[controller][episode]`.
    pub status: Vec<Vec<Status>>,
    /// Step in which the first agent broke max_error or left the numbers, `[controller][episode]`.
    pub failed_step: Vec<Vec<Option<u32>>>,
    /// Of each controller the worst episodes, the worst first.
    pub(super) worst: Vec<Vec<BadEpisode>>,
    /// Of each group of agents.
    pub groups: Vec<GroupScores>,
    /// Whether an agent of the episode has the fault, `[fault][episode]`; faults are numbered through all groups.
    pub fault_occurs: Vec<Vec<bool>>,
    /// What each episode met: the name of a condition, and its size by episode ([`crate::draw::quantities`]); not a
    /// number where it does not apply.
    pub conditions: Vec<(String, Vec<f64>)>,
}

/// The numbers of one group of agents.
#[derive(Debug, Clone, Default)]
pub struct GroupScores {
    /// Worst status of its agents, `[controller][episode]`.
    pub status: Vec<Vec<Status>>,
    /// RMS error over the agents, `[controller]` then episode, channel in one list; infinite where an agent diverged.
    pub rmse: Vec<Vec<f64>>,
    /// What they showed on channel groups, `[controller]` then episode, channel group in one list.
    pub channel_groups: Vec<Vec<ChannelGroupScores>>,
    /// What tells how each agent ended, and every error of it, from others to the last digit, `[controller][episode]`.
    pub fingerprint: Vec<Vec<u64>>,
}

/// What a group of agents showed on a channel group of an episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelGroupScores {
    /// RMS error over agents and channels; infinite, as all these numbers are, where an agent diverged.
    pub rmse: f64,
    /// The largest |e| of any agent and channel.
    pub max_abs: f64,
    /// The largest |u| of any agent and channel, N or N m.
    pub peak: f64,
    /// The integral of u^2, in the mean over agents and channels.
    pub effort: f64,
    /// The largest share of the steps at a limit of any agent and channel.
    pub saturated: f64,
    /// When the last agent and channel was settled, s; infinite where one did not settle.
    pub settling_s: f64,
    /// How long after the first fault of an agent its channels were settled again, s, at the longest; infinite where
    /// one did not settle, not a number where no fault began later than the episode.
    pub recovery_s: f64,
}

impl ChannelGroupScores {
    /// Of all channels of all agents.
    fn of<'a>(channels: impl Iterator<Item = &'a ChannelScores> + Clone) -> Self {
        let mut all = Self {
            rmse: rms(channels.clone().map(|own| own.rmse)),
            max_abs: 0.0,
            peak: 0.0,
            effort: 0.0,
            saturated: 0.0,
            settling_s: 0.0,
            recovery_s: f64::NAN,
        };
        let mut count = 0.0;
        for own in channels {
            all.max_abs = all.max_abs.max(own.max_abs);
            all.peak = all.peak.max(own.peak);
            all.effort += own.effort;
            all.saturated = all.saturated.max(own.saturated);
            all.settling_s = all.settling_s.max(own.settling_s);
            // What is not a number is less than every other number here.
            all.recovery_s = all.recovery_s.max(own.recovery_s.unwrap_or(f64::NAN));
            count += 1.0;
        }
        all.effort /= count;
        all
    }

    /// Where an agent diverged.
    const DIVERGED: Self = Self {
        rmse: f64::INFINITY,
        max_abs: f64::INFINITY,
        peak: f64::INFINITY,
        effort: f64::INFINITY,
        saturated: f64::INFINITY,
        settling_s: f64::INFINITY,
        recovery_s: f64::INFINITY,
    };
}

impl Scores {
    /// Of a campaign, nothing yet; of its conditions and faults not even the names.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        let controllers = campaign.controllers.len();
        let group = GroupScores {
            status: vec![Vec::new(); controllers],
            rmse: vec![Vec::new(); controllers],
            channel_groups: vec![Vec::new(); controllers],
            fingerprint: vec![Vec::new(); controllers],
        };
        Self {
            status: vec![Vec::new(); controllers],
            failed_step: vec![Vec::new(); controllers],
            worst: vec![Vec::new(); controllers],
            groups: vec![group; campaign.groups().len()],
            fault_occurs: Vec::new(),
            conditions: Vec::new(),
        }
    }

    /// Episodes so far.
    #[must_use]
    pub fn episodes(&self) -> usize {
        self.status.first().map_or(0, Vec::len)
    }

    /// Bytes of the numbers that grow with the episodes.
    #[must_use]
    pub(super) fn bytes(&self) -> usize {
        fn of<T>(lists: &[Vec<T>]) -> usize {
            lists.iter().map(|own| size_of_val(own.as_slice())).sum()
        }
        let of_group = |own: &GroupScores| {
            let numbers = of(&own.rmse) + of(&own.channel_groups);
            of(&own.status) + numbers + of(&own.fingerprint)
        };
        let conditions = self.conditions.iter();
        let conditions: usize = conditions.map(|(_, own)| size_of_val(own.as_slice())).sum();
        of(&self.status)
            + of(&self.failed_step)
            + of(&self.fault_occurs)
            + conditions
            + self.groups.iter().map(of_group).sum::<usize>()
    }

    /// Step in which an episode failed under a controller; none where it did not. What breaks a limit of the RMS error
    /// alone fails at the end.
    pub(super) fn failure(&self, time: Time, controller: usize, episode: usize) -> Option<u32> {
        match self.status[controller][episode] {
            Status::Ok => None,
            _ => Some(self.failed_step[controller][episode].unwrap_or(time.steps)),
        }
    }

    /// The time of that step, s.
    #[must_use]
    pub fn failed_at_s(&self, time: Time, controller: usize, episode: usize) -> Option<f64> {
        let step = self.failure(time, controller, episode)?;
        Some(f64::from(step) * time.step_s)
    }

    /// Adds how the agents of each group fared under a controller in the next episode; how the episode ended.
    pub fn add(
        &mut self,
        campaign: &Campaign,
        controller: usize,
        groups: &[Vec<AgentScores>],
    ) -> Status {
        let agents = || groups.iter().flatten();
        let status = agents().map(|agent| agent.status).max();
        let status = status.unwrap_or(Status::Ok);
        let episode = self.status[controller].len();
        let bad = BadEpisode::new(campaign, (episode, status), groups);
        let worst = &mut self.worst[controller];
        let place = worst.partition_point(|own| own.order(&bad) == Ordering::Less);
        worst.insert(place, bad);
        worst.truncate(WORST);
        self.status[controller].push(status);
        let failed_step = agents().filter_map(|agent| agent.failed_step).min();
        self.failed_step[controller].push(failed_step);
        let all = campaign.groups().iter().zip(groups).zip(&mut self.groups);
        for ((group, agents), scores) in all {
            scores.add(group, controller, agents);
        }
        status
    }

    /// Adds the controllers of other scores of the same episodes.
    pub(crate) fn extend(&mut self, other: Self) {
        self.status.extend(other.status);
        self.failed_step.extend(other.failed_step);
        self.worst.extend(other.worst);
        for (own, other) in self.groups.iter_mut().zip(other.groups) {
            own.status.extend(other.status);
            own.rmse.extend(other.rmse);
            own.channel_groups.extend(other.channel_groups);
            own.fingerprint.extend(other.fingerprint);
        }
    }

    /// Adds the episodes that come next.
    pub(crate) fn append(&mut self, next: Self) {
        fn all<T>(own: &mut [Vec<T>], next: Vec<Vec<T>>) {
            for (own, mut next) in own.iter_mut().zip(next) {
                own.append(&mut next);
            }
        }
        let before = self.episodes();
        for (own, next) in self.worst.iter_mut().zip(next.worst) {
            own.extend(next.into_iter().map(|bad| bad.later(before)));
            own.sort_by(BadEpisode::order);
            own.truncate(WORST);
        }
        all(&mut self.status, next.status);
        all(&mut self.failed_step, next.failed_step);
        all(&mut self.fault_occurs, next.fault_occurs);
        for ((_, own), (_, mut next)) in self.conditions.iter_mut().zip(next.conditions) {
            own.append(&mut next);
        }
        for (own, next) in self.groups.iter_mut().zip(next.groups) {
            all(&mut own.status, next.status);
            all(&mut own.rmse, next.rmse);
            all(&mut own.channel_groups, next.channel_groups);
            all(&mut own.fingerprint, next.fingerprint);
        }
    }

    /// Whether an episode ended the same under two controllers, to the last digit of every error of every agent.
    pub(crate) fn alike(&self, [a, b]: [usize; 2], episode: usize) -> bool {
        let alike = |own: &GroupScores| own.fingerprint[a][episode] == own.fingerprint[b][episode];
        self.groups.iter().all(alike)
    }
}

impl GroupScores {
    fn add(&mut self, group: &AgentGroup, controller: usize, agents: &[AgentScores]) {
        let status = agents.iter().map(|agent| agent.status).max();
        let status = status.unwrap_or(Status::Ok);
        self.status[controller].push(status);
        let diverged = status == Status::Diverged;
        let of_channel = |channel: usize| match diverged {
            true => f64::INFINITY,
            false => rms(agents.iter().map(|agent| agent.channels[channel].rmse)),
        };
        self.rmse[controller].extend((0..group.channels().len()).map(of_channel));
        let of_channels = |own: ChannelGroup| match diverged {
            true => ChannelGroupScores::DIVERGED,
            false => {
                let all = agents.iter();
                ChannelGroupScores::of(all.flat_map(|agent| &agent.channels[own.channels.clone()]))
            }
        };
        let of_channels = group.channel_groups().into_iter().map(of_channels);
        self.channel_groups[controller].extend(of_channels);
        let agents = agents.iter().map(|agent| {
            let channels = agent.channels.iter();
            (agent.status, channels.map(|own| [own.rmse, own.max_abs]))
        });
        self.fingerprint[controller].push(fingerprint(agents));
    }

    /// Whether an episode under a controller is the one whose agents ended so, to the last digit of every error.
    #[must_use]
    pub fn holds(
        &self,
        group: &AgentGroup,
        controller: usize,
        episode: u32,
        agents: &[AgentOutcome],
    ) -> bool {
        let agents = agents.iter().map(|outcome| {
            let channels = outcome.channels.iter();
            let errors = channels.map(|own| [own.rmse, own.max_abs]);
            (status(group, outcome), errors)
        });
        let kept = self.fingerprint[controller].get(episode as usize);
        kept == Some(&fingerprint(agents))
    }
}

/// A number of how agents ended and of all their errors; numbers that are none are all alike.
fn fingerprint(agents: impl Iterator<Item = (Status, impl Iterator<Item = [f64; 2]>)>) -> u64 {
    let mut hasher = DefaultHasher::new();
    for (status, errors) in agents {
        status.hash(&mut hasher);
        for error in errors.flatten() {
            let error = if error.is_nan() { f64::NAN } else { error };
            hasher.write_u64(error.to_bits());
        }
    }
    hasher.finish()
}
