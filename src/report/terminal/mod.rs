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

pub use devices::devices;
pub use findings::findings;
pub use findings_json::findings_json;
pub use gains::{gains, synthesis};
pub use plan::{plan, plan_json};
pub use replay::{replay, replay_json};
pub use runs::{runs, runs_json};
pub use style::BAD;

use super::paper::Claim;
use crate::run::error::REPORTS;
use std::fmt::Write;
use std::path::Path;

/// Where the report of a run is.
pub fn report(dir: &Path) -> String {
    format!("the report: {}\n", dir.join(REPORTS[0]).display())
}

/// What became of the paper's claims, one a line, and where the figures are.
pub fn paper(claims: &[Claim], dir: &Path) -> String {
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
