//! Where the agents are to go: r(t), r'(t) and r''(t) of every agent and channel.

pub mod path;
mod point;
mod sinusoid;
mod team;
pub mod walk;

pub use path::WaypointPath;
pub use point::ReferencePoint;
pub use sinusoid::Sinusoid;
pub use team::{AgentWalk, Reference};
pub use walk::Walk;
