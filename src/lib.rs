//! Monte Carlo robustness evaluation of fault-tolerant controllers for teams of UAVs or bipeds.
//!
//! A campaign file says which closed loop flies, what disturbs it and what counts as failure; a run flies every episode under
//! every controller on the same draws and compares the controllers pair by pair. The modules are in the order of the flow,
//! and values move forward only:
//!
//! ```text
//! campaign (cautions) -> synthesis, gains -> reference -> draw (sampling) -> backend (model | shaders) -> tables (stop)
//!          -> comparison, ranking (statistics) -> output, junit (shortcomings) -> report (caveats); paper
//! ```
//!
//! # Invariants
//! - A [`campaign::Campaign`] is complete and consistent; nothing after it checks input again.
//! - An episode depends on (campaign, seed, index) alone: no clock, environment, thread, batch or order reaches a number.
//! - [`model`] is written once, generic over the lane type; what a campaign does not use is not in its loop.
//! - Not-a-number is a verdict ("diverged"), never a value in a statistic and never a dropped row.
//! - A directory with a manifest holds all episodes that it counts; files appear under their final name only when complete.
//! - The library does not print, does not exit and does not panic on input.

pub mod attenuation;
pub mod backend;
pub mod campaign;
pub mod cautions;
pub mod caveats;
pub mod comparison;
pub mod conditions;
pub mod cross_check;
pub mod draw;
pub mod flight;
pub mod gains;
pub mod junit;
pub mod list;
pub mod manifest;
pub mod model;
mod nearest;
pub mod output;
pub mod paper;
pub mod ranking;
pub mod reference;
pub mod replay;
pub mod report;
pub mod robot;
pub mod run;
pub mod sampling;
pub mod shortcomings;
pub mod statistics;
pub mod stop;
pub mod synthesis;
pub mod tables;
pub mod words;
