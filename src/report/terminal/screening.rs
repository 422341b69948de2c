//! How often each controller fails in each stratum, and what hurts it most.

use crate::campaign::Campaign;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::results::{FailureRate, RateMethod};
use crate::run::Findings;

/// The strata of a run; nothing of a campaign without.
pub(super) fn strata(campaign: &Campaign, findings: &Findings) -> [Section; 2] {
    let head = ["stratum", "n"].into_iter().map(String::from);
    let mut grid = Grid {
        head: head.chain(campaign.controllers.iter().cloned()).collect(),
        rows: Vec::new(),
    };
    for stratum in campaign.strata.all() {
        let of_stratum: Vec<&FailureRate> = campaign
            .controllers
            .iter()
            .filter_map(|name| {
                let rates = findings.results.failures.iter();
                let of_all = rates.filter(|rate| rate.agents.is_none());
                let mut own = of_all.filter(|rate| rate.stratum == stratum.name);
                own.find(|rate| rate.controller == *name)
            })
            .collect();
        let n = of_stratum.first().map_or(0, |rate| rate.n);
        let mut cells = vec![Cell::text(&*stratum.name), Cell::number(n.to_string())];
        cells.extend(
            of_stratum
                .into_iter()
                .map(|rate| Cell::text(rate_text(rate))),
        );
        grid.rows.push(cells);
    }
    let kind = RateMethod::of(campaign).short();
    let title = format!("failure rates by stratum [{kind}]");
    let sentences = findings.results.harm.iter().map(Block::text).collect();
    [
        Section::new(title, vec![Block::Grid(grid)]),
        Section::explained("which stratum hurts most", ", change [95 %]", sentences),
    ]
}

fn rate_text(rate: &FailureRate) -> String {
    let interval = rate.interval.map_or(String::new(), |interval| {
        format!(
            " [{:.1}, {:.1}]",
            100.0 * interval.lower,
            100.0 * interval.upper
        )
    });
    match rate.n {
        0 => "-".to_string(),
        _ => format!("{:.1}%{interval}", 100.0 * rate.rate()),
    }
}
