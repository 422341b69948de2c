//! Global path planning: a way for a robot between two points past everything that stands (paper, Fig. 1).
//!
//! ```text
//! RRT-Connect -> prune, shortcuts, prune -> points (sigma_n) -> spline (sigma'_n)
//! ```
//!
//! RRT-Connect (Kuffner and LaValle, ICRA 2000) takes its random numbers by address, and every stage is a pure
//! function: a plan depends on the obstacles, the seed and the addresses alone.

mod curve;
mod rrt_connect;
mod search;
mod segment;
mod shorten;

pub use curve::{Curve, Way, points_along};
pub use search::{PlanNumbers, Searched, polyline};
pub use segment::{Space, march};
