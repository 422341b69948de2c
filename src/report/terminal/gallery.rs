//! The campaigns that are part of the program.

use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;

/// Every campaign of the gallery, each by its name and what it is for.
pub fn gallery(campaigns: &[(String, String)]) -> String {
    let rows = campaigns.iter().map(|(name, description)| {
        let first = description.split(". ").next().unwrap_or_default();
        vec![Cell::text(name), Cell::text(first.trim_end_matches('.'))]
    });
    let grid = Grid {
        head: Vec::new(),
        rows: rows.collect(),
    };
    text(&Document {
        sections: vec![Section::new("gallery", vec![Block::Grid(grid)])],
        ..Document::default()
    })
}
