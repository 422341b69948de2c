//! A campaign as the rest of the program sees it: checked and complete.

use super::common::Common;
use super::disturbances_and_faults::Fault;
use super::group::{AgentGroup, ChannelsOfCampaign, GroupParts};
use super::plan::Sampling;
use super::tune::Tune;
use std::ops::Deref;
use std::sync::Arc;

/// A validated campaign: what all its agents have in common, and the groups of agents that are simulated in the same
/// episodes. Its parts are there to be read; what changes one of them checks it ([`Campaign::with_seed`],
/// [`Campaign::with_episodes`], or settings laid over the file).
#[derive(Debug, Clone)]
pub struct Campaign {
    common: Arc<Common>,
    /// At least one; agents of one group never act on those of another.
    groups: Vec<AgentGroup>,
    /// What `urts-mc tune` searches, if the file says it.
    pub(super) tune: Option<Arc<Tune>>,
}

impl Deref for Campaign {
    type Target = Common;

    fn deref(&self) -> &Common {
        &self.common
    }
}

impl Campaign {
    /// A campaign of some groups, whose agents, disturbances and faults are numbered through.
    pub(super) fn new(common: Arc<Common>, groups: Vec<GroupParts>) -> Self {
        let mut campaign = Self {
            common,
            groups: Vec::new(),
            tune: None,
        };
        let mut before = [0; 3];
        for mut parts in groups {
            [
                parts.first_agent,
                parts.first_disturbance,
                parts.first_fault,
            ] = before;
            before[0] += parts.team;
            before[1] += parts.disturbances.len();
            before[2] += parts.faults.len();
            campaign.groups.push(AgentGroup::new(parts));
        }
        campaign
    }

    /// What `urts-mc tune` searches, if the file says it.
    #[must_use]
    pub fn tune(&self) -> Option<&Tune> {
        self.tune.as_deref()
    }

    /// The same with so many independent episodes of another seed under these controllers, of which nothing is
    /// required.
    #[must_use]
    pub(crate) fn drawn_anew(self, seed: u64, episodes: u32, controllers: Vec<String>) -> Self {
        self.with(|parts| {
            parts.seed = seed;
            parts.episodes = episodes;
            parts.controllers = controllers;
            parts.sampling = Sampling::Independent;
            parts.stop = None;
            parts.requirements = Vec::new();
        })
    }

    /// The groups of agents, in the file's order; a file without `[[group]]` is a single one.
    #[must_use]
    pub fn groups(&self) -> &[AgentGroup] {
        &self.groups
    }

    /// The first group: all agents of a file without `[[group]]`.
    #[must_use]
    pub fn first_group(&self) -> &AgentGroup {
        &self.groups[0]
    }

    /// Whether the file has `[[group]]`, so that tables and texts name the groups.
    #[must_use]
    pub fn has_named_groups(&self) -> bool {
        !self.groups[0].name.is_empty()
    }

    /// Agents of an episode, at least 1.
    #[must_use]
    pub fn agents(&self) -> usize {
        self.groups.iter().map(|group| group.team).sum()
    }

    /// The group of an agent, and the agent's number in it.
    #[must_use]
    pub fn member(&self, agent: usize) -> (&AgentGroup, usize) {
        let group = &self.groups[self.group_index(agent)];
        (group, agent - group.first_agent)
    }

    /// The index of an agent's group.
    #[must_use]
    pub fn group_index(&self, agent: usize) -> usize {
        let begun = |group: &AgentGroup| group.first_agent <= agent;
        self.groups.iter().rposition(begun).unwrap_or(0)
    }

    /// The channels whose errors may be averaged, group by group.
    #[must_use]
    pub fn channel_groups(&self) -> Vec<ChannelsOfCampaign> {
        let groups = self.groups.iter().enumerate();
        let of_group = |(index, group): (usize, &AgentGroup)| {
            let channels = group.channel_groups().into_iter().enumerate();
            let of_campaign = channels.map(|(place, own)| ChannelsOfCampaign {
                place,
                group: index,
                name: group.titled(own.role.name()).into(),
                role: own.role,
                channels: own.channels,
            });
            of_campaign.collect::<Vec<_>>()
        };
        groups.flat_map(of_group).collect()
    }

    /// All faults with the groups that may have them, by their numbers in the campaign.
    pub fn faults(&self) -> impl Iterator<Item = (&AgentGroup, &Fault)> {
        self.groups
            .iter()
            .flat_map(|group| group.faults.iter().map(move |fault| (group, fault)))
    }

    /// What its agents are called, with their number: "3 UAVs"; of several groups "3 UAVs (scouts) and 4 robots
    /// (rescuers)".
    #[must_use]
    pub fn agents_in_words(&self) -> String {
        let groups: Vec<String> = self.groups.iter().map(|group| group.in_words()).collect();
        groups.join(" and ")
    }

    /// What several of its agents are called.
    #[must_use]
    pub fn plural(&self) -> &'static str {
        match self.groups.as_slice() {
            [only] => only.agent.plural(),
            _ => "agents",
        }
    }

    /// The same with parts of its first group, or of what is common, changed by somebody who knows that they fit each
    /// other: nothing is checked.
    #[doc(hidden)]
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut GroupParts)) -> Self {
        let first = self.groups.remove(0).with(change);
        self.common = first.common.clone();
        let others = self.groups.into_iter();
        let others = others.map(|group| group.with(|parts| parts.common = self.common.clone()));
        self.groups = std::iter::once(first.clone()).chain(others).collect();
        self
    }
}
