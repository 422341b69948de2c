//! The numbers of a team in each episode, on a channel group or on one channel.

use super::scores::{ChannelGroupScores, GroupScores, Scores};
use crate::campaign::{AgentGroup, Campaign, ChannelsOfCampaign};
use std::sync::Arc;

/// Where the numbers of a team on some channels are in the scores.
pub(super) struct TeamNumbers {
    group: usize,
    /// The place of the channel, or of the channel group, among so many.
    place: usize,
    of: usize,
    on_one_channel: bool,
}

impl TeamNumbers {
    /// On a channel group.
    pub(super) fn on(campaign: &Campaign, of: &ChannelsOfCampaign) -> Self {
        Self {
            group: of.group,
            place: of.place,
            of: campaign.groups()[of.group].channel_groups().len(),
            on_one_channel: false,
        }
    }

    /// On every channel group of a campaign, then on every channel of each group of agents, with their names.
    pub(super) fn all(campaign: &Campaign) -> Vec<(Arc<str>, Self)> {
        let of_groups = campaign.channel_groups().into_iter();
        let of_groups = of_groups.map(|of| (of.name.clone(), Self::on(campaign, &of)));
        let groups = campaign.groups().iter().enumerate();
        let of_channels = groups.flat_map(|(index, group)| {
            let channels = group.channels();
            channels.iter().enumerate().map(move |(place, name)| {
                let own = Self {
                    group: index,
                    place,
                    of: channels.len(),
                    on_one_channel: true,
                };
                (Arc::from(group.titled(name)), own)
            })
        });
        of_groups.chain(of_channels).collect()
    }

    /// What they are on: "group" of channels, or "channel".
    pub(super) fn scope(&self) -> &'static str {
        match self.on_one_channel {
            true => "channel",
            false => "group",
        }
    }

    /// The group of agents.
    pub(super) fn group<'a>(&self, campaign: &'a Campaign) -> &'a AgentGroup {
        &campaign.groups()[self.group]
    }

    /// The scores of the group of agents.
    pub(super) fn scores<'a>(&self, scores: &'a Scores) -> &'a GroupScores {
        &scores.groups[self.group]
    }

    /// RMS error of each episode over the team and the channels; infinite where an agent diverged.
    pub(super) fn rmse(&self, scores: &Scores, controller: usize) -> Vec<f64> {
        match self.on_one_channel {
            true => {
                let all = self.scores(scores).rmse[controller].iter();
                all.skip(self.place).step_by(self.of).copied().collect()
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
        let all = self.scores(scores).channel_groups[controller].iter();
        let own = all.skip(self.place).step_by(self.of);
        own.map(number).collect()
    }
}
