//! What each stratum does to each controller.

use super::failures::rate;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::page::plot::Color;
use crate::report::run_data::RunData;
use crate::util::format;

/// The forest of failure rates and the growth of the errors; none of a campaign without strata.
pub(crate) fn section(evidence: &RunData) -> Option<Section> {
    let strata = evidence.campaign.strata.all();
    if strata.is_empty() {
        return None;
    }
    let names: Vec<String> = evidence
        .campaign
        .controllers
        .iter()
        .map(ToString::to_string)
        .collect();
    let mut forest = Grid {
        head: vec![
            "stratum".into(),
            format!("failure rate: {}", names.join(", ")),
            "episodes".into(),
        ],
        rows: Vec::new(),
    };
    for stratum in strata {
        let mut n = f64::NAN;
        let mut rates = Vec::new();
        for (index, name) in names.iter().enumerate() {
            let wanted = [("stratum", &*stratum.name), ("controller", name)];
            if let Some(row) = evidence.summary.find(&wanted).next() {
                n = evidence.summary.real(row, "n");
                rates.push(rate(evidence, row, Color::Series(index)));
            }
        }
        forest.rows.push(vec![
            Cell::text(&*stratum.name),
            Cell::Spreads(rates),
            Cell::number(format!("{n:.0}")),
        ]);
    }
    let sentences = evidence.manifest.harm.iter();
    let mut blocks: Vec<Block> = sentences
        .map(|own| Block::Text(format!("{own}.")))
        .collect();
    blocks.push(Block::text(
        "Points are failure rates, bars their 95 % intervals, from 0 to 100 %; the controllers in this order, top to bottom, in \
         the colours of the figures.",
    ));
    blocks.push(Block::Grid(forest));
    if evidence.screening.rows() > 0 {
        blocks.push(Block::Folded(
            "Growth of the errors".into(),
            vec![Block::Grid(growth(evidence))],
        ));
    }
    Some(Section::new("By stratum", blocks))
}

fn growth(evidence: &RunData) -> Grid {
    let sheet = &evidence.screening;
    let roles = evidence.campaign.channel_groups();
    let mut grid = Grid::new(["controller", "stratum", "against"]);
    let groups = roles.iter().map(|group| group.role.name());
    grid.head
        .extend(groups.map(|name| format!("median RMS error grows by a factor of [95 %], {name}")));
    for row in 0..sheet.rows() {
        let mut cells = vec![
            Cell::text(sheet.text(row, "controller")),
            Cell::text(sheet.text(row, "stratum")),
            Cell::text(sheet.text(row, "reference")),
        ];
        for group in &roles {
            let factor = |side: &str| {
                sheet
                    .real(row, &format!("log_growth_{}{side}", group.role.name()))
                    .exp()
            };
            cells.push(Cell::number(format::measured(
                factor(""),
                factor("_lower"),
                factor("_upper"),
            )));
        }
        grid.rows.push(cells);
    }
    grid
}
