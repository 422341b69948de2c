//! What a run found, for people.

use super::amount::Amount;
use super::attenuation;
use super::conclusion::{in_short, requirements, terms};
use super::pairs::pairs;
use super::screening::strata;
use crate::campaign::{ALL, Campaign};
use crate::draw::quantities::title;
use crate::report::notes::caveats;
use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
use crate::report::times::times;
use crate::results::sensitivity::{SensitivityResult, WorstEpisode};
use crate::results::{FailureRate, RateMethod};
use crate::run::Findings;
use crate::run::manifest::Manifest;
use crate::run::replay::command;
use crate::simulation::cross_check::CrossCheck;
use crate::statistics::SIGNIFICANCE;
use crate::util::format::{digits, rounded_up};
use std::path::Path;

/// Conditions that are shown of each target.
const STRONGEST: usize = 3;

/// The findings of a run; what they come to stands at the end, where a terminal shows it.
pub fn findings(campaign: &Campaign, findings: &Findings, out: &Path, amount: Amount) -> String {
    let manifest = &findings.manifest;
    let [by_stratum, harm] = strata(campaign, findings);
    let sections = match amount {
        Amount::Screen => vec![
            failure_rates(campaign, findings),
            rms_errors(campaign, findings),
            terms(findings, amount),
            harm,
        ],
        Amount::Everything => vec![
            failure_rates(campaign, findings),
            by_stratum,
            harm,
            rms_errors(campaign, findings),
            pairs(campaign, findings),
            what_matters(campaign, findings),
            worst(findings, out),
            terms(findings, amount),
        ],
    };
    let conclusion = [
        written(manifest, out, amount),
        requirements(&manifest.requirements),
        in_short(campaign, findings),
    ];
    text(&Document {
        title: campaign.name.clone(),
        subtitle: simulated(campaign, manifest),
        lead: beside(campaign, manifest),
        sections: sections.into_iter().chain(conclusion).collect(),
        ..Document::default()
    })
}

/// What was simulated on what.
fn simulated(campaign: &Campaign, manifest: &Manifest) -> String {
    let precision = format!("{:?}", manifest.precision).to_lowercase();
    let engines = manifest
        .segments
        .iter()
        .map(|segment| segment.engine.to_string());
    format!(
        "{} x {}, seed {}, {precision} on {}, {:.1} s of simulation",
        counted(manifest.episodes),
        campaign.agents_in_words(),
        campaign.seed,
        engines.collect::<Vec<_>>().join(", then on "),
        manifest.times.loop_s
    )
}

/// What there is to know beside: notes and the cross-check.
fn beside(campaign: &Campaign, manifest: &Manifest) -> Vec<String> {
    let notes = manifest.notes.iter().map(|note| format!("note: {note}"));
    let mut sentences: Vec<String> = notes.collect();
    if let Some(check) = &manifest.cross_check {
        sentences.push(cross_check(check, campaign.controllers.len()));
        sentences.extend(attenuation::groups(&check.attenuation));
    }
    sentences
}

/// How often each controller failed.
fn failure_rates(campaign: &Campaign, findings: &Findings) -> Section {
    let interval = RateMethod::of(campaign).short();
    let mut grid = Grid::new([
        "controller",
        "failed",
        "rate",
        interval,
        "95 % sure below",
        "",
    ]);
    let of_all = |rate: &&FailureRate| *rate.stratum == *ALL;
    for failures in findings.results.failures.iter().filter(of_all) {
        let name = match &failures.agents {
            None => failures.controller.clone(),
            Some(group) => format!("  {group}"),
        };
        let interval = failures.interval.map_or("-".to_string(), |interval| {
            format!(
                "{:.2} .. {:.2}%",
                100.0 * interval.lower,
                100.0 * interval.upper
            )
        });
        let bound = failures.upper_95.map_or("-".to_string(), |upper| {
            format!("{}%", rounded_up(100.0 * upper, 2))
        });
        let diverged = match failures.diverged {
            0 => String::new(),
            diverged => format!("({diverged} diverged)"),
        };
        grid.rows.push(vec![
            Cell::text(name),
            Cell::Number(format!("{} of {}", failures.failed(), failures.n)),
            Cell::Number(format!("{:.2}%", 100.0 * failures.rate())),
            Cell::Text(interval),
            Cell::Text(bound),
            Cell::Text(diverged),
        ]);
    }
    let note = match campaign.agents() {
        1 => String::new(),
        _ => format!(" (an episode fails with any of its {})", campaign.plural()),
    };
    let caveats = caveats(campaign, &findings.manifest).into_iter();
    let blocks = std::iter::once(Block::Grid(grid)).chain(caveats.map(Block::Text));
    Section::explained("failures", note, blocks.collect())
}

/// How large the errors of each controller were.
fn rms_errors(campaign: &Campaign, findings: &Findings) -> Section {
    let channels = campaign.channel_groups();
    let titles = channels
        .iter()
        .map(|of| format!("{}, {}", of.name, of.role.unit()));
    let mut grid = Grid {
        head: std::iter::once("controller".to_string())
            .chain(titles)
            .collect(),
        rows: Vec::new(),
    };
    for name in &campaign.controllers {
        let cell = |group: &str| {
            let row = findings.results.summary.iter().find(|row| {
                row.failures.controller == *name
                    && *row.failures.stratum == *ALL
                    && row.metric == "rmse"
                    && *row.group == *group
            });
            row.map_or(String::new(), |row| {
                let number = |value: f64| digits(value, 3);
                let value = |k: usize| row.quantiles[k].value.map_or("-".to_string(), number);
                let interval = row.quantiles[0].interval.map_or(String::new(), |i| {
                    format!(" [{}, {}]", number(i.lower), number(i.upper))
                });
                format!("{}{interval}, {}", value(0), value(1))
            })
        };
        let cells = channels.iter().map(|of| Cell::Number(cell(&of.name)));
        grid.rows
            .push(std::iter::once(Cell::text(name)).chain(cells).collect());
    }
    Section::explained(
        "RMS error from settle_s on",
        ", median [95 % interval] and 95th percentile over the episodes",
        vec![Block::Grid(grid)],
    )
}

/// Where the files are, and how long it all took.
fn written(manifest: &Manifest, out: &Path, amount: Amount) -> Section {
    let out = out.display();
    let text = match amount {
        Amount::Screen => {
            format!("written to {out}: report.html has the whole, --verbose prints more of it")
        }
        Amount::Everything => format!("written to {out} ({})", times(manifest)),
    };
    Section::new("", vec![Block::Text(text)])
}

/// So many episodes.
fn counted(episodes: u32) -> String {
    match episodes {
        1 => "1 episode".to_string(),
        many => format!("{many} episodes"),
    }
}

fn cross_check(check: &CrossCheck, controllers: usize) -> String {
    let pairs = check.episodes.len() * controllers;
    let differences = if check.compared == 0 {
        format!("no errors compared (all {pairs} episodes fail or saturate)")
    } else {
        format!(
            "|e| within {:.1e}, RMS error within {:.1e} relative ({} of {pairs} episodes neither fail nor saturate)",
            check.largest_error_difference, check.largest_rmse_difference, check.compared,
        )
    };
    let sensitive = match check.sensitive {
        0 => String::new(),
        count => format!("; {count} left out: {}", CrossCheck::SENSITIVE),
    };
    format!(
        "cross-check of {} episodes with f64 on the CPU: {differences}, {} of {pairs} verdicts differ{sensitive}",
        check.episodes.len(),
        check.verdicts_differ,
    )
}

/// What raises failures and errors of each controller, as far as it is sure.
fn what_matters(campaign: &Campaign, findings: &Findings) -> Section {
    let sure: Vec<&SensitivityResult> = findings
        .results
        .ranking
        .iter()
        .filter(|ranked| ranked.target.kind != "log_ratio")
        .filter(|ranked| ranked.p_holm.is_some_and(|p_holm| p_holm <= SIGNIFICANCE))
        .collect();
    let mut grid = Grid::default();
    for same in sure.chunk_by(|a, b| a.target == b.target) {
        let target = &same[0].target;
        let about = target.group.as_deref().unwrap_or("failures");
        let strongest = same.iter().take(STRONGEST).map(|ranked| {
            let interval = ranked.trend.interval.map_or(String::new(), |interval| {
                format!(" [{:+.2}, {:+.2}]", interval.lower, interval.upper)
            });
            let condition = title(campaign, &ranked.condition);
            format!("{condition} {:+.2}{interval}", ranked.trend.value)
        });
        grid.rows.push(vec![
            Cell::text(&target.controller),
            Cell::text(about),
            Cell::text(strongest.collect::<Vec<_>>().join(", ")),
        ]);
    }
    Section::explained(
        "what matters",
        ": rank correlation [95 %] with failures and with the RMS error, the strongest of those that are sure at 5 %",
        vec![Block::Grid(grid)],
    )
}

/// The worst episode of each controller, and how to see it.
fn worst(findings: &Findings, out: &Path) -> Section {
    let cells = |worst: &WorstEpisode| {
        let largest = match worst.excess.is_finite() {
            true => format!(
                ", |e| up to {:.2} of the limit on {} of agent {}",
                worst.excess, worst.channel, worst.agent
            ),
            false => String::new(),
        };
        let command = command(out, worst.episode, &worst.controller);
        vec![
            Cell::text(&worst.controller),
            Cell::Text(format!("{}{largest}: {command}", worst.status.word())),
        ]
    };
    let worst = findings.results.worst.iter();
    let grid = Grid {
        head: Vec::new(),
        rows: worst.filter(|worst| worst.rank == 1).map(cells).collect(),
    };
    Section::explained(
        "worst episode of each controller",
        " (worst.csv has ten)",
        vec![Block::Grid(grid)],
    )
}
