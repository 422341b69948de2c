//! How an agent fared in an episode, and what the verdict makes of it.

use crate::campaign::AgentGroup;
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use serde::Serialize;

/// How an agent or an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
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

/// How an agent fared in an episode.
#[derive(Debug, Clone)]
pub struct AgentScores {
    /// How it ended.
    pub status: Status,
    /// Step in which it broke max_error or left the numbers.
    pub failed_step: Option<u32>,
    /// What each of its channels showed.
    pub channels: Vec<ChannelScores>,
}

/// What one channel of an agent showed.
#[derive(Debug, Clone, Copy)]
pub struct ChannelScores {
    /// RMS error.
    pub rmse: f64,
    /// The largest |e|.
    pub max_abs: f64,
    /// The largest |u|.
    pub peak: f64,
    /// The integral of u^2.
    pub effort: f64,
    /// Share of the steps at a limit.
    pub saturated: f64,
    /// When it was settled, s; infinite where it did not.
    pub settling_s: f64,
    /// How long after the first fault it was settled again, s; infinite where it was not, none where no fault began.
    pub recovery_s: Option<f64>,
}
