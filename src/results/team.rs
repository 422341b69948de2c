//! A team's RMS error in each episode, on a channel group or on one channel.

use super::scores::{ChannelGroupScores, GroupScores, Scores, Status};
use crate::campaign::{AgentGroup, Campaign, ChannelsOfCampaign};

/// Channels of a group of agents whose errors the scores have as one number.
pub(super) struct Errors {
    group: usize,
    /// The place of the channel, or of the channel group, among so many.
    place: usize,
    of: usize,
    on_one_channel: bool,
}

impl Errors {
    /// On a channel group.
    pub(super) fn on(campaign: &Campaign, of: &ChannelsOfCampaign) -> Self {
        Self {
            group: of.group,
            place: of.place,
            of: campaign.groups()[of.group].channel_groups().len(),
            on_one_channel: false,
        }
    }

    /// On a channel of a group of agents.
    pub(super) fn on_channel(campaign: &Campaign, group: usize, channel: usize) -> Self {
        Self {
            group,
            place: channel,
            of: campaign.groups()[group].channels().len(),
            on_one_channel: true,
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

    /// RMS error of each episode over the team and the channels; infinite where an agent diverged.
    pub(super) fn rmse(&self, scores: &Scores, controller: usize) -> Vec<f64> {
        let own = self.scores(scores);
        match self.on_one_channel {
            true => {
                let values = own.rmse[controller].iter().copied();
                self.of_episodes(own, controller, values)
            }
            false => self.of_channel_group(scores, controller, |own| own.rmse),
        }
    }

    /// A number of each episode on the channel group; infinite where an agent diverged.
    pub(super) fn of_channel_group(
        &self,
        scores: &Scores,
        controller: usize,
        number: fn(&ChannelGroupScores) -> f64,
    ) -> Vec<f64> {
        let own = self.scores(scores);
        let values = own.channel_groups[controller].iter().map(number);
        self.of_episodes(own, controller, values)
    }

    fn of_episodes(
        &self,
        own: &GroupScores,
        controller: usize,
        values: impl Iterator<Item = f64>,
    ) -> Vec<f64> {
        let own_place = values.skip(self.place).step_by(self.of);
        let with_status = own_place.zip(&own.status[controller]);
        let of_episode = |(value, status): (f64, &Status)| match status {
            Status::Diverged => f64::INFINITY,
            Status::Ok | Status::Exceeded => value,
        };
        with_status.map(of_episode).collect()
    }
}
