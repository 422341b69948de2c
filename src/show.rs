//! What the commands print.

mod attenuation;
mod conclusion;
mod devices;
mod drawn;
mod effort;
mod findings;
mod findings_json;
mod gains;
mod plan;
mod replay;
mod runs;
mod screening;
mod style;

pub(crate) use devices::devices;
pub(crate) use findings::findings;
pub(crate) use findings_json::findings_json;
pub(crate) use gains::{gains, synthesis};
pub(crate) use plan::{plan, plan_json};
pub(crate) use replay::{replay, replay_json};
pub(crate) use runs::{runs, runs_json};
pub(crate) use style::BAD;

use std::fmt::Write;
use std::path::Path;
use urts_mc::output::REPORTS;
use urts_mc::paper::Claim;

/// Where the report of a run is.
pub(crate) fn report(dir: &Path) -> String {
    format!("the report: {}\n", dir.join(REPORTS[0]).display())
}

/// What became of the paper's claims, one a line, and where the figures are.
pub(crate) fn paper(claims: &[Claim], dir: &Path) -> String {
    let mut text = String::new();
    for claim in claims {
        let holds = match claim.holds {
            Some(true) => "holds",
            Some(false) => "FAILS",
            None => "open ",
        };
        let (place, said, found) = (claim.place, claim.claim, &claim.measured);
        line(&mut text, &format!("{holds}  {place}  {said}: {found}"));
    }
    line(
        &mut text,
        &format!("the figures: {}", dir.join("README.md").display()),
    );
    text
}

fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}
