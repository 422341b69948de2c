//! What a decision sees of the true motion.

use crate::mission::plane::Point;

/// What is measured at the beginning of an epoch.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// By agent: its true place, m. For an agent that is lost, or a place that is not finite, its reference counts
    /// instead.
    pub places_m: &'a [Point],
    /// By agent: when it was lost, s, if that was before.
    pub lost_s: &'a [Option<f64>],
}
