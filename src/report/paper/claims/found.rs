//! A claim, and how it is judged.

use crate::report::paper::scenarios::{Scenario, Scenarios};

/// Where the paper has the errors of its UAV settled, s.
pub(super) const SETTLED_S: f64 = 2.0;
/// A claim of the paper, and what was measured.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Where the paper says so.
    pub place: &'static str,
    /// What it says, in short.
    pub claim: &'static str,
    /// What was measured here.
    pub measured: String,
    /// Whether it holds; `None` where the episode does not decide.
    pub holds: Option<bool>,
}

/// What was found out about a claim.
pub(super) struct Found {
    pub(super) measured: String,
    /// All numbers that the verdict reads.
    pub(super) read: Vec<f64>,
    /// None where numbers cannot decide.
    pub(super) holds: Option<bool>,
}

/// Judges a claim by the episodes that it reads; nothing is decided by an episode that diverges, or by numbers that are
/// none.
pub(super) fn decide(
    place: &'static str,
    claim: &'static str,
    scenarios: &Scenarios,
    reads: &[Scenario],
    judge: impl Fn(&Scenarios) -> Found,
) -> Claim {
    let lost = reads
        .iter()
        .find_map(|simulated| Some((simulated.name(), scenarios.lost_s(*simulated)?)));
    let (measured, holds) = match lost {
        Some((controller_name, lost_s)) => {
            let text = format!(
                "{controller_name} diverges within {lost_s:.2} s: there is nothing to measure"
            );
            (text, None)
        }
        None => {
            let found = judge(scenarios);
            let decided = found.read.iter().all(|value| value.is_finite());
            (found.measured, found.holds.filter(|_| decided))
        }
    };
    Claim {
        place,
        claim,
        measured,
        holds,
    }
}
