//! Where files that a command wrote are, and what the paper's claims became.

use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
use crate::report::paper::Claim;
use crate::run::error::REPORTS;
use std::path::Path;

/// Where the report of a run is.
pub fn report(dir: &Path) -> String {
    format!("the report: {}\n", dir.join(REPORTS[0]).display())
}

/// What became of the paper's claims, one a line, and where the figures are.
pub fn paper(claims: &[Claim], dir: &Path) -> String {
    let rows = claims.iter().map(|claim| {
        let holds = match claim.holds {
            Some(true) => Cell::Verdict(true, "holds".into()),
            Some(false) => Cell::Verdict(false, "FAILS".into()),
            None => Cell::text("open"),
        };
        let said = format!("{}  {}: {}", claim.place, claim.claim, claim.measured);
        vec![holds, Cell::text(said)]
    });
    let grid = Grid {
        head: Vec::new(),
        rows: rows.collect(),
    };
    let figures = format!("the figures: {}", dir.join("README.md").display());
    text(&Document {
        sections: vec![Section::new(
            "",
            vec![Block::Grid(grid), Block::Text(figures)],
        )],
        ..Document::default()
    })
}
