//! Who failed how often, and when.

use crate::campaign::{ALL, Campaign};
use crate::report::notes::caveats;
use crate::report::page::document::{Block, Cell, Figure, Grid, Scale, Section, Spread};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::requirements::bound;
use crate::report::run_data::RunData;
use crate::results::RateMethod;
use crate::results::curves::SURVIVAL;
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
    // Without curves nobody would seem to have failed.
    if data.has_curves() {
        blocks.push(Block::Figure(survival(data)));
    }
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
    let end_s = f64::from(campaign.time.steps) * campaign.time.step_s;
    let mut lines = data.points(SURVIVAL, None);
    lines.iter_mut().for_each(|line| line.insert(0, (0.0, 1.0)));
    let left = |line: &Vec<(f64, f64)>| line.last().map_or(1.0, |point| point.1);
    let most = lines
        .iter()
        .map(|line| 1.0 - left(line))
        .fold(0.0, f64::max);
    // A little room below, so that the labels of both axes do not meet in the corner; cut to what there is to see.
    let range = Some((1.0 - 1.1 * most.max(0.01), 1.0 + 0.03 * most.max(0.01)));
    let marks = lines.into_iter().enumerate().map(|(index, mut line)| {
        line.push((end_s, left(&line)));
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
