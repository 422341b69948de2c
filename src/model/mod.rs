//! The closed loop of an episode: plant, observer, controller, faults and metrics, generic over the lane type.
//!
//! The flow of one step is `group`: what is held (`signal`), the four stages of `integrator`, in which each `agent`'s `plant`
//! answers its `controller`, and the sums of `metric`. [`episode`] builds groups from draws (`condition`, `fault`) and collects
//! their outcomes.

pub(crate) mod agent;
pub(crate) mod condition;
pub mod controller;
pub(crate) mod dryden;
pub mod episode;
pub(crate) mod fault;
pub(crate) mod group;
pub(crate) mod integrator;
pub mod lanes;
pub mod leg;
pub(crate) mod math;
pub(crate) mod memory;
pub mod metric;
pub(crate) mod noise;
pub(crate) mod part;
pub mod plant;
pub(crate) mod plant_biped;
pub mod plant_uav;
pub mod rng;
pub(crate) mod signal;
#[cfg(target_arch = "x86_64")]
pub mod simd;
pub(crate) mod switch;
pub(crate) mod vortex;

pub use group::{Internals, Shown};
