//! What a channel showed over time: errors, states, faults, commands (the paper's Figures 11 to 20).

use super::episode_data::{ControllerTrace, EpisodeView};
use super::frame::Frame;
use crate::agent::{ActuationKind, Agent, FIRST_ATTITUDE};
use crate::campaign::AgentGroup;
use crate::model::ChannelSample;
use crate::report::page::document::{Figure, LegendEntry};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::util::format::sentence;

/// Room around the values that are no peaks, in units of their range.
const ROOM: f64 = 0.6;

/// What is shown of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Error,
    State,
    ActuatorFault,
    SensorFault,
    Command,
}

impl Quantity {
    pub(super) const ALL: [Self; 5] = [
        Self::Error,
        Self::State,
        Self::ActuatorFault,
        Self::SensorFault,
        Self::Command,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Error => "tracking error e",
            Self::State => "state",
            Self::ActuatorFault => "actuator fault f1",
            Self::SensorFault => "sensor fault f2",
            Self::Command => "command u",
        }
    }

    fn symbol(self) -> &'static str {
        match self {
            Self::Error => "e",
            // Not x: that is the name of a channel.
            Self::State => "state",
            Self::ActuatorFault => "f1",
            Self::SensorFault => "f2",
            Self::Command => "u",
        }
    }

    /// The unit in a channel of m or rad.
    fn unit(self, of_channel: &'static str, robot: bool) -> &'static str {
        match (self, of_channel) {
            (Self::Error | Self::State, unit) => unit,
            (Self::ActuatorFault, "m") => "m/s²",
            (Self::ActuatorFault, _) => "rad/s²",
            (Self::SensorFault, "m") => "m/s",
            (Self::SensorFault, _) => "rad/s",
            (Self::Command, "m") if !robot => "N",
            (Self::Command, _) => "N m",
        }
    }

    /// What each controller made of it.
    fn simulated(self) -> fn(&ChannelSample) -> f64 {
        match self {
            Self::Error => |shown| shown.e,
            Self::State => |shown| shown.x,
            Self::ActuatorFault => |shown| shown.f1_hat,
            Self::SensorFault => |shown| shown.f2_hat,
            Self::Command => |shown| shown.u,
        }
    }

    /// What the episode is compared with.
    fn truth(self) -> Option<fn(&ChannelSample) -> f64> {
        match self {
            Self::State => Some(|shown| shown.r),
            Self::ActuatorFault => Some(|shown| shown.f1),
            Self::SensorFault => Some(|shown| shown.f2),
            Self::Error | Self::Command => None,
        }
    }

    /// What the controller took it for.
    fn estimate(self) -> Option<fn(&ChannelSample) -> f64> {
        match self {
            Self::Error => Some(|shown| shown.e_hat),
            Self::State => Some(|shown| shown.r + shown.e_hat),
            Self::ActuatorFault | Self::SensorFault | Self::Command => None,
        }
    }

    /// Whether what is simulated is an estimate, which not every controller makes.
    fn is_fault(self) -> bool {
        matches!(self, Self::ActuatorFault | Self::SensorFault)
    }
}

/// A channel's quantity under one or several controllers. The frame is the same whichever are shown.
pub(super) fn panel(
    view: &EpisodeView<'_>,
    quantity: Quantity,
    at: (usize, usize),
    shown: &[ControllerTrace<'_>],
) -> (Plot, bool) {
    let (agent, channel) = at;
    let frame = frame(view, quantity, at);
    let mut marks = Vec::new();
    let mut draw = |trace: &ControllerTrace<'_>,
                    pick: fn(&ChannelSample) -> f64,
                    color: Color,
                    stroke: Stroke| {
        let Some(frame) = frame else {
            return;
        };
        let mut curve = view.curve(trace, at, pick);
        if color == Color::Truth && quantity == Quantity::State {
            let left_s = view.left_s(trace, agent);
            curve.retain(|&(t_s, _)| t_s < left_s);
        }
        let shown = view.shown(trace, agent, |k| {
            curve.get(k).is_some_and(|point| !frame.is_near(point.1))
        });
        let near = curve
            .iter()
            .take(shown)
            .map(|&(t_s, value)| (t_s, frame.near(value)));
        let near: Vec<(f64, f64)> = near.collect();
        marks.push(Mark::Line(
            EpisodeView::thin(&near, frame.fine()),
            color,
            stroke,
        ));
    };
    let truth_stroke = match quantity {
        Quantity::State => Stroke::Dashed,
        _ => Stroke::Solid,
    };
    if let (Some(truth), Some(first)) = (quantity.truth(), shown.first()) {
        draw(first, truth, Color::Truth, truth_stroke);
    }
    // The first is drawn last, above the others.
    for trace in shown.iter().rev() {
        let curve = view.curve(trace, at, quantity.simulated());
        if quantity.is_fault() && curve.iter().all(|(_, value)| *value == 0.0) {
            continue;
        }
        draw(trace, quantity.simulated(), trace.color(), Stroke::Solid);
    }
    if let (Some(estimate), Some(first)) = (quantity.estimate(), shown.first()) {
        draw(first, estimate, view.estimate_color(), Stroke::Dashed);
    }
    let group = view.group(agent);
    let robot = matches!(group.agent, Agent::Biped(_));
    let unit = quantity.unit(group.unit(channel), robot);
    let failed = shown.iter().filter_map(|trace| {
        let t_s = view.failed_at_s(trace, agent)?;
        Some((t_s, trace.color()))
    });
    let name = &group.channels()[channel];
    let panel = Plot {
        title: name.to_string(),
        x: Axis {
            range: Some((0.0, view.duration_s)),
            ..Axis::new("time, s")
        },
        y: Axis {
            range: frame.map(|frame| frame.range()),
            ..Axis::new(format!("{}, {unit}", quantity.symbol()))
        },
        marks,
        spans: view.windows(agent, channel),
        levels: limits(group, quantity, channel),
        moments: failed.collect(),
        ..Plot::default()
    };
    (panel, frame.is_some_and(|frame| frame.cut))
}

/// The frame of a channel's quantity: what every trace shows of it, and its limits.
fn frame(view: &EpisodeView<'_>, quantity: Quantity, at: (usize, usize)) -> Option<Frame> {
    let mut values = Vec::new();
    for trace in &view.traces {
        let until_s = view.until_s(trace, at.0);
        let picks = [
            quantity.truth(),
            quantity.estimate(),
            Some(quantity.simulated()),
        ];
        for pick in picks.into_iter().flatten() {
            let curve = view.curve(trace, at, pick).into_iter();
            let before = curve.filter(|&(t_s, _)| t_s <= until_s);
            values.extend(before.map(|(_, value)| value));
        }
    }
    let mut frame = Frame::of(values, ROOM)?;
    frame.cut |= view
        .traces
        .iter()
        .any(|trace| trace.outcomes[at.0].diverged);
    Some(frame.with(&limits(view.group(at.0), quantity, at.1)))
}

/// The limits of a command, where they cut.
fn limits(group: &AgentGroup, quantity: Quantity, channel: usize) -> Vec<f64> {
    let both = |limit: f64| vec![-limit, limit];
    match (&group.agent, quantity) {
        (_, quantity) if quantity != Quantity::Command => Vec::new(),
        (Agent::Uav(uav), _) if uav.actuation == ActuationKind::Thrust => match channel {
            FIRST_ATTITUDE.. => both(uav.max_torque_n_m),
            // The force demanded has no limit of its own: the thrust has, which is along the body axis.
            _ => Vec::new(),
        },
        (Agent::Biped(biped), _) if biped.actuation == ActuationKind::Limited => {
            let joint = biped.robot.joints().nth(channel);
            joint.map_or(Vec::new(), |joint| both(joint.torque_max_n_m))
        }
        _ => Vec::new(),
    }
}

/// An agent's quantity, a panel for each channel.
pub(super) fn figure(view: &EpisodeView<'_>, quantity: Quantity, agent: usize) -> Figure {
    let channels = 0..view.group(agent).channels().len();
    let drawn: Vec<(Plot, bool)> = channels
        .map(|channel| panel(view, quantity, (agent, channel), &view.traces))
        .collect();
    let cut = drawn.iter().any(|(_, cut)| *cut);
    let failed = drawn.iter().any(|(panel, _)| !panel.moments.is_empty());
    Figure {
        legend: legend(view, quantity, agent, &drawn),
        caption: caption(view.group(agent), quantity, failed, cut),
        panels: drawn.into_iter().map(|(panel, _)| panel).collect(),
    }
}

/// What the curves of a figure are.
fn legend(
    view: &EpisodeView<'_>,
    quantity: Quantity,
    agent: usize,
    drawn: &[(Plot, bool)],
) -> Vec<LegendEntry> {
    let asked = view.asked();
    let mut legend = Vec::new();
    match quantity {
        Quantity::State => legend.push(LegendEntry::dashes(Color::Truth, "reference r")),
        Quantity::ActuatorFault | Quantity::SensorFault => {
            legend.push(LegendEntry::line(
                Color::Truth,
                format!("{} under {}", quantity.symbol(), asked.name),
            ));
        }
        Quantity::Error | Quantity::Command => {}
    }
    for trace in &view.traces {
        let estimates = (0..view.group(agent).channels().len()).any(|channel| {
            let curve = view.curve(trace, (agent, channel), quantity.simulated());
            curve.iter().any(|(_, value)| *value != 0.0)
        });
        match quantity.is_fault() {
            true if estimates => {
                legend.push(LegendEntry::line(
                    trace.color(),
                    format!("estimate of {}", trace.name),
                ));
            }
            true => {}
            false => legend.push(LegendEntry::line(trace.color(), trace.name)),
        }
    }
    if quantity.estimate().is_some() {
        let text = format!("estimate of {}", asked.name);
        legend.push(LegendEntry::dashes(view.estimate_color(), text));
    }
    if drawn.iter().any(|(panel, _)| !panel.spans.is_empty()) {
        legend.push(LegendEntry::shade(
            Color::Fault,
            "a fault strikes the channel",
        ));
    }
    if drawn.iter().any(|(panel, _)| !panel.levels.is_empty()) {
        legend.push(LegendEntry::line(Color::Limit, "limit"));
    }
    legend
}

/// What a figure shows; `failed` is whether an episode failed, `cut` whether a curve leaves its frame.
fn caption(group: &AgentGroup, quantity: Quantity, failed: bool, cut: bool) -> String {
    let mut caption = sentence(quantity.name());
    let mut add = |sentence: &str| {
        caption.push(' ');
        caption.push_str(sentence);
    };
    match quantity {
        Quantity::ActuatorFault => add(
            "f1 lumps everything that the feedforward does not cancel: faults, disturbances, coupling, model errors.",
        ),
        Quantity::SensorFault => add("f2 is what the rate is measured too large by."),
        Quantity::Command if !group.is_limited() => {
            add("The command that acts, after faults; no limit cuts it in this campaign.");
        }
        Quantity::Command => {
            add("The command that acts, after limits and faults.");
            if group.agent.actuation() == ActuationKind::Thrust {
                add(
                    "x, y and z are the force demanded, of which the thrust along the body axis gives what it can.",
                );
            }
        }
        Quantity::Error | Quantity::State => {}
    }
    if failed {
        add("The line down marks the time at which the controller of its colour failed.");
    }
    if cut {
        add("Peaks and curves that run away leave the frame.");
    }
    caption
}
