//! Which conditions matter, what was drawn, and the worst episodes.

use crate::campaign::AgentGroup;
use crate::draw::quantities::{Source, title};
use crate::report::drawn_values::{DrawnValues, drawn_values};
use crate::report::page::document::{Block, Cell, Figure, Grid, Scale, Section, Spread};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::{RunData, whole};
use crate::results::curves::BAND;
use crate::run::replay::command;
use crate::run::table_reader::TableReader;
use crate::statistics::SIGNIFICANCE;
use crate::util::format;
use std::collections::BTreeMap;

/// Conditions of each target that are listed.
const MOST: usize = 6;
/// Worst episodes of each controller that are shown at once.
const WORST: f64 = 3.0;
/// Controllers of which more than these are listed: worst.csv has all.
const MOST_LISTED: usize = 12;
/// Episodes whose draws are made again, at most.
const MOST_DRAWN: u32 = 4096;

/// What each drawn quantity does to failures and errors.
pub(crate) fn ranking(data: &RunData) -> Section {
    let table = &data.ranking;
    if table.rows() == 0 {
        let text = match data.manifest.episodes {
            1 => "A ranking needs at least two episodes.",
            _ => "Nothing is ranked: no condition varies by chance alone.",
        };
        return Section::new("Which conditions matter", vec![Block::text(text)]);
    }
    // Of a design whose episodes are not independent the strongest are shown as they are.
    let tested = (0..table.rows()).any(|row| table.real(row, "p_holm").is_finite());
    let mut grid = Grid::new([
        "what",
        "condition",
        "rank correlation [95 %]",
        "p after Holm",
        "episodes",
    ]);
    let mut of_ratios = grid.clone();
    let mut listed: BTreeMap<String, usize> = BTreeMap::new();
    for row in 0..table.rows() {
        let text = |name: &str| table.text(row, name);
        let what = target(table, row);
        let p = table.real(row, "p_holm");
        // Tables are sorted by strength; of those that chance explains as well, nothing is told.
        if tested && (p.is_nan() || p > SIGNIFICANCE) {
            continue;
        }
        let before = listed.entry(what.clone()).or_default();
        *before += 1;
        if *before > MOST {
            continue;
        }
        let ends = [
            table.real(row, "trend_lower"),
            table.real(row, "trend_upper"),
        ];
        let controller = data.controller(text("controller"));
        let own = if text("against").is_empty() {
            &mut grid
        } else {
            &mut of_ratios
        };
        own.rows.push(vec![
            Cell::text(what),
            Cell::text(title(&data.campaign, text("condition"))),
            Cell::Spreads(vec![Spread {
                value: table.real(row, "trend"),
                interval: ends.iter().all(|end| end.is_finite()).then_some(ends),
                color: Color::Series(controller.unwrap_or_default()),
                scale: Scale::Correlation,
            }]),
            Cell::number(format::p_value(p)),
            Cell::number(format!("{:.0}", table.real(row, "episodes"))),
        ]);
    }
    let mut blocks = explained(data, tested, grid);
    if !of_ratios.rows.is_empty() {
        blocks.push(Block::Folded(
            "What moves the comparisons".into(),
            vec![
                Block::text(
                    "Above 0: the larger the quantity, the more the first of the pair gains.",
                ),
                Block::Grid(of_ratios),
            ],
        ));
    }
    blocks.extend(bands(data).map(Block::Figure));
    Section::new("Which conditions matter", blocks)
}

/// What a row of the ranking is about.
fn target(table: &TableReader, row: usize) -> String {
    let text = |name: &str| table.text(row, name);
    match text("target") {
        "failure" => format!("failures of {}", text("controller")),
        "rmse" => format!("RMS error of {}, {}", text("controller"), text("group")),
        _ => format!(
            "log-ratio of {} to {}, {}",
            text("controller"),
            text("against"),
            text("group")
        ),
    }
}

/// The effects on failures and errors, and what is to be known of them.
fn explained(data: &RunData, tested: bool, grid: Grid) -> Vec<Block> {
    let mut blocks = Vec::new();
    if grid.rows.is_empty() {
        let strata = match data.campaign.strata.all() {
            [] => "",
            _ => " What the faults of the strata do is shown above, stratum by stratum.",
        };
        blocks.push(Block::Text(format!(
            "No drawn quantity has a significant effect on failures or errors (5 %, Holm-corrected); ranking.csv has \
             all.{strata}"
        )));
    } else {
        let which = match tested {
            true => "whose effect is sure at 5 % after Holm's correction",
            false => {
                "of those that vary, untested, since the episodes of this design are not independent of each other"
            }
        };
        blocks.push(Block::Text(format!(
            "Of each, the strongest {MOST} {which}; ranking.csv has all. A quantity that is drawn for each agent and channel \
             counts by its root mean square over the team, an onset by the first."
        )));
        blocks.push(Block::Grid(grid));
    }
    blocks
}

/// Quantile bands of the RMS error over the condition that moves it most.
fn bands(data: &RunData) -> Option<Figure> {
    let table = &data.curves;
    let curves = data.rows_of_curve(BAND, None);
    let first = *curves.iter().flatten().next()?;
    let [condition, group] = ["condition", "group"].map(|name| table.text(first, name));
    let groups = data.campaign.channel_groups();
    let of = groups.iter().find(|own| *own.name == *group)?;
    let marks = curves.iter().enumerate().flat_map(|(index, rows)| {
        let point = |row: &usize, name: &str| table.real(*row, name);
        let between = |row: &usize| (point(row, "y_lower"), point(row, "y_upper"));
        let band = rows.iter().map(|row| {
            let (lower, upper) = between(row);
            (point(row, "x"), lower, upper)
        });
        let line = rows.iter().map(|row| (point(row, "x"), point(row, "y")));
        [
            Mark::Band(band.collect(), Color::Series(index)),
            Mark::Line(line.collect(), Color::Series(index), Stroke::Solid),
        ]
    });
    let name = title(&data.campaign, condition);
    Some(Figure {
        panels: vec![Plot {
            title: group.to_string(),
            x: Axis::new(name.clone()),
            y: Axis {
                logarithmic: true,
                ..Axis::new(format!("RMS error, {}", of.role.unit()))
            },
            marks: marks.collect(),
            ..Plot::default()
        }],
        legend: data.legend(),
        caption: format!(
            "RMS error over {name}: median and the band from the 5th to the 95th percentile, of groups of equally many \
             episodes or, where it has few values, at each of them. A band is left out where its end diverges."
        ),
    })
}

/// The ranges that were really drawn: drawn again.
pub(crate) fn drawn(data: &RunData) -> Section {
    let mut grid = Grid::new([
        "condition",
        "values",
        "lowest",
        "5th percentile",
        "median",
        "95th percentile",
        "highest",
    ]);
    let all = data.manifest.episodes;
    let stride = all.div_ceil(MOST_DRAWN).max(1);
    let episodes = (0..all).step_by(stride as usize);
    let which = match stride {
        1 => "all episodes".to_string(),
        _ => format!("every {stride}th episode"),
    };
    for group in data.campaign.groups() {
        let mut fault = None;
        for drawn in drawn_values(group, episodes.clone()) {
            if let (Source::Fault(index), Some(occurs)) = (drawn.quantity.source, drawn.occurs)
                && fault != Some(index)
            {
                fault = Some(index);
                grid.rows.push(share(data, group, index, occurs));
            }
            grid.rows.extend(range(data, group, drawn));
        }
    }
    Section::new(
        "Conditions really drawn",
        vec![
            Block::text(format!(
                "As applied, over {which}, agents and the channels on which they act."
            )),
            Block::Folded(
                format!("{} quantities", grid.rows.len()),
                vec![Block::Grid(grid)],
            ),
        ],
    )
}

/// How many agents have a fault of their group.
fn share(data: &RunData, group: &AgentGroup, index: usize, [having, all]: [usize; 2]) -> Vec<Cell> {
    let key = format!("fault{}_occurs", group.first_fault + index);
    let name = title(&data.campaign, &key);
    let name = name.strip_suffix(" occurs").unwrap_or(&name);
    let mut row = vec![
        Cell::text(format!("{name}: share of agents that have it")),
        Cell::number(all.to_string()),
        Cell::number(format::rate(having as f64 / all.max(1) as f64, None)),
    ];
    row.resize(7, Cell::number(""));
    row
}

/// The range of a quantity of a group of agents; none where nobody has it.
fn range(data: &RunData, group: &AgentGroup, drawn: DrawnValues) -> Option<Vec<Cell>> {
    let mut values = drawn.values;
    // What stays to the end lasts for ever.
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    if values.is_empty() {
        return None;
    }
    let key = &drawn.quantity.key;
    let name = match title(&data.campaign, key) {
        // What is numbered through all groups has the name of its group already.
        plain if plain == *key => group.titled(key),
        titled => titled,
    };
    let at = |q: f64| {
        let place = whole((q * (values.len() - 1) as f64).round());
        Cell::number(format::number(values[place.min(values.len() - 1)]))
    };
    Some(vec![
        Cell::text(name),
        Cell::number(values.len().to_string()),
        at(0.0),
        at(0.05),
        at(0.5),
        at(0.95),
        at(1.0),
    ])
}

/// The worst episodes of each controller, and how to see them.
pub(crate) fn worst(data: &RunData) -> Section {
    let table = &data.worst;
    let mut grid = Grid::new([
        "controller",
        "rank",
        "episode",
        "ended",
        "failed at, s",
        "largest error over its limit",
        "where",
        "faults",
        "replay",
    ]);
    let mut rest = grid.clone();
    for row in 0..table.rows() {
        let controller = table.text(row, "controller");
        let episode = table.real(row, "episode");
        let excess = table.real(row, "largest_error_over_limit");
        let rank = table.real(row, "rank");
        let place = data.controller(controller);
        if rank > WORST && place.is_some_and(|place| place >= MOST_LISTED) {
            continue;
        }
        let own = if rank <= WORST { &mut grid } else { &mut rest };
        own.rows.push(vec![
            Cell::text(controller),
            Cell::number(format!("{rank:.0}")),
            Cell::number(format!("{episode:.0}")),
            Cell::text(table.text(row, "status")),
            Cell::number(format::number(table.real(row, "failed_at_s"))),
            Cell::number(format::number(excess)),
            Cell::text(format!(
                "{} of agent {:.0}",
                table.text(row, "channel"),
                table.real(row, "agent")
            )),
            Cell::text(match table.text(row, "faults") {
                "" => "none",
                faults => faults,
            }),
            Cell::Code(command(
                &data.dir,
                u32::try_from(whole(episode)).unwrap_or(u32::MAX),
                controller,
            )),
        ]);
    }
    let mut blocks = vec![Block::Grid(grid)];
    if !rest.rows.is_empty() {
        blocks.push(Block::Folded(
            "The rest of the ten worst".into(),
            vec![Block::Grid(rest)],
        ));
    }
    Section::new("Worst episodes", blocks)
}
