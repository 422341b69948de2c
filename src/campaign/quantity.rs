//! A random quantity: its distributions, and who shares a draw.

use super::distribution::Distribution;
use super::parameter::SamplingScope;

/// A random quantity of each agent and channel: who shares a draw, and each one's distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomQuantity {
    /// Who shares a draw.
    pub per: SamplingScope,
    /// Channels per agent (1 for a quantity of the agent).
    pub channels: usize,
    /// Distribution of each agent and channel, agent by agent.
    pub distributions: Vec<Distribution>,
}

impl RandomQuantity {
    /// The distribution of an agent's channel.
    #[must_use]
    pub fn of(&self, agent: usize, channel: usize) -> &Distribution {
        &self.distributions[agent * self.channels + channel]
    }

    /// Whether some of its values are drawn.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.distributions.iter().any(|own| !own.is_constant())
    }

    /// Whether it is zero in every episode.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.distributions.iter().all(|d| d.support() == (0.0, 0.0))
    }
}
