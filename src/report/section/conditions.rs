//! Which conditions matter, what was drawn, and the worst episodes.

use crate::campaign::AgentGroup;
use crate::draw::draw;
use crate::draw::quantities::{conditions, title};
use crate::report::page::document::{Block, Cell, Figure, Grid, Scale, Section, Spread};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::{RunData, whole};
use crate::results::sensitivity::by_chance;
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
/// Groups of episodes, from the lowest to the highest value of a condition.
const BINS: usize = 10;

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
    let mut strongest: Option<(String, String)> = None;
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
        if strongest.is_none() && text("target") == "rmse" {
            strongest = Some((text("condition").into(), text("group").into()));
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
    if let Some((condition, group)) = strongest {
        blocks.extend(bands(data, &condition, &group).map(Block::Figure));
    }
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

/// Quantile bands of the RMS error over a condition.
fn bands(data: &RunData, condition: &str, group: &str) -> Option<Figure> {
    let met = sizes(data, condition);
    let roles = data.campaign.channel_groups();
    let of = roles.iter().find(|own| *own.name == *group)?;
    let column = format!("rmse_{}", of.role.name());
    let agents = &data.campaign.groups()[of.group];
    let errors = data.of_teams(&data.episodes, agents, &column, |_| true);
    let mut order: Vec<usize> = (0..met.len()).filter(|&k| met[k].is_finite()).collect();
    order.sort_by(|&a, &b| met[a].total_cmp(&met[b]));
    if order.len() < 5 * BINS {
        return None;
    }
    // Of a count, whose values are few, all episodes with the same belong together.
    let by_value = || order.chunk_by(|&a, &b| met[a].total_cmp(&met[b]).is_eq());
    let few = by_value().count() <= BINS;
    let bins: Vec<&[usize]> = match few {
        true => by_value().collect(),
        false => order.chunks(order.len().div_ceil(BINS)).collect(),
    };
    let groups = match few {
        true => "at each value".to_string(),
        false => format!("in {BINS} groups of equally many episodes"),
    };
    let mut marks = Vec::new();
    for (index, errors) in errors.iter().enumerate() {
        let (mut band, mut line) = (Vec::new(), Vec::new());
        for bin in &bins {
            let middle = met[bin[bin.len() / 2]];
            let mut of_bin: Vec<f64> = bin.iter().filter_map(|&k| errors.get(k).copied()).collect();
            of_bin.sort_by(f64::total_cmp);
            let quantile = |q: f64| {
                let place = whole((q * of_bin.len() as f64).floor());
                of_bin
                    .get(place.min(of_bin.len().saturating_sub(1)))
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            band.push((middle, quantile(0.05), quantile(0.95)));
            line.push((middle, quantile(0.5)));
        }
        marks.push(Mark::Band(band, Color::Series(index)));
        marks.push(Mark::Line(line, Color::Series(index), Stroke::Solid));
    }
    let name = title(&data.campaign, condition);
    Some(Figure {
        panels: vec![Plot {
            title: group.to_string(),
            x: Axis::new(name.clone()),
            y: Axis {
                logarithmic: true,
                ..Axis::new(format!("RMS error, {}", of.role.unit()))
            },
            marks,
            ..Plot::default()
        }],
        legend: data.legend(),
        caption: format!(
            "RMS error over {name}: median and the band from the 5th to the 95th percentile, {groups}. A band is left out where \
             its end diverges."
        ),
    })
}

/// The size of a condition in each episode where it was left to chance, as the ranking takes it: drawn anew, NaN where
/// it does not apply.
fn sizes(data: &RunData, condition: &str) -> Vec<f64> {
    let campaign = &data.campaign;
    let all = conditions(campaign);
    let measured = all.iter().find(|own| own.key == condition);
    let size = |episode| {
        let groups = campaign.groups().iter();
        let applied = groups.map(|group| draw(group, episode).applied(group));
        let size = measured.and_then(|own| own.of(&applied.collect::<Vec<_>>()));
        size.unwrap_or(f64::NAN)
    };
    let sizes: Vec<f64> = (0..data.manifest.episodes).map(size).collect();
    let drawn = by_chance(campaign, condition, &sizes);
    drawn
        .into_iter()
        .map(|size| size.unwrap_or(f64::NAN))
        .collect()
}

/// The ranges that were really drawn.
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
    for group in data.campaign.groups() {
        for (quantity, columns) in columns_of(data, group) {
            grid.rows.extend(range(data, group, &quantity, &columns));
        }
    }
    Section::new(
        "Conditions really drawn",
        vec![
            Block::text(
                "As applied, over all episodes, agents and the channels on which they act.",
            ),
            Block::Folded(
                format!("{} quantities", grid.rows.len()),
                vec![Block::Grid(grid)],
            ),
        ],
    )
}

/// The quantities that are drawn for a group of agents, with their columns: those that differ in the channel belong
/// together.
fn columns_of<'a>(data: &'a RunData, group: &AgentGroup) -> Vec<(String, Vec<&'a String>)> {
    let names = data.episodes.names();
    let begin = names.iter().position(|name| name == "mass_scale");
    let mut quantities: Vec<(String, Vec<&String>)> = Vec::new();
    for column in names.iter().skip(begin.unwrap_or(usize::MAX)) {
        let mut channels = group.channels().iter();
        let quantity = channels
            .find_map(|channel| column.strip_suffix(&format!("_{channel}")))
            .unwrap_or(column);
        match quantities.last_mut().filter(|(own, _)| own == quantity) {
            Some((_, columns)) => columns.push(column),
            None => quantities.push((quantity.to_string(), vec![column])),
        }
    }
    quantities
}

/// The range of a quantity of a group of agents; none where the group has no such quantity.
fn range(
    data: &RunData,
    group: &AgentGroup,
    quantity: &str,
    columns: &[&String],
) -> Option<Vec<Cell>> {
    let table = &data.episodes;
    let wanted = [
        ("controller", &*data.campaign.controllers[0]),
        ("group", &group.name),
    ];
    let cells = table
        .find(&wanted)
        .flat_map(|row| columns.iter().map(move |column| table.real(row, column)));
    let mut values: Vec<f64> = cells.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    if values.is_empty() {
        return None;
    }
    let name = match title(&data.campaign, quantity) {
        // What is numbered through all groups has the name of its group already.
        plain if plain == quantity => group.titled(quantity),
        titled => titled,
    };
    if let Some(flag) = name.strip_suffix(" occurs") {
        let share = values.iter().sum::<f64>() / values.len() as f64;
        let mut row = vec![
            Cell::text(format!("{flag}: share of agents that have it")),
            Cell::number(values.len().to_string()),
            Cell::number(format::rate(share, None)),
        ];
        row.resize(7, Cell::number(""));
        return Some(row);
    }
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
