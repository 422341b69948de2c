//! The page of a search: what it reaches, within which limits, how it went, and what a smaller error is paid with.

use super::page::document::{Block, Cell, Document, Figure, Grid, LegendEntry, Section};
use super::page::html;
use super::page::markdown::{self, Length};
use super::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::campaign::{Bound, MeasuredChannels, Side};
use crate::results::Measured;
use crate::run::tune::{Evaluation, Tuning};
use crate::util::format;

/// Candidates of the search, what it began with, what it found, and the limits.
const TRIED: Color = Color::Series(0);
const FOUND: Color = Color::Series(1);
const START: Color = Color::Truth;
/// How far a candidate may be from the start and the result to be drawn, as a factor.
const FARTHEST: f64 = 4.0;

/// The page of a search in HTML and in Markdown.
#[must_use]
pub fn tuning(tuning: &Tuning) -> [String; 2] {
    let sections = [
        reached(tuning),
        went(tuning),
        paid(tuning),
        parameters(tuning),
        used(tuning),
    ];
    let document = Document {
        title: format!("{}: {}", tuning.campaign.name, tuning.structure.tuned),
        subtitle: subtitle(tuning),
        lead: lead(tuning),
        warnings: warnings(tuning),
        sections: sections.into(),
        ..Document::default()
    };
    [
        html::html(&document),
        markdown::markdown(&document, Length::Brief),
    ]
}

/// What was done, in a line.
pub(super) fn subtitle(tuning: &Tuning) -> String {
    format!(
        "{} candidates in {} episodes each, confirmed in {} fresh episodes; seed {}",
        tuning.tried(),
        tuning.asked.episodes,
        tuning.asked.confirmation,
        tuning.campaign.seed
    )
}

/// What was found, a sentence for each of the measures that were to be small.
pub(super) fn lead(tuning: &Tuning) -> Vec<String> {
    let of_measure = |&place: &usize| {
        let [start, found] = [&tuning.start, &tuning.confirmed].map(|own| value(own, place));
        let change = match found / start {
            ratio if !ratio.is_finite() => String::new(),
            ratio if ratio < 1.0 => format!(", {:.2} times smaller than", 1.0 / ratio),
            ratio => format!(", {ratio:.2} times larger than"),
        };
        let before = match change.is_empty() {
            true => String::new(),
            false => format!(
                "{change} with the parameters that the search began with ({})",
                format::number(start)
            ),
        };
        format!(
            "{} has {} = {} in fresh episodes{before}",
            tuning.structure.tuned,
            tuning.measures[place],
            estimate(&tuning.confirmed, place)
        )
    };
    tuning.minimised.iter().map(of_measure).collect()
}

/// Which limits the result does not keep in fresh episodes, and what else there is to know.
pub(super) fn warnings(tuning: &Tuning) -> Vec<String> {
    let judged = tuning
        .limits
        .iter()
        .zip(&tuning.confirmed.bounds)
        .zip(&tuning.confirmed.holds);
    let broken = judged.filter(|(_, holds)| !**holds).map(|(((place, limit), bound), _)| {
        format!(
            "in fresh episodes {} does not keep the limit {limit}: {} against {}; give it more tune.episodes",
            tuning.structure.tuned,
            estimate(&tuning.confirmed, *place),
            format::number(*bound)
        )
    });
    let refused = tuning
        .confirmed
        .refused
        .iter()
        .map(|reason| format!("it cannot fly: {reason}"));
    broken
        .chain(refused)
        .chain(tuning.notes.iter().cloned())
        .collect()
}

/// What is measured of the result, beside what it began with and what it had to keep.
pub(super) fn reached(tuning: &Tuning) -> Section {
    let mut grid = Grid::new([
        "measure",
        "at the start",
        "when chosen",
        "in fresh episodes [95 %]",
        "limit",
        "holds",
    ]);
    let chosen = tuning.finalists.first().unwrap_or(&tuning.confirmed);
    for (place, measure) in tuning.measures.iter().enumerate() {
        let limits = tuning
            .limits
            .iter()
            .enumerate()
            .filter(|(_, (of, _))| *of == place);
        let bounds = limits.clone().map(|(index, (_, limit))| {
            let side = match limit.side {
                Side::AtMost => "≤",
                Side::AtLeast => "≥",
            };
            let bound = tuning
                .confirmed
                .bounds
                .get(index)
                .copied()
                .unwrap_or(f64::NAN);
            match &limit.bound {
                Bound::Number(_) => format!("{side} {}", format::number(bound)),
                Bound::Of(name) => format!("{side} {} of {name}", format::number(bound)),
            }
        });
        let bounds: Vec<String> = bounds.collect();
        let holds = limits.map(|(index, _)| tuning.confirmed.holds.get(index) == Some(&true));
        let holds: Vec<bool> = holds.collect();
        grid.rows.push(vec![
            Cell::text(measure.to_string()),
            Cell::number(format::number(value(&tuning.start, place))),
            Cell::number(format::number(value(chosen, place))),
            Cell::number(estimate(&tuning.confirmed, place)),
            Cell::text(bounds.join(", ")),
            match holds.as_slice() {
                [] => Cell::text(""),
                holds if holds.iter().all(|own| *own) => Cell::Verdict(true, "yes".into()),
                _ => Cell::Verdict(false, "no".into()),
            },
        ]);
    }
    let explained = "The search saw the episodes of its generations, and the choice among its best candidates others; no \
                     candidate has seen the fresh ones. What was chosen for its small value is larger in fresh episodes as a \
                     rule: the difference is what the search has learnt by heart.";
    Section::new(
        "What it reaches",
        vec![Block::Grid(grid), Block::text(explained)],
    )
}

/// How the search went: the objective of the candidates that keep the limits.
fn went(tuning: &Tuning) -> Section {
    let mut dots = Vec::new();
    let mut best = Vec::new();
    let (mut count, mut least) = (0.0, f64::INFINITY);
    for generation in &tuning.generations {
        for own in generation {
            count += 1.0;
            if own.holds_all() {
                dots.push((count, own.objective));
                least = own.objective.min(least);
            }
        }
        best.push((count, least));
    }
    let plot = Plot {
        x: Axis::new("candidates"),
        y: Axis {
            logarithmic: true,
            ..Axis::new("objective")
        },
        marks: vec![
            Mark::Dots(dots.clone(), TRIED),
            Mark::Line(best, FOUND, Stroke::Steps),
        ],
        ..Plot::default()
    };
    let names = tuning
        .minimised
        .iter()
        .map(|place| tuning.measures[*place].to_string());
    let caption = format!(
        "The objective ({}) of the {} of {} candidates that keep all limits, and the least so far. Every generation has \
         episodes of its own.",
        names.collect::<Vec<_>>().join(" + "),
        dots.len(),
        tuning.tried()
    );
    Section::new(
        "How the search went",
        vec![Block::Figure(Figure {
            panels: vec![plot],
            legend: vec![
                LegendEntry::line(TRIED, "keeps all limits"),
                LegendEntry::line(FOUND, "least so far"),
            ],
            caption,
        })],
    )
}

/// The trade-off: error against largest commands and against delay margin, and the candidates that nothing beats in
/// both.
fn paid(tuning: &Tuning) -> Section {
    let mut panels = Vec::new();
    for &place in &tuning.minimised {
        let measure = &tuning.measures[place];
        let Some(channels) = measure.channels() else {
            continue;
        };
        let [command, margin] = tuning.paid(channels);
        let unit = tuning.campaign.channel_groups()[channels.index].role.unit();
        let axes = [
            (command, command_axis(channels), false),
            (
                margin,
                Axis::new(format!("delay margin, {}, ms", channels.name)),
                true,
            ),
        ];
        for (price, x, larger_is_better) in axes {
            let Some(price) = price else { continue };
            let y = Axis {
                logarithmic: true,
                ..Axis::new(format!("{measure}, {unit}"))
            };
            panels.push(front(tuning, [price, place], larger_is_better, [x, y]));
        }
    }
    let explained = "Candidates up to four times the error and the price of the start, whether they keep the limits or not. \
                     Those on the line are beaten by none in both: beyond the limits a smaller error costs what the line says.";
    Section::new(
        "What a smaller error is paid with",
        vec![Block::Figure(Figure {
            panels,
            legend: vec![
                LegendEntry::line(TRIED, "candidates"),
                LegendEntry::line(FOUND, "beaten by none, and the result"),
                LegendEntry::line(START, "the start"),
            ],
            caption: explained.to_string(),
        })],
    )
}

fn command_axis(channels: &MeasuredChannels) -> Axis {
    Axis {
        logarithmic: true,
        ..Axis::new(format!(
            "largest command (95th percentile), {}",
            channels.name
        ))
    }
}

/// All candidates over two measures, x and y.
fn front(tuning: &Tuning, [x, y]: [usize; 2], larger_x: bool, axes: [Axis; 2]) -> Plot {
    let point = |own: &Evaluation| (value(own, x), value(own, y));
    let ends = [point(&tuning.start), point(&tuning.confirmed)];
    let most = |pick: fn(&(f64, f64)) -> f64| {
        FARTHEST * ends.iter().map(pick).fold(f64::MIN_POSITIVE, f64::max)
    };
    // Those that nobody would take would leave no room for the others.
    let (most_x, most_y) = (most(|own| own.0), most(|own| own.1));
    let is_near = |(x, y): &(f64, f64)| *x <= most_x && *y <= most_y;
    let all = tuning.generations.iter().flatten().map(point);
    let all = all.filter(is_near);
    let all: Vec<(f64, f64)> = all.collect();
    let mut order = all.clone();
    order.sort_by(|a, b| match larger_x {
        true => b.0.total_cmp(&a.0),
        false => a.0.total_cmp(&b.0),
    });
    let mut least = f64::INFINITY;
    order.retain(|(_, y)| {
        let better = *y < least;
        least = y.min(least);
        better
    });
    let [x, y] = axes;
    Plot {
        x,
        y,
        marks: vec![
            Mark::Dots(all, TRIED),
            Mark::Line(order, FOUND, Stroke::Steps),
            Mark::Dots(vec![ends[0]], START),
            Mark::Dots(vec![ends[1]], FOUND),
        ],
        ..Plot::default()
    }
}

/// The parameters at the start and in the end.
fn parameters(tuning: &Tuning) -> Section {
    let mut grid = Grid::new(["parameter", "at the start", "found"]);
    let values = tuning.start.values.iter().zip(&tuning.confirmed.values);
    for (name, (start, found)) in tuning.parameters().into_iter().zip(values) {
        let [start, found] = [start, found].map(|value| Cell::number(format::number(*value)));
        grid.rows.push(vec![Cell::Text(name), start, found]);
    }
    Section::new("Parameters", vec![Block::Grid(grid)])
}

/// How a campaign takes the result.
pub(super) fn used(tuning: &Tuning) -> Section {
    let name = tuning.structure.tuned;
    // The names of the program's own controllers are taken.
    let file =
        format!("[synthesis.named.{name}-here]\ngains = \"gains.json\"\ncontroller = \"{name}\"");
    Section::new("How a campaign takes it", vec![Block::Code(file)])
}

/// A measure of a candidate.
fn value(of: &Evaluation, place: usize) -> f64 {
    of.measured.get(place).map_or(f64::NAN, |found| found.value)
}

/// The same with its interval.
fn estimate(of: &Evaluation, place: usize) -> String {
    match of.measured.get(place) {
        None => "-".to_string(),
        Some(Measured {
            value,
            interval: None,
        }) => format::number(*value),
        Some(Measured {
            value,
            interval: Some(interval),
        }) => format::measured(*value, interval.lower, interval.upper),
    }
}
