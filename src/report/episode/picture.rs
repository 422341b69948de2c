//! The essential figures as one picture: a column for each controller, a row for each quantity.

use super::curves::{Quantity, panel};
use super::episode_data::Scene;
use crate::report::page::document::Key;
use crate::report::page::plot::Ink;
use crate::report::page::plot_grid::poster;

/// What the picture shows.
const ROWS: [Quantity; 4] = [
    Quantity::Error,
    Quantity::ActuatorFault,
    Quantity::SensorFault,
    Quantity::Command,
];
/// The agent that fared worst in the channel of its largest error.
pub(super) fn svg(scene: &Scene<'_>) -> String {
    let agent = scene.worst_agent();
    let (channel, _) = scene.error_of(agent);
    let (mut panels, mut cut) = (Vec::new(), false);
    for quantity in ROWS {
        for flight in &scene.flights {
            let (mut drawn, leaves) = panel(scene, quantity, (agent, channel), &[*flight]);
            cut |= leaves;
            drawn.title = format!("{}: {}", flight.name, quantity.name());
            panels.push(drawn);
        }
    }
    let mut legend = legend(scene);
    if panels.iter().any(|panel| !panel.spans.is_empty()) {
        legend.push(Key::shade(Ink::Fault, "a fault strikes"));
    }
    if panels.iter().any(|panel| !panel.levels.is_empty()) {
        legend.push(Key::line(Ink::Limit, "limit"));
    }
    let campaign = scene.campaign;
    let title = format!(
        "{}, episode {}: {} of agent {agent}",
        campaign.name,
        scene.episode.index,
        campaign.channels()[channel]
    );
    let subtitle = format!(
        "seed {}; the channel with the largest error{}{}",
        campaign.seed,
        match campaign.team {
            1 => "",
            _ => " of the agent that fared worst",
        },
        match cut {
            true => "; peaks leave the frame",
            false => "",
        }
    );
    poster(&title, &subtitle, &panels, scene.flights.len(), &legend)
}

/// Colours and what they mean.
fn legend(scene: &Scene<'_>) -> Vec<Key> {
    let flights = scene.flights.iter();
    let mut legend: Vec<Key> = flights
        .map(|flight| Key::line(flight.ink(), flight.name))
        .collect();
    legend.extend([
        Key::dashes(scene.estimate_ink(), "estimate of e"),
        Key::line(
            Ink::Truth,
            "f1, f2; their estimates in the colour of the controller",
        ),
    ]);
    legend
}
