//! What a run comes to: its verdict and its requirements.

use super::amount::Amount;
use crate::campaign::Campaign;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::requirements::found;
use crate::results::{RequirementResult, how_sure};
use crate::run::Findings;
use crate::synthesis::Margins;
use crate::util::format::digits;

/// Who does better, in a sentence each.
pub(super) fn in_short(campaign: &Campaign, findings: &Findings) -> Section {
    let sure = match findings.manifest.episodes {
        1 => String::new(),
        _ => format!(" ({})", how_sure(campaign)),
    };
    let sentences = findings.results.verdict.iter().map(Block::text);
    Section::explained("in short", sure, sentences.collect())
}

/// On what terms the controllers are compared.
pub(super) fn terms(findings: &Findings, amount: Amount) -> Section {
    let mut grid = Grid::new([
        "controller",
        "channels",
        "crossover, rad/s",
        "delay margin, ms",
        "peak of S",
        "noise, peak",
        "largest command, 95 %",
        "effort, median",
        "at a limit",
        "settled, s",
    ]);
    for own in &findings.results.terms {
        let number = |value: Option<f64>, precision| {
            Cell::Number(value.map_or("-".to_string(), |value| digits(value, precision)))
        };
        let margin = |pick: fn(&Margins) -> f64| own.margins.as_ref().map(pick);
        let share = own.saturated_share;
        let share = share.map_or("-".to_string(), |share| format!("{:.1} %", 100.0 * share));
        grid.rows.push(vec![
            Cell::text(&own.controller),
            Cell::text(&*own.group),
            number(margin(|own| own.crossover_rad_s), 3),
            number(margin(|own| own.delay_margin_ms), 3),
            number(margin(|own| own.sensitivity_peak), 3),
            number(margin(|own| own.noise_peak), 3),
            number(own.peak_command_p95, 3),
            number(own.effort_p50, 3),
            Cell::Number(share),
            number(own.settling_p50_s, 3),
        ]);
    }
    let unlike = findings.results.unlike.iter().map(Block::text);
    let unlike = unlike.filter(|_| amount == Amount::Everything);
    let blocks = unlike.chain([Block::Grid(grid)]).collect();
    Section::explained(
        "on what terms",
        ": bandwidth and margins of the loops, and what their commands cost",
        blocks,
    )
}

/// What became of each `[[require]]`, one a line.
pub(super) fn requirements(results: &[RequirementResult]) -> Section {
    let mut grid = Grid::default();
    for result in results {
        let met = result.is_met();
        grid.rows.push(vec![
            Cell::Verdict(met, if met { "met" } else { "UNMET" }.into()),
            Cell::text(format!("require[{}]", result.place)),
            Cell::text(result.subject()),
            Cell::text(found(result)),
        ]);
    }
    let note = match results.iter().all(RequirementResult::is_failure_rate) {
        true => ": the failure rate with 95 % confidence",
        false => ": what is proved with 95 % confidence",
    };
    Section::explained("requirements", note, vec![Block::Grid(grid)])
}
