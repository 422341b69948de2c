//! Numbers that a controller is judged by, in the words of a campaign file: `failure_rate`, `rmse position p95`,
//! `delay_margin_ms attitude`.

use crate::util::suggest::did_you_mean;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// A number that a controller is judged by.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// Share of the episodes that fail.
    FailureRate,
    /// Share of the episodes that have not failed at this time.
    Survival {
        /// When, s.
        at_s: f64,
    },
    /// A quantile over the episodes.
    Episodes {
        /// Of which number of an episode.
        number: EpisodeNumber,
        /// On which channels.
        channels: MeasuredChannels,
        /// The share of the episodes that are not above it.
        share: f64,
    },
    /// A number of the loop of one channel.
    Loop {
        /// Which.
        number: LoopNumber,
        /// On which channels.
        channels: MeasuredChannels,
    },
}

/// On which side of a limit something has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At or below it.
    #[default]
    AtMost,
    /// At or above it.
    AtLeast,
}

impl Side {
    /// In two words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::AtMost => "at most",
            Self::AtLeast => "at least",
        }
    }

    /// Whether a value is there.
    #[must_use]
    pub fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::AtMost => value <= limit,
            Self::AtLeast => value >= limit,
        }
    }
}

/// One of [`Campaign::channel_groups`](super::Campaign::channel_groups).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeasuredChannels {
    /// Its place among them.
    pub index: usize,
    /// Its name.
    pub name: Arc<str>,
}

/// Kinds of numbers that are told by their names in campaign files.
macro_rules! named_numbers {
    ($(#[$outer:meta])* $kind:ident { $($(#[$doc:meta])* $variant:ident: $name:literal,)* }) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $kind { $($(#[$doc])* $variant,)* }

        impl $kind {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name in campaign files.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }
    };
}

named_numbers! {
    /// A number of an episode, of all agents on some channels.
    EpisodeNumber {
        /// RMS error over agents and channels, m or rad.
        Rmse: "rmse",
        /// Largest error of any agent and channel, m or rad.
        MaxAbs: "max_abs",
        /// Largest |u| of any agent and channel, N or N m.
        PeakCommand: "peak_command",
        /// Integral of u^2, in the mean over agents and channels.
        Effort: "effort",
        /// Largest share of the steps at a limit of any agent and channel.
        SaturatedShare: "saturated_share",
        /// When the last agent and channel is settled, s; infinite where one does not settle.
        Settling: "settling_s",
        /// How long after the first fault of an agent the last of its channels is settled again, s, of the agent for
        /// which it takes longest; infinite where one does not settle. Episodes without a fault that begins later
        /// than the episode have none.
        Recovery: "recovery_s",
    }
}

named_numbers! {
    /// A number of the loop of a channel.
    LoopNumber {
        /// Smallest dead time that destabilises it, ms.
        DelayMargin: "delay_margin_ms",
        /// Phase margin, degrees.
        PhaseMargin: "phase_margin_deg",
        /// Largest magnitude of the sensitivity.
        SensitivityPeak: "sensitivity_peak",
        /// Largest gain from noise to the feedback acceleration.
        NoisePeak: "noise_peak",
        /// Feedback acceleration from white noise, in the root mean square.
        NoiseH2: "noise_h2",
        /// Certified attenuation level of a controller that estimates the faults.
        CertifiedRho: "certified_rho",
    }
}

/// Name of the share of episodes that fail.
pub(super) const FAILURE_RATE: &str = "failure_rate";
/// Name of the share of episodes that have not failed at a time, which follows.
const SURVIVAL: &str = "survival_at_s";

/// What is wrong with the words of a measure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Misnamed {
    pub(super) limit: String,
    pub(super) remedy: String,
}

impl Measure {
    /// The measures that some words name: one of each channel group where they name none. `groups` are the names of the
    /// campaign's channel groups.
    ///
    /// # Errors
    /// If a word is unknown, or one is missing.
    pub(super) fn parse(words: &str, groups: &[Arc<str>]) -> Result<Vec<Self>, Misnamed> {
        let mut words: Vec<&str> = words.split_whitespace().collect();
        let first = if words.is_empty() {
            ""
        } else {
            words.remove(0)
        };
        if first == SURVIVAL {
            return survival(&words).map(|own| vec![own]);
        }
        let share = words.last().and_then(|last| quantile(last));
        if share.is_some() {
            words.pop();
        }
        let number = EpisodeNumber::ALL.iter().find(|own| own.name() == first);
        let of_loop = LoopNumber::ALL.iter().find(|own| own.name() == first);
        match (number, of_loop, share) {
            (Some(&number), _, Some(share)) => {
                let channels = channels(&words, groups)?.into_iter();
                let of = |channels| Self::Episodes {
                    number,
                    channels,
                    share,
                };
                Ok(channels.map(of).collect())
            }
            (Some(_), _, None) => Err(Misnamed {
                limit: format!("{first} differs from episode to episode"),
                remedy: format!(
                    "say which quantile over the episodes is meant: \"{first} ... p50\" is the median"
                ),
            }),
            (_, Some(&number), None) => {
                let channels = channels(&words, groups)?.into_iter();
                Ok(channels
                    .map(|channels| Self::Loop { number, channels })
                    .collect())
            }
            (None, None, None) if first == FAILURE_RATE && words.is_empty() => {
                Ok(vec![Self::FailureRate])
            }
            (None, None, _) if first != FAILURE_RATE => {
                let of_episodes = EpisodeNumber::ALL.iter().map(|own| own.name());
                let of_loops = LoopNumber::ALL.iter().map(|own| own.name());
                let known: Vec<&str> = of_episodes
                    .chain(of_loops)
                    .chain([FAILURE_RATE, SURVIVAL])
                    .collect();
                Err(Misnamed {
                    limit: format!("a measure begins with one of {}", known.join(", ")),
                    remedy: did_you_mean(first, known, "take one of them"),
                })
            }
            _ => Err(Misnamed {
                limit: format!("{first} has no quantiles, and {FAILURE_RATE} no channels"),
                remedy: "remove the words behind it".to_string(),
            }),
        }
    }

    /// The channels that it is of; none of a number of the whole.
    #[must_use]
    pub fn channels(&self) -> Option<&MeasuredChannels> {
        match self {
            Self::FailureRate | Self::Survival { .. } => None,
            Self::Episodes { channels, .. } | Self::Loop { channels, .. } => Some(channels),
        }
    }

    /// Whether a larger number is the better one.
    #[must_use]
    pub fn larger_is_better(&self) -> bool {
        let of_loop = |number: &LoopNumber| {
            matches!(number, LoopNumber::DelayMargin | LoopNumber::PhaseMargin)
        };
        match self {
            Self::Survival { .. } => true,
            Self::Loop { number, .. } => of_loop(number),
            Self::FailureRate | Self::Episodes { .. } => false,
        }
    }

    /// Whether chance is in it.
    #[must_use]
    pub fn is_of_episodes(&self) -> bool {
        !matches!(self, Self::Loop { .. })
    }

    /// Whether it is a share of the episodes.
    #[must_use]
    pub fn is_rate(&self) -> bool {
        matches!(self, Self::FailureRate | Self::Survival { .. })
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FailureRate => f.write_str(FAILURE_RATE),
            Self::Survival { at_s } => write!(f, "{SURVIVAL} {at_s}"),
            Self::Episodes {
                number,
                channels,
                share,
            } => {
                write!(f, "{} {} p{}", number.name(), channels.name, 100.0 * share)
            }
            Self::Loop { number, channels } => write!(f, "{} {}", number.name(), channels.name),
        }
    }
}

/// The share of the episodes that have not failed at the time that some words name.
fn survival(words: &[&str]) -> Result<Measure, Misnamed> {
    let at_s = match words {
        [word] => word
            .parse()
            .ok()
            .filter(|at_s: &f64| at_s.is_finite() && *at_s > 0.0),
        _ => None,
    };
    at_s.map(|at_s| Measure::Survival { at_s })
        .ok_or_else(|| Misnamed {
            limit: format!("{SURVIVAL} is followed by a time, s"),
            remedy: format!("write it as \"{SURVIVAL} 10\""),
        })
}

/// The share of a word such as "p95".
fn quantile(word: &str) -> Option<f64> {
    let percent: f64 = word.strip_prefix('p')?.parse().ok()?;
    (0.0 < percent && percent < 100.0).then_some(percent / 100.0)
}

/// The channel groups that some words name: all where there are no words.
fn channels(words: &[&str], groups: &[Arc<str>]) -> Result<Vec<MeasuredChannels>, Misnamed> {
    let wanted = words.join(" ");
    let named = |(index, name): (usize, &Arc<str>)| MeasuredChannels {
        index,
        name: name.clone(),
    };
    let all = groups.iter().enumerate();
    let found: Vec<_> = all
        .filter(|(_, own)| words.is_empty() || ***own == *wanted)
        .map(named)
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let known: Vec<&str> = groups.iter().map(|own| &**own).collect();
    Err(Misnamed {
        limit: format!(
            "{wanted:?} is no quantile such as p95, and the channels are {}",
            known.join(", ")
        ),
        remedy: did_you_mean(
            &wanted,
            known.iter().copied(),
            "name one of them, or none for all",
        ),
    })
}
