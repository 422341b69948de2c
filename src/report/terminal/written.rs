//! Where files that a command wrote are, and what the paper's claims became.

use super::text::line;
use crate::report::paper::Claim;
use crate::run::error::REPORTS;
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
