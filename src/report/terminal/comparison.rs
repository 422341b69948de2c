//! How two runs compare.

use crate::report::comparison::{head, pairs, requirements};
use crate::report::page::document::{Block, Document, Section};
use crate::report::page::text::text;
use crate::run::compare::RunComparison;
use std::path::Path;

/// How two runs compare, and where it was written.
pub fn comparison(found: &RunComparison, out: &Path) -> String {
    let mut head = head(found);
    // What it comes to stands at the end, where a terminal shows it.
    let lead = std::mem::take(&mut head.lead);
    let conclusion = lead.into_iter().map(Block::Text).collect();
    let files = "comparison.parquet has every stratum and channel, compare.html the whole";
    let all = [
        pairs(found),
        requirements(found),
        Section::new("in short", conclusion),
        Section::new(
            format!("written to {}", out.display()),
            vec![Block::text(files)],
        ),
    ];
    let notes = found.notes.iter().map(|note| format!("note: {note}"));
    text(&Document {
        lead: notes.collect(),
        sections: all.into_iter().filter(|own| !own.is_empty()).collect(),
        ..head
    })
}
