//! A document as Markdown, for a pull request: the same words and tables, without the drawings.

use super::document::{Block, Card, Cell, Document, Grid};

/// As long as a comment on GitHub may be, with room for what somebody writes above it.
const LONGEST: usize = 64_000;
/// Rows of a table in a brief report, unless it grows too long all the same.
const ROWS: usize = 24;

/// How much of a document is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// At most what a comment on GitHub holds: no details that are shown on demand, and the first rows of long tables.
    Brief,
    /// Everything.
    Full,
}

/// The text; figures are in the HTML report.
pub(crate) fn markdown(document: &Document, length: Length) -> String {
    let mut writer = Writer { rows: None };
    if length == Length::Full {
        return writer.document(document);
    }
    let mut rows = ROWS;
    loop {
        writer.rows = Some(rows);
        let text = writer.document(document) + "\nIn brief: the HTML report has the whole.\n";
        if text.len() <= LONGEST || rows == 0 {
            return cut(text);
        }
        rows /= 2;
    }
}

/// A text that is too long even without its tables, cut at a line.
fn cut(text: String) -> String {
    if text.len() <= LONGEST {
        return text;
    }
    let mut kept = String::new();
    for line in text.lines() {
        if kept.len() + line.len() > LONGEST {
            break;
        }
        kept.push_str(line);
        kept.push('\n');
    }
    kept + "\n(cut here: the whole is in the HTML report)\n"
}

/// What is left out of a document.
struct Writer {
    /// Rows of a table, and no details on demand; all of both if not given.
    rows: Option<usize>,
}

impl Writer {
    fn document(&self, document: &Document) -> String {
        let mut text = format!(
            "# {}\n\n{}\n",
            plain(&document.title),
            plain(&document.subtitle)
        );
        if !document.about.is_empty() {
            text.push_str(&format!("\n{}\n", plain(&document.about)));
        }
        for sentence in &document.lead {
            text.push_str(&format!("\n**{}**\n", plain(sentence)));
        }
        for warning in &document.warnings {
            text.push_str(&format!("\n> {}\n", plain(warning)));
        }
        if !document.band.is_empty() {
            text.push('\n');
        }
        for card in &document.band {
            text.push_str(&of_card(card));
        }
        for section in &document.sections {
            let mut body = String::new();
            section
                .blocks
                .iter()
                .for_each(|block| self.block(&mut body, block));
            // A section of drawings alone has nothing to say here.
            if !body.is_empty() {
                let heading = format!("{}{}", section.heading, section.note);
                text.push_str(&format!("\n## {}\n{body}", plain(&heading)));
            }
        }
        text
    }

    fn block(&self, text: &mut String, block: &Block) {
        match block {
            Block::Text(content) => text.push_str(&format!("\n{}\n", plain(content))),
            Block::Code(content) => {
                text.push_str(&format!("\n```\n{}\n```\n", content.trim_end()));
            }
            Block::Grid(grid) => self.grid(text, grid),
            Block::Figure(_) => {}
            Block::Folded(..) if self.rows.is_some() => {}
            Block::Folded(summary, blocks) => {
                let mut inner = String::new();
                blocks
                    .iter()
                    .for_each(|block| self.block(&mut inner, block));
                if !inner.is_empty() {
                    text.push_str(&format!(
                        "\n<details><summary>{}</summary>\n{inner}\n</details>\n",
                        plain(summary)
                    ));
                }
            }
        }
    }

    fn grid(&self, text: &mut String, grid: &Grid) {
        let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        text.push('\n');
        text.push_str(&row(grid.head.iter().map(|name| plain(name)).collect()));
        let first = grid.rows.first();
        let rule = (0..grid.head.len()).map(|column| {
            let cell = first.and_then(|row| row.get(column));
            match cell {
                Some(Cell::Number(_)) => "---:".to_string(),
                _ => "---".to_string(),
            }
        });
        text.push_str(&row(rule.collect()));
        let shown = self.rows.unwrap_or(usize::MAX);
        for cells in grid.rows.iter().take(shown) {
            text.push_str(&row(cells.iter().map(of_cell).collect()));
        }
        match grid.rows.len().saturating_sub(shown) {
            0 => {}
            1 => text.push_str("\nOne more row is in the HTML report.\n"),
            more => text.push_str(&format!("\n{more} more rows are in the HTML report.\n")),
        }
    }
}

/// A card as an item of a list.
fn of_card(card: &Card) -> String {
    let verdict = match card.holds {
        Some(true) => "✓ ",
        Some(false) => "✗ ",
        None => "",
    };
    let note = match card.note.is_empty() {
        true => String::new(),
        false => format!(" ({})", plain(&card.note)),
    };
    let numbers = card.numbers.iter();
    let numbers: Vec<String> = numbers
        .map(|(number, label)| format!("{} {}", plain(number), plain(label)))
        .collect();
    format!(
        "- {verdict}**{}**{note}: {}\n",
        plain(&card.name),
        numbers.join("; ")
    )
}

fn of_cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) | Cell::Number(text) => plain(text),
        Cell::Code(text) => format!("`{}`", text.replace('|', "\\|")),
        Cell::Verdict(true, text) => format!("✓ {}", plain(text)),
        Cell::Verdict(false, text) => format!("✗ {}", plain(text)),
        Cell::Spreads(spreads) => {
            let texts = spreads.iter().map(|spread| plain(&spread.text()));
            texts.collect::<Vec<_>>().join("<br>")
        }
    }
}

/// Text whose signs Markdown does not take for its own.
fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if matches!(
            letter,
            '|' | '*' | '_' | '`' | '<' | '>' | '[' | ']' | '\\' | '#'
        ) {
            plain.push('\\');
        }
        plain.push(if letter == '\n' { ' ' } else { letter });
    }
    plain
}
