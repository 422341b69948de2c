//! A claim, and how it is judged.

use crate::report::paper::scenarios::{READINGS, Scenario, Scenarios};

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
    let (measured, holds) = judged(scenarios, reads, judge);
    Claim {
        place,
        claim,
        measured,
        holds,
    }
}

/// Judges a claim about the paper's PID under each of its readings, beside the other episodes that it reads: by the one
/// that flies. What the other would make of it is said, too. Where `lost` is an answer, an episode that diverges is
/// judged.
pub(super) fn decide_of_pid(
    place: &'static str,
    claim: &'static str,
    scenarios: &Scenarios,
    (reads, lost): (&[Scenario], bool),
    judge: impl Fn(&Scenarios, Scenario) -> Found,
) -> Claim {
    let of_reading = |reading: Scenario| {
        let reads = match lost {
            true => reads.to_vec(),
            false => [reads, &[reading]].concat(),
        };
        let (measured, holds) = judged(scenarios, &reads, |scenarios| judge(scenarios, reading));
        let words = match holds {
            Some(true) => "holds",
            Some(false) => "does not hold",
            None => "not decided",
        };
        let measured = format!("{}, {words}: {measured}", scenarios.reading(reading));
        (measured, holds)
    };
    let all = READINGS.map(of_reading);
    let flies = scenarios.flying_pid();
    let decides = READINGS.iter().position(|reading| *reading == flies);
    Claim {
        place,
        claim,
        holds: all[decides.unwrap_or_default()].1,
        measured: all.map(|(measured, _)| measured).join(". "),
    }
}

/// What was measured, and whether a claim holds.
fn judged(
    scenarios: &Scenarios,
    reads: &[Scenario],
    judge: impl Fn(&Scenarios) -> Found,
) -> (String, Option<bool>) {
    let lost = reads
        .iter()
        .find_map(|simulated| Some((simulated.name(), scenarios.lost_s(*simulated)?)));
    match lost {
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
    }
}
