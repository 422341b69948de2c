//! What a search found.

use crate::report::page::document::{Block, Document, Section};
use crate::report::page::text::text;
use crate::report::tuning::{lead, reached, subtitle, used, warnings};
use crate::run::tune::Tuning;
use std::path::Path;

/// What a search found, and where it was written.
pub fn tuning(tuning: &Tuning, out: &Path) -> String {
    let mut table = reached(tuning);
    table.blocks.truncate(1);
    let files = "tune.parquet has every candidate, tune.html the figures, gains.json the gains";
    text(&Document {
        title: format!("{}: {}", tuning.campaign.name, tuning.structure.tuned),
        subtitle: subtitle(tuning),
        lead: lead(tuning),
        warnings: warnings(tuning),
        sections: vec![
            table,
            used(tuning),
            Section::new(
                format!("written to {}", out.display()),
                vec![Block::text(files)],
            ),
        ],
        ..Document::default()
    })
}
