//! What a run comes to: its verdict and its requirements.

use crate::campaign::Campaign;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::results::{RequirementResult, how_sure};
use crate::run::Findings;
use crate::util::format::rounded_up;

/// Who does better, in a sentence each.
pub(super) fn in_short(campaign: &Campaign, findings: &Findings) -> Section {
    let sure = match findings.manifest.episodes {
        1 => String::new(),
        _ => format!(" ({})", how_sure(campaign)),
    };
    let sentences = findings.results.verdict.iter().map(Block::text);
    Section::explained("in short", sure, sentences.collect())
}

/// What became of each `[[require]]`, one a line.
pub(super) fn requirements(results: &[RequirementResult]) -> Section {
    let mut grid = Grid::default();
    for (index, result) in results.iter().enumerate() {
        let met = result.is_met();
        grid.rows.push(vec![
            Cell::Verdict(met, if met { "met" } else { "UNMET" }.into()),
            Cell::text(format!("require[{index}]")),
            Cell::text(result.subject()),
            Cell::text(format!(
                "below {}, required {:.4} ({} of {} failed)",
                rounded_up(result.upper_95, 4),
                result.limit,
                result.failed,
                result.n
            )),
        ]);
    }
    let note = ": the failure rate with 95 % confidence";
    Section::explained("requirements", note, vec![Block::Grid(grid)])
}
