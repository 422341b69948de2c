//! Where UAVs flew, from above and from the side (the paper's Figure 8).

use super::episode_data::{ControllerTrace, EpisodeView};
use super::frame::Frame;
use crate::campaign::AgentGroup;
use crate::model::ChannelSample;
use crate::report::page::document::{Block, Figure, LegendEntry, Section};
use crate::report::page::plot::{Axis, Color, Mark, Plot, SIZE, Stroke};
use crate::util::format::sentence;

/// Room around the values that are no peaks, in units of their range.
const ROOM: f64 = 0.2;
/// Points of a path.
const POINTS: usize = 400;
/// What the axes of a view show: x and y, x and z.
const VIEWS: [(&str, [usize; 2], [&str; 2]); 2] = [
    ("from above", [0, 1], ["x, m", "y, m"]),
    ("from the side", [0, 2], ["x, m", "z, m"]),
];

/// The paths of a group under every controller.
pub(super) fn section(view: &EpisodeView<'_>, group: &AgentGroup) -> Section {
    let mut cut = false;
    let frames = [0, 1, 2].map(|coordinate| frame(view, group, coordinate));
    let mut panels = Vec::new();
    for (side, channels, labels) in VIEWS {
        let [Some(across), Some(up)] = channels.map(|channel| frames[channel]) else {
            continue;
        };
        cut |= across.cut || up.cut;
        for trace in &view.traces {
            let shown = (side, channels, labels);
            panels.push(panel(view, group, trace, shown, [across, up]));
        }
    }
    let mut legend = vec![LegendEntry::dashes(Color::Truth, "reference")];
    legend.extend(
        view.traces
            .iter()
            .map(|trace| LegendEntry::line(trace.color(), trace.name)),
    );
    let mut caption = format!(
        "Paths of all {}; a dot is where one begins.",
        group.agent.plural()
    );
    if cut {
        caption.push_str(" Paths that run away leave the frame.");
    }
    let figure = Figure {
        panels,
        legend,
        caption,
    };
    Section::new(
        sentence(&group.titled("paths")).trim_end_matches('.'),
        vec![Block::Figure(figure)],
    )
}

/// The frame of a coordinate: of all references and of all episodes until they diverged.
fn frame(view: &EpisodeView<'_>, group: &AgentGroup, channel: usize) -> Option<Frame> {
    let mut values = Vec::new();
    let agents = EpisodeView::agents_of(group);
    for trace in &view.traces {
        for agent in agents.clone() {
            let until_s = view.until_s(trace, agent);
            let picks: [fn(&ChannelSample) -> f64; 2] = [|shown| shown.r, |shown| shown.x];
            for pick in picks {
                let curve = view.curve(trace, (agent, channel), pick).into_iter();
                let before = curve.filter(|&(t_s, _)| t_s <= until_s);
                values.extend(before.map(|(_, value)| value));
            }
        }
    }
    let mut frame = Frame::of(values, ROOM)?;
    let mut outcomes = view
        .traces
        .iter()
        .flat_map(|trace| &trace.outcomes[agents.clone()]);
    frame.cut |= outcomes.any(|outcome| outcome.diverged);
    Some(frame)
}

fn panel(
    view: &EpisodeView<'_>,
    group: &AgentGroup,
    trace: &ControllerTrace<'_>,
    (side, channels, labels): (&str, [usize; 2], [&str; 2]),
    frames: [Frame; 2],
) -> Plot {
    let path = |agent: usize, pick: fn(&ChannelSample) -> f64, until_s: f64| -> Vec<(f64, f64)> {
        let [x, y] = channels.map(|channel| {
            let mut curve = view.curve(trace, (agent, channel), pick);
            curve.retain(|&(t_s, _)| t_s <= until_s);
            curve
        });
        let points = x.into_iter().zip(y).map(|((_, x), (_, y))| (x, y));
        let near = |(x, y): (f64, f64)| match frames[0].is_near(x) && frames[1].is_near(y) {
            true => (x, y),
            false => (f64::NAN, f64::NAN),
        };
        let mut points: Vec<(f64, f64)> = points.map(near).collect();
        let gone = |k: usize| points.get(k).is_some_and(|point| point.0.is_nan());
        points.truncate(view.shown(trace, agent, gone));
        points
            .chunks(points.len().div_ceil(POINTS).max(1))
            .filter_map(|stretch| stretch.first().copied())
            .chain(points.last().copied())
            .collect()
    };
    let mut marks = Vec::new();
    for agent in EpisodeView::agents_of(group) {
        let simulated = path(agent, |shown| shown.x, f64::INFINITY);
        let first = simulated.first().copied();
        marks.push(Mark::Line(simulated, trace.color(), Stroke::Solid));
        let reference = path(agent, |shown| shown.r, view.left_s(trace, agent));
        marks.push(Mark::Line(reference, Color::Truth, Stroke::Dashed));
        marks.push(Mark::Dots(first.into_iter().collect(), trace.color()));
    }
    let [x, y] = [0, 1].map(|k| Axis {
        range: Some(frames[k].range()),
        ..Axis::new(labels[k])
    });
    Plot {
        title: format!("{}, {side}", trace.name),
        x,
        y,
        marks,
        equal: true,
        height: Some(height(
            frames[0].high - frames[0].low,
            frames[1].high - frames[1].low,
        )),
        ..Plot::default()
    }
}

/// Height of a panel in which a unit is as long along x as along y, px: not much of it is left empty.
pub(super) fn height(across: f64, up: f64) -> f64 {
    // Width of the axes, and what title and labels take of the height.
    (290.0 * up / across + 95.0).clamp(SIZE.1, 1.7 * SIZE.1)
}
