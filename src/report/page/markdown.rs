//! A document as Markdown, for a pull request: the same words and tables, without the drawings.

use super::document::{Block, Cell, Document, Grid};

/// The text; figures are in the HTML report.
pub(crate) fn markdown(document: &Document) -> String {
    let mut text = format!(
        "# {}\n\n{}\n",
        plain(&document.title),
        plain(&document.subtitle)
    );
    for sentence in &document.lead {
        text.push_str(&format!("\n**{}**\n", plain(sentence)));
    }
    for warning in &document.warnings {
        text.push_str(&format!("\n> {}\n", plain(warning)));
    }
    for section in &document.sections {
        let mut body = String::new();
        section
            .blocks
            .iter()
            .for_each(|block| of_block(&mut body, block));
        // A section of drawings alone has nothing to say here.
        if !body.is_empty() {
            let heading = format!("{}{}", section.heading, section.note);
            text.push_str(&format!("\n## {}\n{body}", plain(&heading)));
        }
    }
    text
}

fn of_block(text: &mut String, block: &Block) {
    match block {
        Block::Text(content) => text.push_str(&format!("\n{}\n", plain(content))),
        Block::Code(content) => text.push_str(&format!("\n```\n{}\n```\n", content.trim_end())),
        Block::Grid(grid) => of_grid(text, grid),
        Block::Figure(_) => {}
        Block::Folded(summary, blocks) => {
            let mut inner = String::new();
            blocks.iter().for_each(|block| of_block(&mut inner, block));
            if !inner.is_empty() {
                text.push_str(&format!(
                    "\n<details><summary>{}</summary>\n{inner}\n</details>\n",
                    plain(summary)
                ));
            }
        }
    }
}

fn of_grid(text: &mut String, grid: &Grid) {
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
    for cells in &grid.rows {
        text.push_str(&row(cells.iter().map(of_cell).collect()));
    }
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
