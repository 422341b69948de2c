//! Who failed how often, and when.

use crate::campaign::{ALL, Campaign};
use crate::report::notes::caveats;
use crate::report::page::document::{Block, Cell, Figure, Grid, Scale, Section, Spread};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::{RunData, whole};
use crate::results::RateMethod;
use crate::util::format::{self, sentence};

/// Failure rates with intervals, requirements, and the share of episodes still good over time.
pub(crate) fn section(evidence: &RunData) -> Section {
    let mut blocks = vec![Block::Text(meaning(evidence))];
    let caveats = caveats(&evidence.campaign, &evidence.manifest);
    blocks.extend(caveats.iter().map(|caveat| Block::Text(sentence(caveat))));
    blocks.push(Block::Grid(rates(evidence)));
    if !evidence.manifest.requirements.is_empty() {
        blocks.push(Block::Grid(requirements(evidence)));
    }
    blocks.push(Block::Figure(survival(evidence)));
    Section::new("Failures", blocks)
}

fn meaning(evidence: &RunData) -> String {
    let verdict = &evidence.campaign.verdict;
    let agents = match evidence.campaign.team {
        1 => format!("its {}", evidence.campaign.agent.noun(1)),
        _ => format!("any of its {}", evidence.campaign.agent.plural()),
    };
    let limits = evidence.campaign.channel_groups().into_iter().map(|group| {
        let of_group = |limits: &[f64]| {
            let own = limits.get(group.channels.clone()).unwrap_or_default();
            let (low, high) = (
                own.iter().copied().fold(f64::INFINITY, f64::min),
                own.iter().copied().fold(0.0, f64::max),
            );
            match () {
                () if low.is_infinite() => "without limit".to_string(),
                () if low < high => {
                    format!("up to {} .. {}", low, high)
                }
                () => format!("up to {high}"),
            }
        };
        format!(
            "{}, {}: |e| {}, RMS error {}",
            group.role.name(),
            group.role.unit(),
            of_group(&verdict.max_error),
            of_group(&verdict.max_rmse)
        )
    });
    format!(
        "An episode fails if {agents} diverges, or leaves its limits from {} s on ({}). Intervals: {}.",
        f64::from(evidence.campaign.time.settle_step) * evidence.campaign.time.step_s,
        limits.collect::<Vec<_>>().join("; "),
        intervals(&evidence.campaign),
    )
}

/// What the intervals of failure rates are, in full.
pub(crate) fn intervals(campaign: &Campaign) -> &'static str {
    match RateMethod::of(campaign) {
        RateMethod::Replicates => "Student's t over the replicates, 95 %",
        RateMethod::Sequential => "confidence sequences, 95 % whenever one looks",
        RateMethod::Wilson => "Wilson, 95 %; the bound is Clopper-Pearson's",
    }
}

/// The failure rate of a row of the summary.
pub(crate) fn rate(evidence: &RunData, row: usize, ink: Color) -> Spread {
    let sheet = &evidence.summary;
    let method = RateMethod::of(&evidence.campaign).name();
    let end = |side: &str| sheet.real(row, &format!("failure_rate_{method}_{side}"));
    let ends = [end("lower"), end("upper")];
    let interval = ends.iter().all(|end| end.is_finite()).then_some(ends);
    Spread {
        scale: Scale::Share,
        value: sheet.real(row, "failure_rate"),
        interval,
        ink,
    }
}

fn rates(evidence: &RunData) -> Grid {
    let sheet = &evidence.summary;
    let mut grid = Grid::new([
        "controller",
        "failure rate",
        "failed",
        "exceeded",
        "diverged",
        "95 % sure below",
    ]);
    for (index, name) in evidence.campaign.controllers.iter().enumerate() {
        let wanted = [("controller", &**name), ("stratum", ALL)];
        let Some(row) = sheet.find(&wanted).next() else {
            continue;
        };
        let count = |column: &str| Cell::number(format!("{:.0}", sheet.real(row, column)));
        let bound = sheet.real(row, "failure_rate_upper_95");
        grid.rows.push(vec![
            Cell::text(&**name),
            Cell::Spreads(vec![rate(evidence, row, Color::Series(index))]),
            Cell::number(format!(
                "{:.0} of {:.0}",
                sheet.real(row, "failed"),
                sheet.real(row, "n")
            )),
            count("exceeded"),
            count("diverged"),
            Cell::number(format::at_most(bound)),
        ]);
    }
    grid
}

fn requirements(evidence: &RunData) -> Grid {
    let mut grid = Grid::new([
        "requirement",
        "stratum",
        "asked: 95 % sure below",
        "found",
        "failed",
    ]);
    for result in &evidence.manifest.requirements {
        let met = result.is_met();
        grid.rows.push(vec![
            Cell::Verdict(
                met,
                format!(
                    "{} {}",
                    result.controller,
                    if met { "holds" } else { "does not hold" }
                ),
            ),
            Cell::text(result.stratum.clone()),
            Cell::number(format::rate(result.limit, None)),
            Cell::number(format::at_most(result.upper_95)),
            Cell::number(format!("{} of {}", result.failed, result.n)),
        ]);
    }
    grid
}

/// The share of episodes that have not failed yet, over time.
fn survival(evidence: &RunData) -> Figure {
    let campaign = &evidence.campaign;
    let episodes = evidence.manifest.episodes as usize;
    let end_s = f64::from(campaign.time.steps) * campaign.time.step_s;
    let mut failed_at = vec![vec![f64::INFINITY; episodes]; campaign.controllers.len()];
    let sheet = &evidence.episodes;
    for row in 0..sheet.rows() {
        let controller = evidence.controller(sheet.text(row, "controller"));
        let place = controller.and_then(|index| {
            failed_at
                .get_mut(index)?
                .get_mut(whole(sheet.real(row, "episode")))
        });
        let Some(first) = place else { continue };
        let time_s = sheet.real(row, "failed_at_s");
        if time_s.is_finite() {
            *first = first.min(time_s);
        } else if sheet.text(row, "status") != "ok" {
            // The RMS error is judged at the end.
            *first = first.min(end_s);
        }
    }
    let marks = failed_at.iter().enumerate().map(|(index, times)| {
        let mut times: Vec<f64> = times.iter().copied().filter(|t| t.is_finite()).collect();
        times.sort_by(f64::total_cmp);
        let mut line = vec![(0.0, 1.0)];
        let all = episodes.max(1) as f64;
        for (place, &time_s) in times.iter().enumerate() {
            // Of those that fail at once, the last tells how many are left.
            if times.get(place + 1) != Some(&time_s) {
                line.push((time_s, 1.0 - (place + 1) as f64 / all));
            }
        }
        let last = line.last().map_or(1.0, |point| point.1);
        line.push((end_s, last));
        Mark::Line(line, Color::Series(index), Stroke::Steps)
    });
    Figure {
        panels: vec![Plot {
            title: "survival".into(),
            x: Axis {
                range: Some((0.0, end_s)),
                ..Axis::new("time, s")
            },
            y: Axis {
                // A little room below, so that the labels of both axes do not meet in the corner.
                range: Some((-0.03, 1.03)),
                ..Axis::new("share not failed yet")
            },
            marks: marks.collect(),
            ..Plot::default()
        }],
        legend: evidence.legend(),
        caption: "Share of the episodes that have not failed yet. What breaks the limit of the RMS error alone counts as failed \
                  at the end."
            .into(),
    }
}
