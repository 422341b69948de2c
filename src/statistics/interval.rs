//! Intervals, estimates and their confidence level.

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

/// A point estimate with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Point estimate.
    pub value: f64,
    /// Confidence interval of the estimated quantity.
    pub interval: Interval,
}

/// Whether a level is one that a statistic can keep.
pub(super) fn is_level(level: f64) -> bool {
    0.0 < level && level < 1.0
}
