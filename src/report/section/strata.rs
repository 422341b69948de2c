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
    let head = vec![
        "stratum".into(),
        format!("failure rate: {}", names.join(", ")),
        "episodes".into(),
    ];
    let mut all: Vec<(Harm, Vec<Cell>)> = Vec::new();
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
        let failures = rates.iter().map(|own| own.value).fold(0.0, f64::max);
        let cells = vec![
            Cell::text(&*stratum.name),
            Cell::Spreads(rates),
            Cell::number(format!("{n:.0}")),
        ];
        all.push((harm(data, &stratum.name, failures), cells));
    }
    all.sort_by(|(a, _), (b, _)| b.order(a));
    let (harmful, harmless): (Vec<_>, Vec<_>) = all.into_iter().partition(|(own, _)| own.is_any());
    let grid = |rows: Vec<(Harm, Vec<Cell>)>| {
        Block::Grid(Grid {
            head: head.clone(),
            rows: rows.into_iter().map(|(_, cells)| cells).collect(),
        })
    };
    let sentences = data.manifest.harm.iter();
    let mut blocks: Vec<Block> = sentences
        .map(|own| Block::Text(format!("{own}.")))
        .collect();
    blocks.push(Block::text(
        "The most harmful first. Points are failure rates, bars their 95 % intervals, from 0 to 100 %; the controllers in this \
         order, top to bottom, in the colours of the figures.",
    ));
    if !harmful.is_empty() {
        blocks.push(grid(harmful));
    }
    if !harmless.is_empty() {
        let title = format!(
            "{} without a failure or a sure growth of the errors that counts",
            match harmless.len() {
                1 => "One stratum".to_string(),
                many => format!("{many} strata"),
            }
        );
        blocks.push(Block::Folded(title, vec![grid(harmless)]));
    }
    if data.screening.rows() > 0 {
        blocks.push(Block::Folded(
            "Growth of the errors".into(),
            vec![Block::Grid(growth(data))],
        ));
    }
    Some(Section::new("By stratum", blocks))
}

/// What a stratum does to the controller that it harms most.
#[derive(Debug, Clone, Copy)]
struct Harm {
    /// Its failure rate.
    failures: f64,
    /// The logarithm by which the errors surely grow; 0 if none does by as much as counts.
    growth: f64,
}

impl Harm {
    fn is_any(&self) -> bool {
        self.failures > 0.0 || self.growth > 0.0
    }

    fn order(&self, other: &Self) -> std::cmp::Ordering {
        let by_failures = self.failures.total_cmp(&other.failures);
        by_failures.then(self.growth.total_cmp(&other.growth))
    }
}

fn harm(data: &RunData, stratum: &str, failures: f64) -> Harm {
    let table = &data.screening;
    let mut growth: f64 = 0.0;
    for row in table.find(&[("stratum", stratum)]) {
        for of in data.campaign.channel_groups() {
            let smallest = data.campaign.groups()[of.group].verdict.smallest_ratio.ln();
            let surely = table.real(
                row,
                &format!("log_growth_{}_lower", of.name.replace(' ', "_")),
            );
            if surely > smallest {
                growth = growth.max(surely);
            }
        }
    }
    Harm { failures, growth }
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
