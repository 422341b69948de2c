//! A document as text for a terminal: headings bold, columns in line. Whoever prints it takes the styles out where
//! there is no terminal.

use super::document::{Block, Cell, Document, Grid};
use anstyle::{AnsiColor, Style};
use std::fmt::Write;

/// A heading.
const HEADING: Style = Style::new().bold();
/// What does not hold or went wrong.
pub const BAD: Style = AnsiColor::Red.on_default().bold();
/// What holds.
const GOOD: Style = AnsiColor::Green.on_default();

/// Blanks by which what belongs to a heading is further to the right.
const INDENT: usize = 2;

/// The text; figures are in the HTML report.
pub(crate) fn text(document: &Document) -> String {
    let mut text = String::new();
    let title = styled(HEADING, &document.title);
    match (&*title, &*document.subtitle) {
        ("", _) => {}
        (title, "") => line(&mut text, 0, title),
        (title, subtitle) => line(&mut text, 0, &format!("{title}: {subtitle}")),
    }
    for sentence in document.lead.iter().chain(&document.warnings) {
        paragraph(&mut text, INDENT, sentence);
    }
    for section in &document.sections {
        if section.is_empty() {
            continue;
        }
        if !text.is_empty() {
            text.push('\n');
        }
        let indent = match &*section.heading {
            "" => 0,
            heading => {
                let heading = styled(HEADING, heading);
                line(&mut text, 0, &format!("{heading}{}", section.note));
                INDENT
            }
        };
        blocks(&mut text, indent, &section.blocks);
    }
    text
}

fn blocks(text: &mut String, indent: usize, blocks: &[Block]) {
    for block in blocks {
        match block {
            Block::Text(content) => paragraph(text, indent, content),
            Block::Code(content) => paragraph(text, indent, content.trim_end()),
            Block::Grid(grid) => of_grid(text, indent, grid),
            Block::Figure(_) => {}
            Block::Folded(summary, inner) => {
                line(text, indent, summary);
                self::blocks(text, indent + INDENT, inner);
            }
        }
    }
}

/// Lines, all but the first further to the right.
fn paragraph(text: &mut String, indent: usize, content: &str) {
    for (place, content) in content.lines().enumerate() {
        line(
            text,
            if place == 0 { indent } else { indent + INDENT },
            content,
        );
    }
}

fn line(text: &mut String, indent: usize, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{:indent$}{}", "", content.trim_end());
}

fn of_grid(text: &mut String, indent: usize, grid: &Grid) {
    let columns = grid.rows.iter().map(Vec::len).max().unwrap_or(0);
    let columns = columns.max(grid.head.len());
    let widths: Vec<usize> = (0..columns)
        .map(|column| {
            let cells = grid.rows.iter().filter_map(|row| row.get(column));
            let cells = cells.map(|cell| width(&plain(cell)));
            let head = grid.head.get(column).map(|head| width(head));
            cells.chain(head).max().unwrap_or(0)
        })
        .collect();
    if grid.head.iter().any(|head| !head.is_empty()) {
        let heads = grid.head.iter().zip(&widths).enumerate();
        let heads = heads.map(|(column, (head, width))| {
            let cell = grid.rows.first().and_then(|row| row.get(column));
            padded(head, *width, matches!(cell, Some(Cell::Number(_))))
        });
        line(text, indent, &heads.collect::<Vec<_>>().join("  "));
    }
    for row in &grid.rows {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, width))| {
            // Nothing stands behind the last.
            let is_number = matches!(cell, Cell::Number(_));
            let padded = match column + 1 == row.len() && !is_number {
                true => plain(cell),
                false => padded(&plain(cell), *width, is_number),
            };
            match cell {
                Cell::Verdict(true, _) => styled(GOOD, &padded),
                Cell::Verdict(false, _) => styled(BAD, &padded),
                _ => padded,
            }
        });
        line(text, indent, &cells.collect::<Vec<_>>().join("  "));
    }
}

fn plain(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) | Cell::Number(text) | Cell::Code(text) | Cell::Verdict(_, text) => {
            text.clone()
        }
        Cell::Spreads(spreads) => {
            let texts = spreads.iter().map(super::document::Spread::text);
            texts.collect::<Vec<_>>().join(", ")
        }
    }
}

fn width(text: &str) -> usize {
    text.chars().count()
}

fn padded(text: &str, to: usize, right: bool) -> String {
    match right {
        true => format!("{text:>to$}"),
        false => format!("{text:<to$}"),
    }
}

fn styled(style: Style, text: &str) -> String {
    match text {
        "" => String::new(),
        text => format!("{style}{text}{style:#}"),
    }
}
