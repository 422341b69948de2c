//! The report of a run: a page that opens from disk, and the same in Markdown, made of the run's directory alone.
//!
//! Run data (what the directory holds) becomes a document (what is to be said), which becomes HTML and Markdown (how it
//! looks).

mod columns;
mod comparison;
mod drawn_values;
mod episode;
pub mod junit;
pub mod notes;
pub(crate) mod page;
pub mod paper;
pub mod problems;
pub mod requirements;
mod robot_picture;
mod run_data;
pub(crate) mod section;
pub mod submission;
pub mod terminal;
mod times;
mod tuning;

pub use columns::{columns, columns_chapter};
pub use comparison::{comparison, regressions};
pub use episode::{Trace, trace};
pub use page::markdown::Length;
pub use robot_picture::robot_picture;
pub use run_data::ReportError;
pub use tuning::tuning;

use crate::results::how_sure;
use crate::run::directory::OutputDir;
use crate::run::error::REPORTS;
use page::document::{Block, Document, Section};
use page::plot::Color;
use page::{html, markdown};
use problems::shortcoming;
use requirements::unmet;
use run_data::RunData;
use section::{band, conditions, errors, failures, fairness, flights, gains, provenance, strata};
use std::path::Path;

/// Writes `report.html` and `report.md` of the run in a directory, the latter at some length.
///
/// # Errors
/// If the directory holds no run, or cannot be written.
pub fn report(dir: &Path, length: Length) -> Result<(), ReportError> {
    let data = RunData::read(dir)?;
    let document = document(&data);
    let out = OutputDir::existing(dir);
    let [html, markdown] = REPORTS;
    out.write(html, html::html(&document).as_bytes())?;
    out.write(markdown, markdown::markdown(&document, length).as_bytes())?;
    Ok(())
}

fn document(data: &RunData) -> Document {
    let manifest = &data.manifest;
    let campaign = &data.campaign;
    let wrong = [shortcoming(manifest, &data.dir), unmet(manifest)];
    let sections = [
        fairness::section(data),
        flights::section(data),
        Some(failures::section(data)),
        Some(errors::pairs(data)),
        Some(errors::distributions(data)),
        strata::section(data),
        Some(conditions::ranking(data)),
        Some(conditions::worst(data)),
        Some(gains::section(data)),
        Some(conditions::drawn(data)),
        Some(provenance::section(data)),
    ];
    let mut lead = manifest.verdict.clone();
    if manifest.episodes > 1 && campaign.controllers.len() > 1 {
        lead.push(format!("({})", how_sure(campaign)));
    }
    Document {
        title: manifest.name.clone(),
        subtitle: format!(
            "{} episodes of {} over {} s under {}; seed {}",
            manifest.episodes,
            campaign.agents_in_words(),
            f64::from(campaign.time.steps) * campaign.time.step_s,
            campaign.controllers.join(", "),
            manifest.seed
        ),
        about: campaign.description.clone(),
        lead,
        band: band::band(data),
        warnings: wrong.into_iter().flatten().collect(),
        sections: sections.into_iter().flatten().map(thinned).collect(),
    }
}

/// Controllers that a figure shows: more curves cannot be told apart, and the tables have them all.
const MOST_DRAWN: usize = 12;

/// A section whose figures show no more controllers than can be told apart.
fn thinned(mut section: Section) -> Section {
    section.blocks.iter_mut().for_each(thin);
    section
}

fn thin(block: &mut Block) {
    let is_shown = |color: Color| !matches!(color, Color::Series(own) if own >= MOST_DRAWN);
    match block {
        Block::Figure(figure) => {
            for plot in &mut figure.panels {
                plot.marks.retain(|mark| is_shown(mark.color()));
            }
            let all = figure.legend.len();
            figure.legend.retain(|entry| is_shown(entry.color));
            if figure.legend.len() < all {
                let words =
                    format!(" Drawn are the first {MOST_DRAWN} controllers; the tables have all.");
                figure.caption.push_str(&words);
            }
        }
        Block::Folded(_, inner) => inner.iter_mut().for_each(thin),
        _ => {}
    }
}
