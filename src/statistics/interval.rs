//! Intervals, estimates and their confidence level.

use serde::{Serialize, Serializer};

/// An effect is called significant at or below this p-value.
pub const SIGNIFICANCE: f64 = 0.05;
/// Level of every two-sided interval, and of the one-sided failure bound.
pub const LEVEL: f64 = 0.95;

/// A confidence interval; both ends belong to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower limit; `-inf` where the data set none.
    pub lower: f64,
    /// Upper limit; `+inf` where the data set none.
    pub upper: f64,
}

/// As a list of both ends; in JSON, which has no infinity, null where the data set none.
impl Serialize for Interval {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.lower, self.upper].serialize(serializer)
    }
}

/// A point estimate with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Point estimate.
    pub value: f64,
    /// Confidence interval of the estimated quantity.
    #[serde(rename = "interval_95")]
    pub interval: Interval,
}

/// Whether a level is one that a statistic can keep.
pub(super) fn is_level(level: f64) -> bool {
    0.0 < level && level < 1.0
}
