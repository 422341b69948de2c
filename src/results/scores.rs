//! How episodes ended, and the numbers that the statistics of a run read.

use crate::campaign::AgentGroup;
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use serde::Serialize;

/// How an agent or an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Within the limits.
    Ok,
    /// Finite, but a limit of the verdict was broken.
    Exceeded,
    /// Left the numbers; ranks worst in every comparison.
    Diverged,
}

impl Status {
    /// The word in the tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Exceeded => "exceeded",
            Self::Diverged => "diverged",
        }
    }
}

/// What the verdict of a group makes of an agent's outcome.
#[must_use]
pub fn status(group: &AgentGroup, outcome: &AgentOutcome) -> Status {
    // max_error was judged step by step, in the precision of the loop.
    let too_large = |(channel, metrics): (usize, &ChannelOutcome)| {
        metrics.rmse > group.verdict.max_rmse[channel]
    };
    if outcome.diverged {
        Status::Diverged
    } else if outcome.failed_step.is_some() || outcome.channels.iter().enumerate().any(too_large) {
        Status::Exceeded
    } else {
        Status::Ok
    }
}

/// The numbers that the statistics of a run read. Episodes are in order; so are groups, controllers, agents and
/// channels.
#[derive(Debug, Clone, Default)]
pub struct Scores {
    /// Worst status of all agents, `[controller][episode]`.
    pub status: Vec<Vec<Status>>,
    /// Of each group of agents.
    pub groups: Vec<GroupScores>,
    /// Whether an agent of the episode has the fault, `[fault][episode]`; faults are numbered through all groups.
    pub fault_occurs: Vec<Vec<bool>>,
    /// What each episode met: the name of a condition, and its size by episode ([`crate::draw::quantities`]).
    pub conditions: Vec<(String, Vec<Option<f64>>)>,
}

/// The numbers of one group of agents.
#[derive(Debug, Clone, Default)]
pub struct GroupScores {
    /// Worst status of its agents, `[controller][episode]`.
    pub status: Vec<Vec<Status>>,
    /// RMS error, `[controller]` then episode, agent, channel in one list.
    pub rmse: Vec<Vec<f64>>,
    /// Largest error, laid out like `rmse`.
    pub max_abs: Vec<Vec<f64>>,
    /// Step in which an agent broke max_error or left the numbers, `[controller]` then episode, agent in one list.
    pub failed_step: Vec<Vec<Option<u32>>>,
    /// What else they showed, `[controller]` then episode, channel group in one list.
    pub channel_groups: Vec<Vec<ChannelGroupScores>>,
}

/// What a group of agents showed on a channel group of an episode, beside its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelGroupScores {
    /// The largest |u| of any agent and channel, N or N m; infinite, as the effort is, where an agent diverged.
    pub peak: f64,
    /// The integral of u^2, in the mean over agents and channels.
    pub effort: f64,
    /// The largest share of the steps at a limit of any agent and channel; not a number where an agent diverged.
    pub saturated: f64,
    /// When the last agent and channel was settled, s; infinite where one did not settle.
    pub settling_s: f64,
    /// How long after the first fault of an agent its channels were settled again, s, at the longest; infinite where
    /// one did not settle, not a number where no fault began later than the episode.
    pub recovery_s: f64,
}

/// What one channel of an agent showed, beside its error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChannelScores {
    pub(crate) peak: f64,
    pub(crate) effort: f64,
    pub(crate) saturated: f64,
    /// Infinite where it did not settle.
    pub(crate) settling_s: f64,
    /// Infinite where it did not settle again; none where no fault began.
    pub(crate) recovery_s: Option<f64>,
}

impl ChannelGroupScores {
    /// Of all channels of all agents.
    pub(crate) fn of(channels: impl Iterator<Item = ChannelScores>) -> Self {
        let mut all = Self {
            peak: 0.0,
            effort: 0.0,
            saturated: 0.0,
            settling_s: 0.0,
            recovery_s: f64::NAN,
        };
        let mut count = 0.0;
        for own in channels {
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
    pub(crate) const DIVERGED: Self = Self {
        peak: f64::INFINITY,
        effort: f64::INFINITY,
        saturated: f64::NAN,
        settling_s: f64::INFINITY,
        recovery_s: f64::INFINITY,
    };
}

impl Scores {
    /// Episodes so far.
    #[must_use]
    pub fn episodes(&self) -> usize {
        self.status.first().map_or(0, Vec::len)
    }
}

impl GroupScores {
    /// Of so many controllers, nothing yet.
    pub(crate) fn new(controllers: usize) -> Self {
        Self {
            status: vec![Vec::new(); controllers],
            rmse: vec![Vec::new(); controllers],
            max_abs: vec![Vec::new(); controllers],
            failed_step: vec![Vec::new(); controllers],
            channel_groups: vec![Vec::new(); controllers],
        }
    }

    /// Whether these are an episode's numbers, to the last digit: its agents' errors under a controller. Numbers that
    /// are none are all alike.
    #[must_use]
    pub fn holds(&self, controller: usize, episode: u32, agents: &[AgentOutcome]) -> bool {
        let stride = agents
            .iter()
            .map(|agent| agent.channels.len())
            .sum::<usize>();
        let rows = episode as usize * stride..(episode as usize + 1) * stride;
        let same = |kept: &[f64], pick: fn(&ChannelOutcome) -> f64| {
            let again = agents.iter().flat_map(|agent| &agent.channels).map(pick);
            let kept = kept.get(rows.clone()).unwrap_or_default();
            kept.len() == stride
                && kept.iter().zip(again).all(|(kept, again)| {
                    kept.to_bits() == again.to_bits() || kept.is_nan() && again.is_nan()
                })
        };
        same(&self.rmse[controller], |metrics| metrics.rmse)
            && same(&self.max_abs[controller], |metrics| metrics.max_abs)
    }
}
