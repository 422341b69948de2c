//! Position reference of a UAV: a smooth path through waypoints, flown from rest to rest (paper,
//! section III-A).
//!
//! 1. *Linear interpolation.* Every leg of the polyline is divided evenly.
//! 2. *Cubic spline* of each coordinate through these points (`spline`).
//! 3. *Arc length*, so that the speed is exactly the time law's ds/dt (`curve`).
//! 4. *Time law* s = S (10 τ³ - 15 τ⁴ + 6 τ⁵), τ = t / T (the minimum-jerk law of Flash and Hogan
//!    1985). The curve does not depend on T, so velocity scales with 1 / T and acceleration with
//!    1 / T²: the smallest T within both limits follows from the two peaks at T = 1.

mod curve;
mod error;
mod spline;
mod waypoint_path;

pub use curve::PathPoint;
pub use error::PathError;
pub use waypoint_path::{DEFAULT_STEP_M, PathLimits, WaypointPath};
