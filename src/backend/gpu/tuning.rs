//! How the work of a GPU is cut up.

/// How the work is cut up. The result does not depend on it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tuning {
    /// Episodes per batch, as far as the adapter allows; else as many as fit.
    pub batch: Option<u32>,
    /// Steps per dispatch, as far as the adapter allows; else what takes about 0.1 s.
    pub steps: Option<u32>,
}
