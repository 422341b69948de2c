//! What each stratum does to each controller.

use super::document::{Block, Cell, Grid, Section};
use super::evidence::Evidence;
use super::outcome::rate;
use super::panel::Ink;
use crate::words;

/// The forest of failure rates and the growth of the errors; none of a campaign without strata.
pub(crate) fn section(evidence: &Evidence) -> Option<Section> {
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
                rates.push(rate(evidence, row, Ink::Series(index)));
            }
        }
        forest.rows.push(vec![
            Cell::text(&*stratum.name),
            Cell::Spreads(rates),
            Cell::number(format!("{n:.0}")),
        ]);
    }
    let mut blocks = hurting(evidence);
    blocks.push(Block::text(
        "Points are failure rates, bars their 95 % intervals, from 0 to 100 %; the controllers in this order, top to bottom, in \
         the colours of the figures.",
    ));
    blocks.push(Block::Grid(forest));
    if evidence.screening.rows() > 0 {
        blocks.push(Block::Folded(
            "Growth of the errors against the stratum without faults".into(),
            vec![Block::Grid(growth(evidence))],
        ));
    }
    Some(Section::new("By stratum", blocks))
}

/// A sentence for each controller: which strata may be its worst.
fn hurting(evidence: &Evidence) -> Vec<Block> {
    let sheet = &evidence.screening;
    let of_controller = |name: &str| {
        let mut worst: Vec<usize> = sheet
            .find(&[("controller", name)])
            .filter(|&row| sheet.real(row, "may_fail_most") > 0.5)
            .collect();
        let difference = |row: usize| sheet.real(row, "failure_rate_difference");
        worst.sort_by(|&a, &b| difference(b).total_cmp(&difference(a)));
        let first = *worst.first()?;
        if difference(first).is_nan() || difference(first) <= 0.0 {
            return Some(format!(
                "{name}: no stratum makes it fail more often than the one without faults."
            ));
        }
        let points =
            |side: &str| 100.0 * sheet.real(first, &format!("failure_rate_difference{side}"));
        let others: Vec<&str> = worst
            .iter()
            .skip(1)
            .map(|&row| sheet.text(row, "stratum"))
            .collect();
        let apart = match others.len() {
            0 => String::new(),
            1..=4 => format!("; not to be told apart from it: {}", others.join(", ")),
            many => format!("; {many} others cannot be told apart from it"),
        };
        Some(format!(
            "{name} fails most often with {}: {} points more than with {}{apart}.",
            sheet.text(first, "stratum"),
            words::measured(points(""), points("_lower"), points("_upper")),
            sheet.text(first, "reference"),
        ))
    };
    let names = evidence.campaign.controllers.iter();
    names
        .filter_map(|name| of_controller(name))
        .map(Block::Text)
        .collect()
}

fn growth(evidence: &Evidence) -> Grid {
    let sheet = &evidence.screening;
    let roles = evidence.campaign.channel_groups();
    let mut grid = Grid::new(["controller", "stratum"]);
    let groups = roles.iter().map(|group| group.role.name());
    grid.head
        .extend(groups.map(|name| format!("median RMS error grows by a factor of [95 %], {name}")));
    for row in 0..sheet.rows() {
        let mut cells = vec![
            Cell::text(sheet.text(row, "controller")),
            Cell::text(sheet.text(row, "stratum")),
        ];
        for group in &roles {
            let factor = |side: &str| {
                sheet
                    .real(row, &format!("log_growth_{}{side}", group.role.name()))
                    .exp()
            };
            cells.push(Cell::number(words::measured(
                factor(""),
                factor("_lower"),
                factor("_upper"),
            )));
        }
        grid.rows.push(cells);
    }
    grid
}
