//! How bad an episode was.

use super::agent_scores::{AgentScores, Status};
use crate::campaign::Campaign;
use std::cmp::Ordering;

/// How bad an episode was under a controller.
#[derive(Debug, Clone, Copy)]
pub(super) struct BadEpisode {
    pub(super) status: Status,
    /// Largest |e| over its limit; infinite after a divergence.
    pub(super) excess: f64,
    /// Step of the first failure; the last possible one where no single step failed.
    pub(super) failed_step: u32,
    pub(super) episode: usize,
    pub(super) agent: usize,
    pub(super) channel: usize,
}

impl BadEpisode {
    /// The same where so many episodes come before.
    pub(super) fn later(self, before: usize) -> Self {
        Self {
            episode: self.episode + before,
            ..self
        }
    }

    pub(super) fn new(
        campaign: &Campaign,
        (episode, status): (usize, Status),
        groups: &[Vec<AgentScores>],
    ) -> Self {
        let agents: Vec<&AgentScores> = groups.iter().flatten().collect();
        let step = |agent: usize| {
            let own = agents.get(agent).and_then(|own| own.failed_step);
            own.unwrap_or(u32::MAX)
        };
        let all = 0..agents.len();
        let first = all.clone().min_by_key(|&agent| step(agent)).unwrap_or(0);
        // If an episode diverges, only its first failing agent counts: it may have pulled the others along.
        let looked_at = match status {
            Status::Diverged => first..first + 1,
            Status::Ok | Status::Exceeded => all,
        };
        let of_agent = |agent: usize| {
            let limits = &campaign.member(agent).0.verdict.max_error;
            let channels = limits.iter().zip(&agents[agent].channels).enumerate();
            channels.map(move |(channel, (limit, own))| {
                let limit = if limit.is_finite() { *limit } else { 1.0 };
                let excess = match own.max_abs / limit {
                    // What left the numbers is as large as can be.
                    excess if excess.is_nan() => f64::INFINITY,
                    excess => excess,
                };
                (excess, agent, channel)
            })
        };
        let largest = looked_at
            .flat_map(of_agent)
            .reduce(|a, b| if b.0 > a.0 { b } else { a });
        let (excess, agent, channel) = largest.unwrap_or_default();
        Self {
            status,
            excess,
            failed_step: step(first),
            episode,
            agent,
            channel,
        }
    }

    /// Worst first: by how they ended, then by the largest error over its limit; of those that diverged, the earlier
    /// the worse.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let by_size = match self.status {
            Status::Diverged => self.failed_step.cmp(&other.failed_step),
            Status::Ok | Status::Exceeded => other.excess.total_cmp(&self.excess),
        };
        let by_status = other.status.cmp(&self.status);
        by_status
            .then(by_size)
            .then(self.episode.cmp(&other.episode))
    }
}
