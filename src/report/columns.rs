//! The data dictionary as a chapter, and as a command prints it.

use super::page::document::{Block, Cell, Document, Grid, Section};
use super::page::markdown::{Length, markdown};
use super::page::text::text;
use crate::results::dictionary::{ColumnEntry, DICTIONARY};

/// Tables with a sentence on their rows, in the order of the chapter.
const TABLES: &[(&str, &str)] = &[
    ("episodes", "a row per episode, controller and agent"),
    (
        "channels",
        "a row per episode, controller, agent and channel",
    ),
    ("faults", "a row per fault that an agent has in an episode"),
    ("conditions", "a row per number that was drawn and applies"),
    (
        "summary",
        "a row per controller, stratum, metric and channel group",
    ),
    ("fairness", "a row per controller and channel group"),
    (
        "comparison",
        "a row per pair of controllers, stratum, and channel group or channel",
    ),
    ("screening", "a row per controller and stratum with faults"),
    ("ranking", "a row per target and condition"),
    (
        "worst",
        "a row for each of the ten worst episodes of a controller",
    ),
    (
        "curves",
        "a row per point: pictures of a run without its large tables",
    ),
    (
        "flights",
        "a row per flight, controller, channel group and instant",
    ),
    ("replay", "a row per instant, agent and channel"),
];

/// The chapter on the tables' columns.
#[must_use]
pub fn columns_chapter() -> String {
    markdown(&document(), Length::Full)
}

/// The same for a terminal.
#[must_use]
pub fn columns() -> String {
    text(&document())
}

fn document() -> Document {
    Document {
        title: "Columns of the tables".into(),
        subtitle: "written by urts-mc columns".into(),
        lead: Vec::new(),
        about: "Every column of every Parquet file. Whole numbers have 64 bits and a sign, real numbers double precision; an \
                empty cell is null. Parts of names in angle brackets stand for any text. A team's error is the same \
                everywhere: the root of the mean over agents and channels of their squared RMS errors. In a file's \
                metadata urts-mc.campaign, .campaign_blake3, .seed and .version say where it comes from, and \
                urts-mc.unit.<column> the units."
            .into(),
        sections: TABLES.iter().map(|(name, rows)| section(name, rows)).collect(),
        ..Document::default()
    }
}

fn section(table: &str, rows: &str) -> Section {
    let mut grid = Grid::new(["column", "type", "unit", "what it is", "empty where"]);
    let of_table = |own: &&ColumnEntry| own.tables.split(' ').any(|name| name == table);
    for own in DICTIONARY.iter().filter(of_table) {
        grid.rows.push(vec![
            Cell::Code(own.name.to_string()),
            Cell::text(own.kind.word()),
            Cell::text(own.unit),
            Cell::text(own.meaning),
            Cell::text(own.empty),
        ]);
    }
    Section::explained(table, format!(": {rows}"), vec![Block::Grid(grid)])
}
