//! The parameters of disturbances, faults and initial errors: their names, bounds and defaults.

use super::time::Timing;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Who shares a draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SamplingScope {
    /// All agents and channels of an episode.
    Episode,
    /// All channels of an agent.
    Agent,
    /// Nobody.
    Channel,
}

impl SamplingScope {
    /// The name in a campaign file.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Episode => "episode",
            Self::Agent => "agent",
            Self::Channel => "channel",
        }
    }
}

/// The values that a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bounds {
    Any,
    NonNegative,
    Positive,
    /// From 0 to 1.
    Share,
    /// More than 0, at most 1.
    Chance,
    /// From a smallest value on.
    AtLeast(f64),
    /// From a smallest value to a largest.
    Between(f64, f64),
}

impl Bounds {
    pub(super) fn broken_by(self, low: f64, high: f64) -> Option<String> {
        let limit = match self {
            Self::NonNegative if low < 0.0 => "must not be negative".into(),
            Self::Positive if low <= 0.0 => "must be positive".into(),
            Self::Share if low < 0.0 || high > 1.0 => "must lie within [0, 1]".into(),
            Self::Chance if low <= 0.0 || high > 1.0 => "must be more than 0 and at most 1".into(),
            Self::Between(least, most) if low < least || high > most => {
                format!("must lie within [{least}, {most}]")
            }
            Self::AtLeast(least) if low < least => format!("must be at least {least:e}"),
            _ => return None,
        };
        Some(limit)
    }
}

/// A parameter of a disturbance or fault.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its key in the file and its column in the tables.
    pub name: &'static str,
    pub(super) default: Option<f64>,
    pub(super) bounds: Bounds,
    /// Who shares a draw, if the file does not say it: each channel has its own, or the agent one.
    pub(super) per: SamplingScope,
    /// What steps make of its values.
    pub timing: Timing,
    pub(super) resolution: Option<Resolution>,
}

/// What of a parameter the step or the memory of an episode has to resolve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Resolution {
    /// The length of a period, s.
    Period,
    /// An angular frequency, rad/s.
    Frequency,
    /// How far back something reaches, s.
    Memory,
}

impl Parameter {
    /// The same with a value where the file gives none.
    pub(super) const fn or(self, default: f64) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }

    /// The same as a time.
    pub(super) const fn timed(self, timing: Timing) -> Self {
        Self { timing, ..self }
    }

    /// The same with what has to be resolved of it.
    pub(super) const fn resolved(self, resolution: Resolution) -> Self {
        Self {
            resolution: Some(resolution),
            ..self
        }
    }

    /// Whether it says how far back something reaches, s.
    pub(crate) fn is_remembered(&self) -> bool {
        self.resolution == Some(Resolution::Memory)
    }

    /// Its place among the parameters of a kind.
    pub(crate) fn place_in(&self, parameters: &[Self]) -> Option<usize> {
        let mut names = parameters.iter().map(|parameter| parameter.name);
        names.position(|name| name == self.name)
    }

    /// Its value on a channel among those drawn for a kind, `[parameter][channel]`; not a number if the kind has no
    /// such parameter, which would be a mistake of whoever asks that no episode survives.
    pub(crate) fn value(&self, parameters: &[Self], drawn: &[Vec<f64>], channel: usize) -> f64 {
        let place = self.place_in(parameters);
        place.map_or(f64::NAN, |place| drawn[place][channel])
    }
}

/// A parameter of each channel that has to be given.
pub(super) const fn required(name: &'static str, bounds: Bounds) -> Parameter {
    Parameter {
        name,
        default: None,
        bounds,
        per: SamplingScope::Channel,
        timing: Timing::AsDrawn,
        resolution: None,
    }
}

/// A parameter of the whole agent that has to be given.
pub(super) const fn of_agent(name: &'static str, bounds: Bounds) -> Parameter {
    Parameter {
        name,
        default: None,
        bounds,
        per: SamplingScope::Agent,
        timing: Timing::AsDrawn,
        resolution: None,
    }
}
