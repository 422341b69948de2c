//! What a report or a command says, apart from how it looks: the same blocks become HTML, Markdown and text.

use super::plot::{Color, Plot, Stroke};
use crate::util::format;

/// A report.
#[derive(Debug, Clone, Default)]
pub(crate) struct Document {
    pub(crate) title: String,
    /// What it is about, in a line.
    pub(crate) subtitle: String,
    /// What is tested and why, in the words of who tests it; empty if nothing is said.
    pub(crate) about: String,
    /// What matters most, a sentence each.
    pub(crate) lead: Vec<String>,
    /// What is compared, at a glance.
    pub(crate) band: Vec<Card>,
    /// What is wrong with the run.
    pub(crate) warnings: Vec<String>,
    pub(crate) sections: Vec<Section>,
}

/// Something that is compared, or asked, with its numbers in large figures.
#[derive(Debug, Clone, Default)]
pub(crate) struct Card {
    pub(crate) name: String,
    /// The colour that stands for it in all figures, if it has one.
    pub(crate) color: Option<Color>,
    /// What it is.
    pub(crate) note: String,
    /// Numbers, each with what it is.
    pub(crate) numbers: Vec<(String, String)>,
    /// Whether it holds, of something that is asked.
    pub(crate) holds: Option<bool>,
}

/// A part of a report.
#[derive(Debug, Clone, Default)]
pub(crate) struct Section {
    /// Empty where what it says needs none.
    pub(crate) heading: String,
    /// What the heading stands for, as its continuation: with a comma, a colon or in parentheses.
    pub(crate) note: String,
    pub(crate) blocks: Vec<Block>,
}

impl Section {
    pub(crate) fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self::explained(heading, "", blocks)
    }

    /// With what the heading stands for.
    pub(crate) fn explained(
        heading: impl Into<String>,
        note: impl Into<String>,
        blocks: Vec<Block>,
    ) -> Self {
        Self {
            heading: heading.into(),
            note: note.into(),
            blocks,
        }
    }

    /// Whether there is nothing in it.
    pub(crate) fn is_empty(&self) -> bool {
        self.blocks.iter().all(|block| match block {
            Block::Grid(grid) => grid.rows.is_empty(),
            Block::Text(_) | Block::Code(_) | Block::Figure(_) | Block::Folded(..) => false,
        })
    }
}

/// A piece of a part.
#[derive(Debug, Clone)]
pub(crate) enum Block {
    /// A paragraph.
    Text(String),
    /// A command to type, or a file's text.
    Code(String),
    Grid(Grid),
    Figure(Figure),
    /// Details that are shown on demand.
    Folded(String, Vec<Block>),
}

impl Block {
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// A table.
#[derive(Debug, Clone, Default)]
pub(crate) struct Grid {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

impl Grid {
    pub(crate) fn new<const N: usize>(head: [&str; N]) -> Self {
        Self {
            head: head.map(String::from).to_vec(),
            rows: Vec::new(),
        }
    }
}

/// A cell of a table.
#[derive(Debug, Clone)]
pub(crate) enum Cell {
    Text(String),
    Number(String),
    Code(String),
    /// Holds or does not.
    Verdict(bool, String),
    /// Values with their intervals, drawn on a common scale and written out.
    Spreads(Vec<Spread>),
}

impl Cell {
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    pub(crate) fn number(text: impl Into<String>) -> Self {
        Self::Number(text.into())
    }
}

/// A value with its interval, where it has one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spread {
    pub(crate) value: f64,
    pub(crate) interval: Option<[f64; 2]>,
    pub(crate) color: Color,
    pub(crate) scale: Scale,
}

/// What a value is drawn on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scale {
    /// From 0 to 100 %.
    Share,
    /// From -1 to 1.
    Correlation,
}

impl Scale {
    /// Both ends.
    pub(crate) fn ends(self) -> (f64, f64) {
        match self {
            Self::Share => (0.0, 1.0),
            Self::Correlation => (-1.0, 1.0),
        }
    }

    /// The labels of start, middle and end.
    pub(crate) fn labels(self) -> [&'static str; 3] {
        match self {
            Self::Share => ["0", "50", "100 %"],
            Self::Correlation => ["-1", "0", "1"],
        }
    }
}

impl Spread {
    /// In words.
    pub(crate) fn text(&self) -> String {
        match self.scale {
            Scale::Share => format::rate(self.value, self.interval),
            Scale::Correlation => format::correlation(self.value, self.interval),
        }
    }
}

/// Panels side by side that share a legend.
#[derive(Debug, Clone, Default)]
pub(crate) struct Figure {
    pub(crate) panels: Vec<Plot>,
    pub(crate) legend: Vec<LegendEntry>,
    pub(crate) caption: String,
}

/// What a colour of a figure stands for.
#[derive(Debug, Clone)]
pub(crate) struct LegendEntry {
    pub(crate) swatch: Swatch,
    pub(crate) color: Color,
    pub(crate) text: String,
}

/// How a key is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Swatch {
    Line,
    Dashes,
    /// A shaded span.
    Shade,
}

impl LegendEntry {
    pub(crate) fn line(color: Color, text: impl Into<String>) -> Self {
        Self::new(Swatch::Line, color, text)
    }

    pub(crate) fn dashes(color: Color, text: impl Into<String>) -> Self {
        Self::new(Swatch::Dashes, color, text)
    }

    pub(crate) fn shade(color: Color, text: impl Into<String>) -> Self {
        Self::new(Swatch::Shade, color, text)
    }

    /// The key of a line.
    pub(crate) fn of(stroke: Stroke, color: Color, text: impl Into<String>) -> Self {
        match stroke {
            Stroke::Dashed => Self::dashes(color, text),
            Stroke::Solid | Stroke::Steps => Self::line(color, text),
        }
    }

    fn new(swatch: Swatch, color: Color, text: impl Into<String>) -> Self {
        Self {
            swatch,
            color,
            text: text.into(),
        }
    }
}
