//! What a run is at.

/// What a run is at, reported while it goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The gains are synthesized or read.
    Gains,
    /// The simulation begins.
    Simulation,
    /// So many episodes were simulated by an earlier process, and are kept.
    Kept(u32),
    /// So many more episodes have been simulated.
    Simulated(u32),
    /// What was kept becomes tables.
    Tables,
    /// Some episodes are simulated again on the reference.
    CrossCheck,
    /// Intervals and tests.
    Statistics,
    /// Files.
    Writing,
}
