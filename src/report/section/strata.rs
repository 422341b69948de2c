//! What each stratum does to each controller.

use super::failures::rate;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::page::plot::Color;
use crate::report::run_data::RunData;
use crate::util::format;

/// The forest of failure rates and the growth of the errors; none of a campaign without strata.
pub(crate) fn section(data: &RunData) -> Option<Section> {
    let strata = data.campaign.strata.all();
    if strata.is_empty() {
        return None;
    }
    let names: Vec<String> = data
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
            if let Some(row) = data.summary.find(&wanted).next() {
                n = data.summary.real(row, "n");
                rates.push(rate(data, row, Color::Series(index)));
            }
        }
        forest.rows.push(vec![
            Cell::text(&*stratum.name),
            Cell::Spreads(rates),
            Cell::number(format!("{n:.0}")),
        ]);
    }
    let sentences = data.manifest.harm.iter();
    let mut blocks: Vec<Block> = sentences
        .map(|own| Block::Text(format!("{own}.")))
        .collect();
    blocks.push(Block::text(
        "Points are failure rates, bars their 95 % intervals, from 0 to 100 %; the controllers in this order, top to bottom, in \
         the colours of the figures.",
    ));
    blocks.push(Block::Grid(forest));
    if data.screening.rows() > 0 {
        blocks.push(Block::Folded(
            "Growth of the errors".into(),
            vec![Block::Grid(growth(data))],
        ));
    }
    Some(Section::new("By stratum", blocks))
}

fn growth(data: &RunData) -> Grid {
    let table = &data.screening;
    let roles = data.campaign.channel_groups();
    let mut grid = Grid::new(["controller", "stratum", "against"]);
    let groups = roles.iter().map(|group| &group.name);
    grid.head
        .extend(groups.map(|name| format!("median RMS error grows by a factor of [95 %], {name}")));
    for row in 0..table.rows() {
        let mut cells = vec![
            Cell::text(table.text(row, "controller")),
            Cell::text(table.text(row, "stratum")),
            Cell::text(table.text(row, "reference")),
        ];
        for group in &roles {
            let name = group.name.replace(' ', "_");
            let factor = |side: &str| table.real(row, &format!("log_growth_{name}{side}")).exp();
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
