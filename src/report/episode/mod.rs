//! The figures of a replay: one episode under every controller of its campaign, as the paper's Figures 8 and 10 to 20
//! show one.

mod close_up;
mod curves;
mod encountered;
mod episode_data;
mod frame;
mod path;
mod picture;
mod walk;

use super::page::document::{Block, Cell, Document, Grid, Section};
use super::page::html::html;
use crate::agent::Agent;
use crate::results::scores::{Status, status};
use crate::run::replay::Replay;
use crate::simulation::attenuation::INEQUALITY;
use crate::util::format::number;
use curves::{Quantity, figure};
use episode_data::{ControllerTrace, EpisodeView};

/// Channels of which all quantities are drawn; beyond it, those of the agent that fared worst, and the errors of the
/// others.
const MOST_IN_FULL: usize = 24;
/// Channels of which anything is drawn: bounds the size of a page.
const MOST_CHANNELS: usize = 48;

/// The figures of a replay.
#[derive(Debug)]
pub struct Trace {
    /// All of them, on a page that opens from disk.
    pub html: String,
    /// The essential ones, as a picture.
    pub svg: String,
}

/// Draws a replayed episode.
#[must_use]
pub fn trace(replay: &Replay) -> Trace {
    let view = EpisodeView::new(replay);
    Trace {
        html: html(&document(&view)),
        svg: picture::svg(&view),
    }
}

fn document(view: &EpisodeView<'_>) -> Document {
    let campaign = view.campaign;
    let asked = view.asked();
    let mut sections = vec![errors(view), encountered::section(view)];
    sections.extend(close_up::section(view));
    sections.extend(campaign.groups().iter().map(|group| match &group.agent {
        Agent::Uav(_) => path::section(view, group),
        Agent::Biped(biped) => walk::section(view, group, &biped.robot),
    }));
    sections.extend(agents(view));
    Document {
        title: format!("Episode {} of {}", view.replay.episode, campaign.name),
        subtitle: format!(
            "{} over {} s; {} beside {}; seed {}",
            campaign.agents_in_words(),
            view.duration_s,
            asked.name,
            match &*view.others().map(|trace| trace.name).collect::<Vec<_>>() {
                [] => "no other controller".to_string(),
                names => names.join(", "),
            },
            campaign.seed
        ),
        lead: view
            .traces
            .iter()
            .map(|trace| ending(view, trace))
            .collect(),
        warnings: view.replay.cautions(),
        sections,
        ..Document::default()
    }
}

/// How the episode ended under a controller, in a sentence.
fn ending(view: &EpisodeView<'_>, trace: &ControllerTrace<'_>) -> String {
    let failed: Vec<String> = (0..view.campaign.agents())
        .filter_map(|agent| {
            let outcome = &trace.outcomes[agent];
            let how = match (status(view.group(agent), outcome), outcome.failed_step) {
                (Status::Ok, _) => return None,
                (Status::Exceeded, Some(_)) => "broke max_error",
                (Status::Exceeded, None) => "broke max_rmse",
                (Status::Diverged, _) => "failed",
            };
            let when = view.failed_at_s(trace, agent);
            let when = when.map_or(String::new(), |t_s| format!(" at {t_s:.3} s"));
            let then = match outcome.diverged {
                true => " and diverged",
                false => "",
            };
            Some(format!("agent {agent} {how}{when}{then}"))
        })
        .collect();
    let name = trace.name;
    match &*failed {
        [] if view.campaign.agents() == 1 => format!("{name}: ok, within the limits."),
        [] => format!("{name}: ok, every agent within the limits."),
        failed => format!("{name}: {}.", failed.join(", ")),
    }
}

/// The errors in numbers.
fn errors(view: &EpisodeView<'_>) -> Section {
    let worst = view.worst_agent();
    let others: Vec<Block> = (0..view.campaign.agents())
        .filter(|&agent| agent != worst)
        .flat_map(|agent| {
            [
                Block::text(format!("Agent {agent}")),
                Block::Grid(errors_of(view, agent)),
            ]
        })
        .collect();
    let bounded = match view.is_bounded() {
        true => format!(
            ", and for {} the attenuation that inequality (24) of the paper bounds, beside its certified level",
            view.asked().name
        ),
        false => String::new(),
    };
    let mut blocks = vec![
        Block::text(format!(
            "Agent {worst}{}: RMS error / largest error from {} s on{bounded}.",
            match view.campaign.agents() {
                1 => "",
                _ => ", which fared worst",
            },
            f64::from(view.campaign.time.settle_step) * view.campaign.time.step_s,
        )),
        Block::Grid(errors_of(view, worst)),
    ];
    if !others.is_empty() {
        let title = format!("the other {}", view.campaign.plural());
        blocks.push(Block::Folded(title, others));
    }
    if view.is_bounded() {
        blocks.push(Block::text(format!("{INEQUALITY}.")));
    }
    let mut reasons: Vec<String> = Vec::new();
    let found = view.replay.attenuations.iter().flatten();
    for reason in found.filter_map(|found| found.as_ref().err()) {
        let reason = reason.to_string();
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    if !reasons.is_empty() {
        let place = match view.is_bounded() {
            true => " where there is a dash",
            false => "",
        };
        blocks.push(Block::text(format!(
            "Inequality (24) is not applicable{place}: {}.",
            reasons.join("; ")
        )));
    }
    Section::new("Errors", blocks)
}

fn errors_of(view: &EpisodeView<'_>, agent: usize) -> Grid {
    let mut grid = Grid::new(["channel"]);
    let names = view.traces.iter().map(|trace| trace.name.to_string());
    grid.head.extend(names);
    if view.is_bounded() {
        let heads = ["attenuation", "certified", "(24)"];
        grid.head.extend(heads.map(String::from));
    }
    let group = view.group(agent);
    for (channel, name) in group.channels().iter().enumerate() {
        let unit = group.unit(channel);
        let mut row = vec![Cell::text(format!("{name},\u{a0}{unit}"))];
        row.extend(view.traces.iter().map(|trace| {
            let metrics = &trace.outcomes[agent].channels[channel];
            Cell::number(match metrics.max_abs.is_nan() {
                true => "-".to_string(),
                false => format!("{} / {}", number(metrics.rmse), number(metrics.max_abs)),
            })
        }));
        let attenuation = match &view.replay.attenuations[agent][channel] {
            Ok(found) => [
                Cell::number(number(found.level())),
                Cell::number(number(found.certified)),
                Cell::Verdict(
                    found.holds(),
                    if found.holds() { "holds" } else { "fails" }.into(),
                ),
            ],
            Err(_) => ["-"; 3].map(Cell::number),
        };
        row.extend(attenuation.into_iter().filter(|_| view.is_bounded()));
        grid.rows.push(row);
    }
    grid
}

/// The curves: those of the agent that fared worst, and then, folded, of the others.
fn agents(view: &EpisodeView<'_>) -> Vec<Section> {
    let order = view.worst_first();
    // Channels of an agent and of all that fared worse.
    let mut channels = 0;
    let channels: Vec<usize> = order
        .iter()
        .map(|&agent| {
            channels += view.group(agent).channels().len();
            channels
        })
        .collect();
    let in_full = channels.last().is_some_and(|all| *all <= MOST_IN_FULL);
    let fitting = channels.iter().filter(|own| **own <= MOST_CHANNELS).count();
    let drawn = fitting.max(1);
    let full = |agent: usize| -> Vec<Block> {
        Quantity::ALL
            .into_iter()
            .map(|quantity| Block::Figure(figure(view, quantity, agent)))
            .collect()
    };
    let mut sections = Vec::new();
    let mut folded = Vec::new();
    for (place, &agent) in order.iter().take(drawn).enumerate() {
        let title = format!("Agent {agent}");
        match (place, in_full) {
            (0, _) => sections.push(Section::new(title, full(agent))),
            (_, true) => folded.push(Block::Folded(title, full(agent))),
            (_, false) => folded.push(Block::Folded(
                format!("{title}: tracking errors"),
                vec![Block::Figure(figure(view, Quantity::Error, agent))],
            )),
        }
    }
    if order.len() > drawn || !in_full {
        folded.push(Block::text(
            "What is not drawn is in the Parquet file beside this page; `--controller` chooses the controller that it holds.",
        ));
    }
    if order.len() > 1 {
        let title = format!("The other {}", view.campaign.plural());
        sections.push(Section::new(title, folded));
    }
    sections
}
