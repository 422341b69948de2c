//! Simulating the episodes of a campaign on the backends that are to be had.

pub mod attenuation;
pub mod cross_check;
pub mod flight;
pub(crate) mod group_simulators;
mod in_memory;
mod options;
mod segment;
pub mod stopping;
mod times;

pub use in_memory::{Simulation, simulate};
pub use options::{Backend, RunOptions, SimulationError, open, threads};
pub use segment::{Engine, Segment};
pub use times::Times;
