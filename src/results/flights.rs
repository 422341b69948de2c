//! Which flights of a run are looked at, and what their commands say: the median and the worst of the first controller.

use super::fairness::Terms;
use super::numbers::of_episodes;
use super::scores::Scores;
use super::table::Table;
use crate::campaign::{Campaign, EpisodeNumber};
use crate::util::format::digits;
use serde::Serialize;
use std::sync::Arc;

/// The name of the flight that half of the others are not worse than.
pub const MEDIAN: &str = "median";
/// The name of the worst flight.
pub const WORST: &str = "worst";

/// Share of the steps at a limit from which on a loop that reverses its command may chatter.
const AT_LIMITS: f64 = 0.1;
/// Reversals of a command per second from which on it does: a command that answers disturbances and manoeuvres of a
/// few rad/s, and is cut by limits, changes its sign less than twice a second; one that swings between them does so
/// with the bandwidth of the loop.
const RESTLESS_PER_S: f64 = 10.0;

/// Flights of a run, simulated again.
#[derive(Debug, Clone, Default)]
pub struct Flights {
    /// Which.
    pub picked: Vec<PickedFlight>,
    /// Error and command over time, a row for each instant, controller and channel group.
    pub table: Table,
    /// How restless the commands are.
    pub paces: Vec<Pace>,
}

/// A flight that is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PickedFlight {
    /// [`MEDIAN`] or [`WORST`].
    pub name: &'static str,
    /// The episode.
    pub episode: u32,
}

/// How restless the commands of a controller are in a flight, on a channel group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pace {
    /// The flight.
    pub flight: &'static str,
    /// The controller.
    pub controller: String,
    /// The channel group.
    pub group: Arc<str>,
    /// Changes of sign per second of the command of the agent and channel that has most of them.
    pub reversals_per_s: f64,
    /// Rate of the commands in the root mean square over time, agents and channels, N/s or N m/s.
    pub rate_per_s: f64,
}

/// The episodes that are the median and the worst of the first controller: by how they ended, then by the error on its
/// first channel group.
#[must_use]
pub fn pick(campaign: &Campaign, scores: &Scores) -> Vec<PickedFlight> {
    let worst = scores.worst.first().and_then(|own| own.first());
    let Some(worst) = worst.map(|own| own.episode) else {
        return Vec::new();
    };
    let groups = campaign.channel_groups();
    let errors = groups
        .first()
        .map(|of| of_episodes(campaign, scores, 0, EpisodeNumber::Rmse, of));
    let errors = errors.unwrap_or_default();
    let mut by_error: Vec<usize> = (0..errors.len()).collect();
    by_error.sort_by(|&a, &b| errors[a].total_cmp(&errors[b]).then(a.cmp(&b)));
    let median = by_error.get(by_error.len().saturating_sub(1) / 2);
    let flight = |name, episode: usize| PickedFlight {
        name,
        episode: u32::try_from(episode).unwrap_or(u32::MAX),
    };
    let mut picked: Vec<PickedFlight> =
        median.map(|own| flight(MEDIAN, *own)).into_iter().collect();
    if Some(&worst) != median {
        picked.push(flight(WORST, worst));
    }
    picked
}

/// Adds to the terms of the controllers how restless their commands are in the median flight.
pub(super) fn add_paces(terms: &mut [Terms], paces: &[Pace]) {
    for own in terms {
        let of_own = |pace: &&Pace| {
            pace.flight == MEDIAN && pace.controller == own.controller && pace.group == own.group
        };
        if let Some(pace) = paces.iter().find(of_own) {
            own.reversals_per_s = Some(pace.reversals_per_s);
            own.command_rate_per_s = Some(pace.rate_per_s);
        }
    }
}

/// A controller whose commands are those of a bang-bang loop on a channel group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chatter {
    /// The controller.
    pub controller: String,
    /// How it shows.
    pub sentence: String,
}

/// Which controllers chatter: they are at a limit for much of the time, and change the sign of their command again and
/// again, a sentence for each channel group.
#[must_use]
pub fn chattering(terms: &[Terms]) -> Vec<Chatter> {
    let chatters = terms.iter().filter_map(|own| {
        let (share, reversals) = (own.saturated_share?, own.reversals_per_s?);
        (share > AT_LIMITS && reversals > RESTLESS_PER_S).then(|| {
            let sentence = format!(
                "{} chatters in {}: its command is at a limit for {:.0} % of the time and changes its sign {} times a \
                 second; errors of such a loop are not those of the design",
                own.controller,
                own.group,
                100.0 * share,
                digits(reversals, 3)
            );
            let controller = own.controller.clone();
            Chatter {
                controller,
                sentence,
            }
        })
    });
    chatters.collect()
}
