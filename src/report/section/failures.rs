//! Who failed how often, and when.

use crate::campaign::{ALL, Campaign};
use crate::report::notes::caveats;
use crate::report::page::document::{Block, Cell, Figure, Grid, Scale, Section, Spread};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::requirements::bound;
use crate::report::run_data::{RunData, whole};
use crate::results::RateMethod;
use crate::util::format::{self, sentence};

/// Failure rates with intervals, requirements, and the share of episodes still good over time.
pub(crate) fn section(data: &RunData) -> Section {
    let mut blocks = vec![Block::Text(meaning(data))];
    let caveats = caveats(&data.campaign, &data.manifest);
    blocks.extend(caveats.iter().map(|caveat| Block::Text(sentence(caveat))));
    blocks.push(Block::Grid(rates(data)));
    if !data.manifest.requirements.is_empty() {
        blocks.push(Block::Grid(requirements(data)));
    }
    blocks.push(Block::Figure(survival(data)));
    Section::new("Failures", blocks)
}

fn meaning(data: &RunData) -> String {
    let campaign = &data.campaign;
    let agents = match campaign.agents() {
        1 => format!("its {}", campaign.first_group().agent.noun(1)),
        _ => format!("any of its {}", campaign.plural()),
    };
    let limits = campaign.channel_groups().into_iter().map(|group| {
        let verdict = &campaign.groups()[group.group].verdict;
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
            group.name,
            group.role.unit(),
            of_group(&verdict.max_error),
            of_group(&verdict.max_rmse)
        )
    });
    format!(
        "An episode fails if {agents} diverges, or leaves its limits from {} s on ({}). Intervals: {}.",
        f64::from(data.campaign.time.settle_step) * data.campaign.time.step_s,
        limits.collect::<Vec<_>>().join("; "),
        intervals(&data.campaign),
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
pub(crate) fn rate(data: &RunData, row: usize, color: Color) -> Spread {
    spread(data, row, "", color)
}

/// The same of columns with a prefix.
fn spread(data: &RunData, row: usize, prefix: &str, color: Color) -> Spread {
    let table = &data.summary;
    let method = RateMethod::of(&data.campaign).name();
    let end = |side: &str| table.real(row, &format!("{prefix}failure_rate_{method}_{side}"));
    let ends = [end("lower"), end("upper")];
    let interval = ends.iter().all(|end| end.is_finite()).then_some(ends);
    Spread {
        scale: Scale::Share,
        value: table.real(row, &format!("{prefix}failure_rate")),
        interval,
        color,
    }
}

fn rates(data: &RunData) -> Grid {
    let table = &data.summary;
    let mut grid = Grid::new([
        "controller",
        "failure rate",
        "failed",
        "exceeded",
        "diverged",
        "95 % sure below",
    ]);
    let counted = |row: usize, prefix: &str, name: &str, index: usize| {
        let of = |column: &str| table.real(row, &format!("{prefix}{column}"));
        let count = |column: &str| Cell::number(format!("{:.0}", of(column)));
        vec![
            Cell::text(name),
            Cell::Spreads(vec![spread(data, row, prefix, Color::Series(index))]),
            Cell::number(format!(
                "{:.0} of {:.0}",
                of("failed"),
                table.real(row, "n")
            )),
            count("exceeded"),
            count("diverged"),
            Cell::number(format::at_most(of("failure_rate_upper_95"))),
        ]
    };
    let channels = data.campaign.channel_groups();
    for (index, name) in data.campaign.controllers.iter().enumerate() {
        let wanted = [("controller", &**name), ("stratum", ALL)];
        let rows: Vec<usize> = table.find(&wanted).collect();
        let Some(&first) = rows.first() else {
            continue;
        };
        grid.rows.push(counted(first, "", name, index));
        if !data.campaign.has_named_groups() {
            continue;
        }
        for (place, group) in data.campaign.groups().iter().enumerate() {
            let own = channels.iter().find(|channels| channels.group == place);
            let of_group =
                |row: &&usize| own.is_some_and(|own| table.text(**row, "group") == &*own.name);
            if let Some(&row) = rows.iter().find(of_group) {
                let name = format!("{name}, {} alone", group.name);
                grid.rows.push(counted(row, "group_", &name, index));
            }
        }
    }
    grid
}

fn requirements(data: &RunData) -> Grid {
    let mut grid = Grid::new([
        "requirement",
        "stratum",
        "measure",
        "asked",
        "95 % sure",
        "found",
        "episodes",
    ]);
    for result in &data.manifest.requirements {
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
            Cell::text(&*result.quantity),
            Cell::number(format!("{} {}", result.side.words(), result.limit)),
            Cell::number(bound(result)),
            Cell::number(result.value.map_or("-".to_string(), format::number)),
            Cell::number(format!("{} ({} failed)", result.n, result.failed)),
        ]);
    }
    grid
}

/// The share of episodes that have not failed yet, over time.
fn survival(data: &RunData) -> Figure {
    let campaign = &data.campaign;
    let episodes = data.manifest.episodes as usize;
    let end_s = f64::from(campaign.time.steps) * campaign.time.step_s;
    let mut failed_at = vec![vec![f64::INFINITY; episodes]; campaign.controllers.len()];
    let table = &data.episodes;
    for row in 0..table.rows() {
        let controller = data.controller(table.text(row, "controller"));
        let place = controller.and_then(|index| {
            failed_at
                .get_mut(index)?
                .get_mut(whole(table.real(row, "episode")))
        });
        let Some(first) = place else { continue };
        let time_s = table.real(row, "failed_at_s");
        if time_s.is_finite() {
            *first = first.min(time_s);
        } else if table.text(row, "status") != "ok" {
            // The RMS error is judged at the end.
            *first = first.min(end_s);
        }
    }
    let most = failed_at.iter().map(|times| {
        let failed = times.iter().filter(|time_s| time_s.is_finite()).count();
        failed as f64 / episodes.max(1) as f64
    });
    let most = most.fold(0.0, f64::max);
    // A little room below, so that the labels of both axes do not meet in the corner; cut to what there is to see.
    let range = Some((1.0 - 1.1 * most.max(0.01), 1.0 + 0.03 * most.max(0.01)));
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
                range,
                ..Axis::new("share not failed yet")
            },
            marks: marks.collect(),
            ..Plot::default()
        }],
        legend: data.legend(),
        caption: "Share of the episodes that have not failed yet. What breaks the limit of the RMS error alone counts as failed \
                  at the end."
            .into(),
    }
}
