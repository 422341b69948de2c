//! The figures of a replay: one episode under every controller of its campaign, as the paper's Figures 8 and 10 to 20
//! show one.

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
    let scene = EpisodeView::new(replay);
    Trace {
        html: html(&document(&scene)),
        svg: picture::svg(&scene),
    }
}

fn document(scene: &EpisodeView<'_>) -> Document {
    let campaign = scene.campaign;
    let asked = scene.asked();
    let mut sections = vec![errors(scene), encountered::section(scene)];
    sections.push(match campaign.agent {
        Agent::Uav(_) => path::section(scene),
        Agent::Biped(ref biped) => walk::section(scene, &biped.robot),
    });
    sections.extend(agents(scene));
    Document {
        title: format!("Episode {} of {}", scene.episode.index, campaign.name),
        subtitle: format!(
            "{} {} over {} s; {} beside {}; seed {}",
            campaign.team,
            campaign.agent.noun(campaign.team),
            scene.duration_s,
            asked.name,
            match &*scene.others().map(|flight| flight.name).collect::<Vec<_>>() {
                [] => "no other controller".to_string(),
                names => names.join(", "),
            },
            campaign.seed
        ),
        lead: scene
            .flights
            .iter()
            .map(|flight| ending(scene, flight))
            .collect(),
        warnings: scene
            .replay
            .stand_in
            .iter()
            .map(|reason| {
                format!(
                    "Simulated in f64 on the CPU, so digits beyond single precision differ from the run's: {reason}"
                )
            })
            .collect(),
        sections,
    }
}

/// How a flight ended, in a sentence.
fn ending(scene: &EpisodeView<'_>, flight: &ControllerTrace<'_>) -> String {
    let failed: Vec<String> = (0..scene.campaign.team)
        .filter_map(|agent| {
            let outcome = &flight.outcomes[agent];
            let how = match (status(scene.campaign, outcome), outcome.failed_step) {
                (Status::Ok, _) => return None,
                (Status::Exceeded, Some(_)) => "broke max_error",
                (Status::Exceeded, None) => "broke max_rmse",
                (Status::Diverged, _) => "failed",
            };
            let when = scene.failed_at_s(flight, agent);
            let when = when.map_or(String::new(), |t_s| format!(" at {t_s:.3} s"));
            let then = match outcome.diverged {
                true => " and diverged",
                false => "",
            };
            Some(format!("agent {agent} {how}{when}{then}"))
        })
        .collect();
    let name = flight.name;
    match &*failed {
        [] if scene.campaign.team == 1 => format!("{name}: ok, within the limits."),
        [] => format!("{name}: ok, every agent within the limits."),
        failed => format!("{name}: {}.", failed.join(", ")),
    }
}

/// The errors in numbers.
fn errors(scene: &EpisodeView<'_>) -> Section {
    let worst = scene.worst_agent();
    let others: Vec<Block> = (0..scene.campaign.team)
        .filter(|&agent| agent != worst)
        .flat_map(|agent| {
            [
                Block::text(format!("Agent {agent}")),
                Block::Grid(errors_of(scene, agent)),
            ]
        })
        .collect();
    let bounded = match scene.is_bounded() {
        true => format!(
            ", and for {} the attenuation that inequality (24) of the paper bounds, beside its certified level",
            scene.asked().name
        ),
        false => String::new(),
    };
    let mut blocks = vec![
        Block::text(format!(
            "Agent {worst}{}: RMS error / largest error from {} s on{bounded}.",
            match scene.campaign.team {
                1 => "",
                _ => ", which fared worst",
            },
            f64::from(scene.campaign.time.settle_step) * scene.campaign.time.step_s,
        )),
        Block::Grid(errors_of(scene, worst)),
    ];
    if !others.is_empty() {
        let title = format!("the other {}", scene.campaign.agent.plural());
        blocks.push(Block::Folded(title, others));
    }
    let mut reasons: Vec<String> = Vec::new();
    let found = scene.replay.attenuations.iter().flatten();
    for reason in found.filter_map(|found| found.as_ref().err()) {
        let reason = reason.to_string();
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    if !reasons.is_empty() {
        let place = match scene.is_bounded() {
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

fn errors_of(scene: &EpisodeView<'_>, agent: usize) -> Grid {
    let mut grid = Grid::new(["channel"]);
    let names = scene.flights.iter().map(|flight| flight.name.to_string());
    grid.head.extend(names);
    if scene.is_bounded() {
        let heads = ["attenuation", "certified", "(24)"];
        grid.head.extend(heads.map(String::from));
    }
    for (channel, name) in scene.campaign.channels().iter().enumerate() {
        let unit = scene.campaign.unit(channel);
        let mut row = vec![Cell::text(format!("{name},\u{a0}{unit}"))];
        row.extend(scene.flights.iter().map(|flight| {
            let metrics = &flight.outcomes[agent].channels[channel];
            Cell::number(match metrics.max_abs.is_nan() {
                true => "-".to_string(),
                false => format!("{} / {}", number(metrics.rmse), number(metrics.max_abs)),
            })
        }));
        let attenuation = match &scene.replay.attenuations[agent][channel] {
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
        row.extend(attenuation.into_iter().filter(|_| scene.is_bounded()));
        grid.rows.push(row);
    }
    grid
}

/// The curves: those of the agent that fared worst, and then, folded, of the others.
fn agents(scene: &EpisodeView<'_>) -> Vec<Section> {
    let channels = scene.campaign.channels().len();
    let order = scene.worst_first();
    let in_full = channels * order.len() <= MOST_IN_FULL;
    let drawn = (MOST_CHANNELS / channels).clamp(1, order.len());
    let full = |agent: usize| -> Vec<Block> {
        Quantity::ALL
            .into_iter()
            .map(|quantity| Block::Figure(figure(scene, quantity, agent)))
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
                vec![Block::Figure(figure(scene, Quantity::Error, agent))],
            )),
        }
    }
    if order.len() > drawn || !in_full {
        folded.push(Block::text(
            "What is not drawn is in the Parquet file beside this page; `--controller` chooses the controller that it holds.",
        ));
    }
    if order.len() > 1 {
        let title = format!("The other {}", scene.campaign.agent.plural());
        sections.push(Section::new(title, folded));
    }
    sections
}
