//! The value of a reference at one instant.

/// A reference and its derivatives at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReferencePoint {
    /// r, m or rad.
    pub value: f64,
    /// r', 1/s.
    pub rate: f64,
    /// r'', 1/s^2.
    pub acceleration: f64,
}
