//! What the scores of a run say: how each controller fared, how each pair of them compares, and which fault hurts most.
//!
//! The sample unit is the episode. Its RMS error is taken over the team and over the channels of one unit, or those of
//! one channel, in the summary and in the comparison alike; pairs are compared in its logarithm. A diverged episode has
//! an infinite error; where both controllers diverge the pair is a tie.
//!
//! Everything is said of all episodes together, then of each stratum. What is said of all is about the campaign's own
//! mixture; that each stratum has its share exactly, and not by chance, makes its intervals cautious, if anything
//! (Hoeffding 1956, Annals of Mathematical Statistics 27:713-721). Intervals and tests that the sampling design does
//! not allow ([`crate::random::allows`]) are absent; Student's t over the design's replicates takes the place of some.
//!
#![doc = include_str!("README.md")]

mod agent_scores;
mod all;
mod bad_episode;
mod columns;
pub mod curves;
pub mod dictionary;
pub mod extent;
mod fairness;
pub mod files;
pub mod flights;
mod long_tables;
pub mod measures;
mod numbers;
mod paired;
mod replicates;
mod requirements;
pub mod scores;
mod screening;
pub mod sensitivity;
mod strata;
mod summary;
pub mod table;
pub mod tables;
mod team;
mod verdict;
mod worst_fault;

pub use all::Results;
pub use columns::{comparison_table, fairness_table, screening_table, summary_table};
pub use fairness::{Terms, terms, unlike};
pub use paired::{Measured, PairedComparison, Ratio, compare, compare_pairs};
pub use replicates::{FEWEST_REPLICATES, Replicated};
pub use requirements::{RequirementResult, can_be_judged, requirements};
pub use screening::{FaultEffect, Growth, Screening, screen};
pub use summary::{FailureRate, MetricQuantiles, Quantile, RateMethod, failure_rates, summarise};
pub use verdict::{Favour, how_sure, judged, verdict};
pub use worst_fault::harm;
