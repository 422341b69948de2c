//! How an episode ended, as bytes: all episodes of a campaign have as many, so that a part is read by place.

use crate::backend::EpisodeResult;
use crate::campaign::Campaign;
use crate::model::episode::AgentOutcome;
use crate::model::metric::{ChannelOutcome, METRICS};

/// Stands for "there is no such step": no run has so many.
const NO_STEP: u32 = u32::MAX;

/// Bytes of an agent beside its channels: the step of its failure, and whether it diverged.
const AGENT: usize = 4 + 4;
/// Bytes of a channel: its metrics and two steps.
const CHANNEL: usize = METRICS * 8 + 2 * 4;

/// How the agents of an episode ended, `[group of agents][controller][agent]`.
pub(crate) type Outcomes = Vec<Vec<Vec<AgentOutcome>>>;

/// How the bytes of an episode lie.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    controllers: usize,
    /// Agents, and channels of each, of the groups.
    groups: Vec<(usize, usize)>,
}

impl Record {
    /// Of a campaign's episodes.
    pub(crate) fn of(campaign: &Campaign) -> Self {
        let groups = campaign.groups().iter();
        Self {
            controllers: campaign.controllers.len(),
            groups: groups
                .map(|group| (group.team, group.channels().len()))
                .collect(),
        }
    }

    /// Bytes of an episode.
    pub(crate) fn bytes(&self) -> usize {
        let groups = self.groups.iter();
        let of_group = |(team, channels): &(usize, usize)| team * (AGENT + channels * CHANNEL);
        self.controllers * groups.map(of_group).sum::<usize>()
    }

    /// Adds an episode, of which the result of each group of agents is given.
    pub(crate) fn write(bytes: &mut Vec<u8>, groups: &[&EpisodeResult]) {
        let agents = groups.iter().flat_map(|group| &group.outcomes).flatten();
        for agent in agents {
            put_step(bytes, agent.failed_step);
            bytes.extend(u32::from(agent.diverged).to_le_bytes());
            for channel in &agent.channels {
                let numbers = channel.numbers();
                bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
                put_step(bytes, channel.last_outside);
                put_step(bytes, channel.last_outside_before_fault);
            }
        }
    }

    /// The episode of these bytes, which are as many as [`Record::bytes`] says.
    pub(crate) fn read(&self, bytes: &[u8]) -> Outcomes {
        let mut rest = Reader(bytes);
        let of_group = |&(team, channels): &(usize, usize)| {
            let of_controller = |_| {
                let agents = (0..team).map(|_| rest.agent(channels));
                agents.collect()
            };
            (0..self.controllers).map(of_controller).collect()
        };
        self.groups.iter().map(of_group).collect()
    }
}

fn put_step(bytes: &mut Vec<u8>, step: Option<u32>) {
    bytes.extend(step.unwrap_or(NO_STEP).to_le_bytes());
}

/// Bytes that are read from the front.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn agent(&mut self, channels: usize) -> AgentOutcome {
        AgentOutcome {
            failed_step: self.step(),
            diverged: self.word() != 0,
            channels: (0..channels).map(|_| self.channel()).collect(),
        }
    }

    fn channel(&mut self) -> ChannelOutcome {
        let numbers = std::array::from_fn(|_| f64::from_le_bytes(self.take()));
        ChannelOutcome::of_numbers(numbers, [self.step(), self.step()])
    }

    fn step(&mut self) -> Option<u32> {
        Some(self.word()).filter(|step| *step != NO_STEP)
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    /// The next bytes; zeros behind the end, where there are none.
    fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.0.split_first_chunk() {
            Some((first, rest)) => {
                self.0 = rest;
                *first
            }
            None => [0; N],
        }
    }
}
