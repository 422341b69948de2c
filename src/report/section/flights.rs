//! Two flights to look at: how error and command go over time under every controller.

use crate::agent::ChannelRole;
use crate::report::page::document::{Block, Figure, Section};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::{RunData, whole};
use crate::results::flights::{MEDIAN, WORST};
use crate::run::replay::command;

/// The median and the worst flight of the first controller; none of runs of older versions.
pub(crate) fn section(data: &RunData) -> Option<Section> {
    let mut blocks = vec![Block::Text(format!(
        "Each under every controller, simulated again on the CPU in double precision. Error: root mean square over agents \
         and channels at the instant; command: the largest |u| of them. Chosen by {}: half of the flights have no larger \
         RMS error than the median one, and none is worse than the worst.",
        data.campaign.controllers.first()?
    ))];
    let mut commands = String::new();
    for name in [MEDIAN, WORST] {
        let wanted = [("flight", name)];
        let Some(row) = data.flights.find(&wanted).next() else {
            continue;
        };
        let episode = whole(data.flights.real(row, "episode"));
        blocks.push(Block::Figure(figure(data, name, episode)));
        let episode = u32::try_from(episode).unwrap_or(u32::MAX);
        let line = command(&data.dir, episode, &data.campaign.controllers[0]);
        commands.push_str(&format!("{line}\n"));
    }
    if commands.is_empty() {
        return None;
    }
    blocks.push(Block::Text("Every agent and channel of them:".into()));
    blocks.push(Block::Code(commands));
    Some(Section::new("Two flights", blocks))
}

/// Errors, then commands, of each channel group.
fn figure(data: &RunData, name: &str, episode: usize) -> Figure {
    let flight = Flight {
        data,
        name,
        failed_at_s: failures(data, name),
    };
    let groups = data.campaign.channel_groups();
    let errors = groups.iter().map(|of| {
        let axis = Axis {
            logarithmic: true,
            ..Axis::new(format!("error, {}", of.role.unit()))
        };
        flight.panel(&of.name, "error", axis)
    });
    let commands = groups.iter().map(|of| {
        let unit = match of.role {
            ChannelRole::Position => "N",
            ChannelRole::Attitude | ChannelRole::Joints => "N m",
        };
        flight.panel(&of.name, "command", Axis::new(format!("command, {unit}")))
    });
    Figure {
        panels: errors.chain(commands).collect(),
        legend: data.legend(),
        caption: format!(
            "The {name} flight: episode {episode}. A dot ends a curve where the episode has failed."
        ),
    }
}

/// A flight, and when it failed under each controller.
struct Flight<'a> {
    data: &'a RunData,
    name: &'a str,
    /// Infinite where it did not.
    failed_at_s: Vec<f64>,
}

impl Flight<'_> {
    fn panel(&self, group: &str, column: &str, y: Axis) -> Plot {
        let table = &self.data.flights;
        let controllers = self.data.campaign.controllers.iter().zip(&self.failed_at_s);
        let marks = controllers
            .enumerate()
            .flat_map(|(index, (controller, until_s))| {
                let wanted = [
                    ("flight", self.name),
                    ("controller", controller),
                    ("group", group),
                ];
                let points = table.find(&wanted).map(|row| {
                    let value = table.real(row, column);
                    // A logarithmic axis has no zero.
                    let shown = if value > 0.0 { value } else { f64::NAN };
                    (table.real(row, "t_s"), shown)
                });
                // What follows a failure tells nothing, and would leave no room for the rest.
                let points: Vec<(f64, f64)> = points.filter(|(t_s, _)| t_s <= until_s).collect();
                let end = points.last().copied().filter(|_| until_s.is_finite());
                [
                    Mark::Line(points, Color::Series(index), Stroke::Solid),
                    Mark::Dots(end.into_iter().collect(), Color::Series(index)),
                ]
            });
        Plot {
            title: group.to_string(),
            x: Axis::new("time, s"),
            y,
            marks: marks.collect(),
            // Four stand side by side on a screen.
            width: Some(300.0),
            height: Some(215.0),
            ..Plot::default()
        }
    }
}

/// When the flight failed under each controller, s; infinite where it did not.
fn failures(data: &RunData, flight: &str) -> Vec<f64> {
    let of_controller = |name: &String| {
        let wanted = [("flight", flight), ("controller", name)];
        let row = data.flights.find(&wanted).next();
        let time_s = row.map(|row| data.flights.real(row, "failed_at_s"));
        time_s
            .filter(|own| own.is_finite())
            .unwrap_or(f64::INFINITY)
    };
    data.campaign
        .controllers
        .iter()
        .map(of_controller)
        .collect()
}
