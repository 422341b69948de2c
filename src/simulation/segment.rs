//! What simulated which episodes.

use crate::backend::cpu::Simd;
use crate::backend::gpu::{Adapter, GpuTimes};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Consecutive episodes, and what simulated them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// The first episode.
    pub first: u32,
    /// How many.
    pub episodes: u32,
    /// What simulated them.
    #[serde(flatten)]
    pub engine: Engine,
}

impl Segment {
    /// Adds the episodes that come next: to the last segment, where the same engine went on.
    pub fn append(all: &mut Vec<Self>, next: Self) {
        if next.episodes == 0 {
            return;
        }
        if let Some(last) = all.last_mut()
            && last.first + last.episodes == next.first
            && last.engine.class() == next.engine.class()
        {
            last.episodes += next.episodes;
            last.engine.goes_on(&next.engine);
            return;
        }
        all.push(next);
    }
}

/// What simulates episodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "backend", rename_all = "lowercase")]
pub enum Engine {
    /// The CPU backend.
    Cpu {
        /// Layout of single-precision episodes.
        simd: Option<Simd>,
        /// Threads.
        threads: usize,
    },
    /// The GPU backend, in single precision.
    Gpu {
        /// The adapter.
        adapter: Adapter,
        /// Episodes of a batch.
        batch: u32,
        /// Times.
        gpu_times: GpuTimes,
    },
}

impl Engine {
    /// What decides the digits of its episodes: engines of one class give the same, whatever their threads, batches
    /// and lanes of fused arithmetic are.
    #[must_use]
    pub fn class(&self) -> String {
        match self {
            Self::Cpu { simd: None, .. } => "the CPU in double precision".to_string(),
            Self::Cpu {
                simd: Some(Simd::Scalar),
                ..
            } => "the CPU without lanes".to_string(),
            Self::Cpu { .. } => "the CPU in lanes".to_string(),
            Self::Gpu { adapter, .. } => {
                format!("{} ({}, {})", adapter.name, adapter.api, adapter.driver)
            }
        }
    }

    /// Takes in the times of an engine of the same class that simulated the episodes after its own.
    fn goes_on(&mut self, next: &Self) {
        match (self, next) {
            (
                Self::Gpu { gpu_times, .. },
                Self::Gpu {
                    gpu_times: more, ..
                },
            ) => {
                *gpu_times = [*gpu_times, *more].into_iter().sum();
            }
            (Self::Cpu { threads, .. }, Self::Cpu { threads: other, .. }) => {
                *threads = (*threads).max(*other);
            }
            _ => {}
        }
    }
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu { simd, threads } => {
                let lanes = simd.map_or(String::new(), |simd| format!(" ({simd:?})"));
                let threads = match threads {
                    1 => "1 thread".to_string(),
                    many => format!("{many} threads"),
                };
                write!(f, "the CPU{}, {threads}", lanes.to_lowercase())
            }
            Self::Gpu { adapter, .. } => write!(f, "{} ({})", adapter.name, adapter.driver),
        }
    }
}
