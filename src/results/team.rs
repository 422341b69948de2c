//! A metric of a team's episode, from those of its agents and channels.

use super::scores::{Scores, Status};
use crate::campaign::Campaign;
use crate::statistics::rms;
use std::ops::Range;

/// Where the values of some channels of a team's episode lie in a list of [`Scores`].
pub(super) struct Layout {
    team: usize,
    /// Channels of an agent.
    width: usize,
    channels: Range<usize>,
}

impl Layout {
    pub(super) fn new(campaign: &Campaign, channels: Range<usize>) -> Self {
        Self {
            team: campaign.team,
            width: campaign.channels().len(),
            channels,
        }
    }

    /// The values of an episode, agent by agent.
    pub(super) fn of<'a>(
        &'a self,
        values: &'a [f64],
        episode: usize,
    ) -> impl Iterator<Item = f64> + 'a {
        let width = self.width;
        (0..self.team).flat_map(move |agent| {
            let first = (episode * self.team + agent) * width;
            self.channels
                .clone()
                .map(move |channel| values[first + channel])
        })
    }
}

/// RMS error of each episode over the team and the channels; infinite where an agent diverged.
pub(super) fn team_rmse(scores: &Scores, controller: usize, layout: &Layout) -> Vec<f64> {
    let of_episode = |episode: usize| match scores.status[controller][episode] {
        Status::Diverged => f64::INFINITY,
        _ => rms(layout.of(&scores.rmse[controller], episode)),
    };
    (0..scores.episodes()).map(of_episode).collect()
}
