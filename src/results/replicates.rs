//! What the replicates of a sampling design say where its episodes are not independent.

use crate::statistics::{Estimate, LEVEL, replicate_mean, replicate_p};
use serde::Serialize;

/// Fewest replicates of a sampling design whose scatter gives an interval.
pub const FEWEST_REPLICATES: usize = 5;

/// What the replicates of a sampling design say of a difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Replicated {
    /// Mean of the replicates' estimates, with Student's t interval.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// p-value of Student's t test that there is no difference.
    pub p: f64,
}

/// Student's t over the estimates of replicates; none of too few, of any that is infinite, and of replicates that are
/// all alike: such as have no failure show no scatter, and an interval of no width would claim certainty.
#[expect(clippy::float_cmp, reason = "equal estimates, of which rates have few")]
pub(super) fn over_replicates(estimates: &[f64]) -> Option<Replicated> {
    let alike = estimates.windows(2).all(|pair| pair[0] == pair[1]);
    if estimates.len() < FEWEST_REPLICATES || alike {
        return None;
    }
    Some(Replicated {
        estimate: replicate_mean(estimates, LEVEL)?,
        p: replicate_p(estimates)?,
    })
}
