//! How much of a run's findings a command prints.

/// How much of the findings is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amount {
    /// What fits a screen: the rest is in the report.
    Screen,
    /// Everything that can be said without figures.
    Everything,
}
