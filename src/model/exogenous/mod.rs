//! Disturbances and faults of one agent's channels: what is held over a step, and what varies within it.

pub(crate) mod actuator;
mod command_path;
pub(crate) mod delay_line;
pub(crate) mod dryden;
pub(crate) mod evaluation;
pub(crate) mod friction;
mod inputs;
pub(crate) mod kernels;
pub(crate) mod lists;
pub(crate) mod noise;
mod start;
pub(crate) mod vortex;
pub(crate) mod window;

pub(crate) use inputs::ExogenousInputs;
