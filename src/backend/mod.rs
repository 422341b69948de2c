//! Where episodes are simulated: draws in, outcomes out.
//!
#![doc = include_str!("README.md")]

pub mod cpu;
pub mod gpu;

use crate::draw::Episode;
use crate::model::episode::AgentOutcome;

/// One episode: its draw and, `[controller][agent]`, how it went.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeResult {
    /// What was drawn.
    pub episode: Episode,
    /// Per-agent outcomes.
    pub outcomes: Vec<Vec<AgentOutcome>>,
}
