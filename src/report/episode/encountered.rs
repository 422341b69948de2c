//! What an episode met: faults, disturbances and the rest of its draw.

use super::episode_data::EpisodeView;
use crate::campaign::Link;
use crate::draw::AgentDraw;
use crate::draw::quantities::Source;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::statistics::root_mean_square;
use crate::util::format::number;
use std::sync::Arc;

/// Values that are listed; of more, the lowest and the highest.
const MOST_LISTED: usize = 3;

/// The draw of the episode.
pub(super) fn section(view: &EpisodeView<'_>) -> Section {
    let mut blocks = vec![faults(view)];
    let groups = view.campaign.groups().iter();
    let of_groups = groups.map(|group| match group.disturbances.len() {
        0 => group.titled("no disturbance"),
        1 => group.titled("one disturbance of each agent"),
        count => group.titled(&format!("{count} disturbances of each agent")),
    });
    let disturbances = disturbances(view);
    if !disturbances.rows.is_empty() {
        let summary = of_groups.collect::<Vec<_>>().join(", ");
        blocks.push(Block::Folded(summary, vec![Block::Grid(disturbances)]));
    }
    let summary = "model errors, coupling and initial errors".to_string();
    blocks.push(Block::Folded(summary, vec![conditions(view)]));
    Section::new("What it met", blocks)
}

fn faults(view: &EpisodeView<'_>) -> Block {
    let mut grid = Grid::new([
        "agent",
        "fault",
        "strikes",
        "channels",
        "from",
        "until",
        "ramp",
        "parameters",
    ]);
    for agent in 0..view.campaign.agents() {
        let (group, draw) = (view.group(agent), view.draw(agent));
        for (place, (fault, drawn)) in group.faults.iter().zip(&draw.faults).enumerate() {
            if !drawn.occurs() {
                continue;
            }
            let (from_s, until_s) = view.window(drawn);
            let names = group.channels().iter().zip(&drawn.strikes);
            let struck: Vec<&str> = names
                .filter(|(_, strikes)| **strikes)
                .map(|(name, _)| &**name)
                .collect();
            let channels = match struck.len() {
                all if all == drawn.strikes.len() => "all".to_string(),
                _ => struck.join(", "),
            };
            let parameters = parameters(view, agent, |source| source == Source::Fault(place));
            let target = fault.target.name();
            let strikes = match (target, fault.link) {
                ("network", Link::Command) => "network, command",
                ("network", Link::Measurement) => "network, measurement",
                _ => target,
            };
            grid.rows.push(vec![
                Cell::number(agent.to_string()),
                Cell::text(&*fault.name),
                Cell::text(strikes),
                Cell::text(channels),
                Cell::number(format!("{} s", number(from_s))),
                Cell::number(match until_s < view.duration_s {
                    true => format!("{} s", number(until_s)),
                    false => "the end".to_string(),
                }),
                Cell::number(match drawn.ramp_s > 0.0 {
                    true => format!("{} s", number(drawn.ramp_s)),
                    false => "at once".to_string(),
                }),
                Cell::text(listed(parameters)),
            ]);
        }
    }
    match grid.rows.is_empty() {
        true => Block::text("No fault struck anyone."),
        false => Block::Grid(grid),
    }
}

fn disturbances(view: &EpisodeView<'_>) -> Grid {
    let mut grid = Grid::new(["agent", "disturbance", "parameters"]);
    for agent in 0..view.campaign.agents() {
        for (place, disturbance) in view.group(agent).disturbances.iter().enumerate() {
            let source = Source::Disturbance(place, disturbance.kind);
            let parameters = parameters(view, agent, |own| own == source);
            grid.rows.push(vec![
                Cell::number(agent.to_string()),
                Cell::text(disturbance.kind.name()),
                Cell::text(listed(parameters)),
            ]);
        }
    }
    grid
}

fn conditions(view: &EpisodeView<'_>) -> Block {
    let mut grid = Grid::new([
        "agent",
        "true over modelled mass",
        "inertia",
        "coupling κ",
        "delay of the command",
        "initial error (RMS)",
        "of the rate (RMS)",
    ]);
    for agent in 0..view.campaign.agents() {
        let AgentDraw {
            mass_scale,
            inertia_scale,
            kappa,
            control_delay_s,
            error,
            error_rate,
            ..
        } = view.draw(agent);
        grid.rows.push(vec![
            Cell::number(agent.to_string()),
            Cell::number(number(*mass_scale)),
            Cell::number(number(*inertia_scale)),
            Cell::number(number(*kappa)),
            Cell::number(format!("{} s", number(*control_delay_s))),
            Cell::number(number(size(error))),
            Cell::number(number(size(error_rate))),
        ]);
    }
    Block::Grid(grid)
}

/// The parameters of a disturbance or fault with an agent's values.
fn parameters<'a>(
    view: &'a EpisodeView<'_>,
    agent: usize,
    is_of: impl Fn(Source) -> bool + 'a,
) -> impl Iterator<Item = String> + 'a {
    let own = view.quantities(agent).iter();
    let own = own.filter(move |own| own.is_parameter() && is_of(own.source));
    own.map(move |quantity| {
        let names = view.group(agent).channels();
        let values = quantity.applied(view.draw(agent));
        let values: Vec<_> = values.map(|(k, value)| (&names[k], value)).collect();
        valued(quantity.name, &values)
    })
}

/// Parameters one after the other, none of them broken across lines.
fn listed(parameters: impl Iterator<Item = String>) -> String {
    let unbroken = parameters.map(|parameter| parameter.replace(' ', "\u{a0}"));
    unbroken.collect::<Vec<_>>().join("; ")
}

/// A parameter's values: each with its channel, or their range.
fn valued(name: &str, values: &[(&Arc<str>, f64)]) -> String {
    let only = values.iter().map(|(_, value)| *value);
    let (low, high) = only.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    match values {
        [] => format!("{name} -"),
        [(_, value)] => format!("{name} {}", number(*value)),
        _ if low >= high => format!("{name} {}", number(low)),
        _ if values.len() <= MOST_LISTED => {
            let each = values
                .iter()
                .map(|(channel, value)| format!("{} ({channel})", number(*value)));
            format!("{name} {}", each.collect::<Vec<_>>().join(", "))
        }
        _ => format!("{name} {} to {}", number(low), number(high)),
    }
}

/// Root mean square.
fn size(values: &[f64]) -> f64 {
    root_mean_square(values.iter().copied()).unwrap_or(f64::NAN)
}
