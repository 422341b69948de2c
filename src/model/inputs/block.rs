//! A block of episodes, one per lane, and the numbers of their draws side by side.

use crate::campaign::AgentGroup;
use crate::draw::{AgentDraw, Episode};
use crate::model::lanes::{Lane, MAX_WIDTH};

/// A block of episodes, one per lane; lanes without one repeat the last.
#[derive(Clone, Copy)]
pub(crate) struct LaneBlock<'a> {
    pub(crate) group: &'a AgentGroup,
    pub(crate) episodes: &'a [Episode],
}

/// Which entries of the campaign get a signal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Selection {
    /// Those that act on these channels in some lane of the block: the others would only cost time.
    Acting,
    /// Those that may act on these channels in some episode: the same list for every block of a campaign.
    Possible,
}

impl LaneBlock<'_> {
    /// The episode numbers of the lanes.
    pub(crate) fn numbers(&self) -> [u32; MAX_WIDTH] {
        std::array::from_fn(|lane| self.episode(lane).index)
    }

    pub(super) fn episode(&self, lane: usize) -> &Episode {
        &self.episodes[lane.min(self.episodes.len() - 1)]
    }

    /// A number of each lane's draw; what lies beyond the lanes of `L` is not used.
    pub(super) fn lanes<L: Lane>(
        &self,
        agent: usize,
        pick: impl Fn(&AgentDraw) -> f64,
    ) -> [f64; MAX_WIDTH] {
        std::array::from_fn(|lane| {
            if lane < L::WIDTH {
                pick(&self.episode(lane).agents[agent])
            } else {
                0.0
            }
        })
    }

    pub(super) fn load<L: Lane>(&self, agent: usize, pick: impl Fn(&AgentDraw) -> f64) -> L {
        L::load(&self.lanes::<L>(agent, pick))
    }

    /// Turns per half step of frequencies in Hz.
    pub(super) fn advance<L: Lane>(&self, frequency_hz: [f64; MAX_WIDTH]) -> L::Turns {
        L::turns(&frequency_hz.map(|frequency| frequency * self.group.time.step_s / 2.0))
    }
}

/// A count as a word of 32 bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a count, which saturates"
)]
pub(super) fn small(count: f64) -> u32 {
    count.round() as u32
}
