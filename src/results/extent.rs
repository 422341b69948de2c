//! How much room the results of a run take, roughly: told before it is flown.

use super::table::Table;
use super::tables::Tables;
use crate::backend::EpisodeResult;
use crate::campaign::{AgentGroup, Campaign, CampaignError, Detail};
use crate::draw::draw;
use crate::model::episode::AgentOutcome;
use crate::model::metric::{ChannelOutcome, METRICS};
use crate::util::{format, memory};

/// Episodes whose rows are made to see how large they are.
const SAMPLED: u32 = 32;
/// Bytes of a number in a table: draws and metrics have no pattern that could be packed. All other cells, and what is
/// repeated, as the draws are under each controller, are packed to next to nothing.
const NUMBER: usize = 8;
/// What the statistics take of memory, in the bytes of the scores: these, and sorted and ranked columns, of which there
/// are some for each thread. On two threads 1,000,000 episodes of uav-paper's shape took 1.33 GB, and 2.2 GB are told.
const WITH_SORTED: usize = 2;
/// What a run takes whatever its episodes, bytes.
const WHATEVER: u64 = 200_000_000;

/// How much room the results of a campaign take.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Bytes of the tables that grow with the episodes, in the order of [`Detail::ALL`].
    pub tables: [u64; Detail::ALL.len()],
    /// Bytes of memory that all episodes together take.
    pub memory: u64,
}

impl Extent {
    /// Of a campaign, by the rows of some episodes of which nothing but the draws is known.
    #[must_use]
    pub fn of(campaign: &Campaign) -> Self {
        let all = campaign.clone().with(|own| own.detail = Detail::All);
        let sampled = SAMPLED.min(all.episodes);
        let mut tables = Tables::new(&all);
        for episode in 0..sampled {
            let groups = all.groups().iter().map(|group| sample(group, episode));
            let groups: Vec<EpisodeResult> = groups.collect();
            tables.add(&all, &groups.iter().collect::<Vec<_>>());
        }
        let bytes = |of_sampled: usize| {
            let of_all = (of_sampled as u64).saturating_mul(u64::from(all.episodes));
            of_all / u64::from(sampled.max(1))
        };
        let of_tables = |tables: &[&Table]| {
            let numbers = tables.iter().map(|own| own.different_numbers());
            bytes(NUMBER * numbers.sum::<usize>())
        };
        let episodes = &tables.episodes;
        let others = [&tables.channels, &tables.faults, &tables.conditions_drawn];
        let of_episodes = of_tables(&[episodes]);
        Self {
            tables: [0, of_episodes, of_episodes + of_tables(&others)],
            memory: WHATEVER + bytes(WITH_SORTED * tables.scores.bytes()),
        }
    }

    /// Refuses a campaign whose episodes together do not fit into the memory of this machine, where it is known.
    ///
    /// # Errors
    /// If they do not.
    pub fn fits_here(self, campaign: &Campaign) -> Result<(), CampaignError> {
        memory::available().map_or(Ok(()), |memory| self.fits(campaign, memory))
    }

    /// Refuses a campaign whose episodes together do not fit into so many bytes of memory.
    ///
    /// # Errors
    /// If they do not.
    pub fn fits(self, campaign: &Campaign, available: u64) -> Result<(), CampaignError> {
        if self.memory <= available {
            return Ok(());
        }
        let of_episode = (self.memory - WHATEVER) / u64::from(campaign.episodes);
        let fitting = available.saturating_sub(WHATEVER) / of_episode.max(1);
        let [needed, there] = [self.memory, available].map(format::bytes);
        Err(campaign.invalid(
            "episodes",
            campaign.episodes,
            &format!("their statistics take about {needed} of memory, and {there} are there"),
            &match fitting {
                0 => "use a machine with more, or raise the limit of this process (ulimit -v)"
                    .to_string(),
                _ => format!("give {fitting} or fewer, or another machine"),
            },
        ))
    }
}

/// An episode of a group of agents with its draws, and with outcomes that stand for any: no two numbers are alike.
fn sample(group: &AgentGroup, episode: u32) -> EpisodeResult {
    let channels = group.channels().len();
    let mut count = 0;
    let mut agent = || {
        let mut agent = AgentOutcome::blank(channels);
        for channel in &mut agent.channels {
            count += 1;
            let number = 1e-3 * f64::from(count + 1000 * (episode + 1));
            *channel = ChannelOutcome::of_numbers([number; METRICS], [Some(count); 2]);
        }
        agent
    };
    let mut team = || (0..group.team).map(|_| agent()).collect();
    let outcomes = group.controllers.iter().map(|_| team()).collect();
    EpisodeResult {
        episode: draw(group, episode),
        outcomes,
    }
}
