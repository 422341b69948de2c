//! The essential figures as one picture: a column for each controller, a row for each quantity.

use super::curves::{Quantity, panel};
use super::episode_data::EpisodeView;
use crate::report::page::document::LegendEntry;
use crate::report::page::plot::Color;
use crate::report::page::plot_grid::plot_grid;

/// What the picture shows.
const ROWS: [Quantity; 4] = [
    Quantity::Error,
    Quantity::ActuatorFault,
    Quantity::SensorFault,
    Quantity::Command,
];
/// The agent that fared worst in the channel of its largest error.
pub(super) fn svg(view: &EpisodeView<'_>) -> String {
    let agent = view.worst_agent();
    let (channel, _) = view.error_of(agent);
    let (mut panels, mut cut) = (Vec::new(), false);
    for quantity in ROWS {
        for trace in &view.traces {
            let (mut drawn, leaves) = panel(view, quantity, (agent, channel), &[*trace]);
            cut |= leaves;
            drawn.title = format!("{}: {}", trace.name, quantity.name());
            panels.push(drawn);
        }
    }
    let mut legend = legend(view);
    if panels.iter().any(|panel| !panel.spans.is_empty()) {
        legend.push(LegendEntry::shade(Color::Fault, "a fault strikes"));
    }
    if panels.iter().any(|panel| !panel.levels.is_empty()) {
        legend.push(LegendEntry::line(Color::Limit, "limit"));
    }
    let campaign = view.campaign;
    let title = format!(
        "{}, episode {}: {} of agent {agent}",
        campaign.name,
        view.replay.episode,
        view.group(agent).channels()[channel]
    );
    let subtitle = format!(
        "seed {}; the channel with the largest error{}{}",
        campaign.seed,
        match campaign.agents() {
            1 => "",
            _ => " of the agent that fared worst",
        },
        match cut {
            true => "; peaks leave the frame",
            false => "",
        }
    );
    plot_grid(&title, &subtitle, &panels, view.traces.len(), &legend)
}

/// Colours and what they mean.
fn legend(view: &EpisodeView<'_>) -> Vec<LegendEntry> {
    let traces = view.traces.iter();
    let mut legend: Vec<LegendEntry> = traces
        .map(|trace| LegendEntry::line(trace.color(), trace.name))
        .collect();
    legend.extend([
        LegendEntry::dashes(view.estimate_color(), "estimate of e"),
        LegendEntry::line(
            Color::Truth,
            "f1, f2; their estimates in the colour of the controller",
        ),
    ]);
    legend
}
