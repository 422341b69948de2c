//! A metric of a team's episode, from those of its agents and channels.

use super::scores::{GroupScores, Scores, Status};
use crate::campaign::{AgentGroup, Campaign, ChannelsOfCampaign};
use crate::statistics::rms;
use std::ops::Range;

/// Where the values of some channels of a team's episode lie in a list of [`GroupScores`].
pub(super) struct Layout {
    group: usize,
    team: usize,
    /// Channels of an agent.
    width: usize,
    channels: Range<usize>,
}

impl Layout {
    pub(super) fn new(campaign: &Campaign, of: &ChannelsOfCampaign) -> Self {
        Self::of_channels(campaign, of.group, of.channels.clone())
    }

    /// Of any channels of a group of agents.
    pub(super) fn of_channels(campaign: &Campaign, group: usize, channels: Range<usize>) -> Self {
        let own = &campaign.groups()[group];
        Self {
            group,
            team: own.team,
            width: own.channels().len(),
            channels,
        }
    }

    /// The group.
    pub(super) fn group<'a>(&self, campaign: &'a Campaign) -> &'a AgentGroup {
        &campaign.groups()[self.group]
    }

    /// The scores of the group.
    pub(super) fn scores<'a>(&self, scores: &'a Scores) -> &'a GroupScores {
        &scores.groups[self.group]
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
    let own = layout.scores(scores);
    let of_episode = |episode: usize| match own.status[controller][episode] {
        Status::Diverged => f64::INFINITY,
        _ => rms(layout.of(&own.rmse[controller], episode)),
    };
    (0..scores.episodes()).map(of_episode).collect()
}
