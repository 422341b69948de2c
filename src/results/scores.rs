//! How episodes ended, and the numbers that the statistics of a run read.

use crate::campaign::AgentGroup;
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use serde::Serialize;
use std::ops::Range;

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
    /// What the commands were, `[controller]` then episode, channel group in one list.
    pub commands: Vec<Vec<CommandScores>>,
}

/// What the commands of a group of agents were on a channel group of an episode.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CommandScores {
    /// The largest |u| of any agent and channel, N or N m; infinite, as the effort is, where an agent diverged.
    pub peak: f64,
    /// The integral of u^2, in the mean over agents and channels.
    pub effort: f64,
    /// The largest share of the steps at a limit of any agent and channel; not a number where an agent diverged.
    pub saturated: f64,
}

impl CommandScores {
    /// Of some channels of all agents; infinite where an agent diverged.
    pub(super) fn of<'a>(
        outcomes: impl Iterator<Item = &'a AgentOutcome>,
        channels: Range<usize>,
    ) -> Self {
        let mut all = Self::default();
        let mut count = 0.0;
        for outcome in outcomes {
            if outcome.diverged {
                return Self {
                    peak: f64::INFINITY,
                    effort: f64::INFINITY,
                    saturated: f64::NAN,
                };
            }
            for metrics in &outcome.channels[channels.clone()] {
                all.peak = all.peak.max(metrics.u_max);
                all.effort += metrics.effort;
                all.saturated = all.saturated.max(metrics.saturated_fraction);
                count += 1.0;
            }
        }
        all.effort /= count;
        all
    }
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
    pub(super) fn new(controllers: usize) -> Self {
        Self {
            status: vec![Vec::new(); controllers],
            rmse: vec![Vec::new(); controllers],
            max_abs: vec![Vec::new(); controllers],
            failed_step: vec![Vec::new(); controllers],
            commands: vec![Vec::new(); controllers],
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
