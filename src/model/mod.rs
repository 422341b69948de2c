//! The closed loop of an episode: plant, observer, controller, faults and metrics, generic over the lane type.
//!
//! One step is `team`: what is held over the step (`exogenous`), the four stages of `integrator`, in which each
//! `agent`'s `plant` answers its `controller`, and the sums of `metric`. [`episode`] builds teams from draws (`inputs`)
//! and collects their outcomes.
//!
#![doc = include_str!("README.md")]

pub(crate) mod agent;
pub mod controller;
pub mod episode;
pub(crate) mod exogenous;
pub(crate) mod inputs;
pub(crate) mod integrator;
pub mod lanes;
pub mod metric;
pub mod plant;
pub(crate) mod sample;
pub(crate) mod subsystem;
pub(crate) mod team;

pub use sample::{ChannelSample, ObserverState};
