//! What is said of a run that is whole, and how the program ends then.

use super::console::{print, print_json};
use super::exit::{Code, Failure};
use std::path::Path;
use urts_mc::campaign::Campaign;
use urts_mc::report::problems::shortcoming;
use urts_mc::report::requirements::unmet;
use urts_mc::report::terminal::{self, Amount};
use urts_mc::run::Findings;

/// How much is printed.
pub(super) struct Said {
    pub(super) json: bool,
    pub(super) quiet: bool,
    pub(super) verbose: bool,
}

impl Said {
    /// Prints what a run in a directory found.
    pub(super) fn print(
        &self,
        campaign: &Campaign,
        findings: &Findings,
        out: &Path,
    ) -> Result<(), Failure> {
        let amount = match self.verbose {
            true => Amount::Everything,
            false => Amount::Screen,
        };
        match (self.json, self.quiet) {
            (true, _) => print_json(findings),
            (false, true) => Ok(()),
            (false, false) => print(&terminal::findings(campaign, findings, out, amount)),
        }
    }
}

/// How a run ends the program: with what it falls short of, or with what was required and does not hold.
pub(super) fn judged(findings: &Findings, out: &Path) -> Result<Code, Failure> {
    if let Some(error) = shortcoming(&findings.manifest, out) {
        return Err(Failure::new(Code::Other, error));
    }
    match unmet(&findings.manifest) {
        None => Ok(Code::Done),
        Some(unmet) => Err(Failure::new(Code::Unmet, unmet)),
    }
}
