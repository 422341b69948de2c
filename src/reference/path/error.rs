//! Why there is no path.

use thiserror::Error;

/// Why waypoints and limits do not define a path. Indices count from zero.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// A path needs a start and an end.
    #[error("points_m has {count} point(s), a path needs at least 2")]
    TooFewPoints {
        /// Number of waypoints given.
        count: usize,
    },
    /// A coordinate is not finite or too large to be resolved.
    #[error("points_m[{index}] = {point:?}, coordinates must be finite and at most 1e6 m in size")]
    Coordinate {
        /// Index of the waypoint.
        index: usize,
        /// The waypoint, m.
        point: [f64; 3],
    },
    /// Two consecutive waypoints give no direction.
    #[error("points_m[{index}] coincides with the point before it, remove one of the two")]
    Coincident {
        /// Index of the second of the two waypoints.
        index: usize,
    },
    /// A limit or the step is not finite, not positive or absurd.
    #[error("{name} = {value} must lie between 1e-6 and 1e6")]
    OutOfRange {
        /// Name of the limit or `step_m`.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// The path has more pieces than memory should hold.
    #[error(
        "the path takes {pieces} pieces of step_m and can have at most {limit}, raise step_m or divide the path"
    )]
    TooLong {
        /// Pieces that it takes.
        pieces: f64,
        /// The largest number.
        limit: u32,
    },
    /// The path turns back on itself, or one bend slows all of it beyond use.
    #[error(
        "the path turns too sharply at points_m[{index}] (by more than 175 degrees, or slowing it \
         more than 20-fold), spread the turn over more points or divide the path there"
    )]
    TooSharp {
        /// Index of the waypoint at, or nearest to, the sharpest bend.
        index: usize,
    },
}
