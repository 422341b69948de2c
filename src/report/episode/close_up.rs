//! How a flight was lost: the errors of the agent that failed first, from the onset of its last fault to its failure.

use super::episode_data::EpisodeView;
use crate::report::page::document::{Block, Figure, LegendEntry, Section};
use crate::report::page::plot::{Axis, Mark, Plot, Stroke};

/// How much is shown where no fault struck before the failure, s, and at least.
const WITHOUT_FAULT_S: f64 = 1.0;
const AT_LEAST_S: f64 = 0.1;
/// Room before the onset and after the failure, in lengths of what lies between.
const ROOM: f64 = 0.1;

/// The errors of all controllers in that time; none if nothing diverged under the controller that was asked for.
pub(super) fn section(view: &EpisodeView<'_>) -> Option<Section> {
    let asked = view.asked();
    let diverged = (0..view.campaign.agents()).filter(|&agent| asked.outcomes[agent].diverged);
    let failed = diverged.filter_map(|agent| Some((agent, view.failed_at_s(asked, agent)?)));
    let (agent, failed_s) = failed.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let onsets = view.draw(agent).faults.iter();
    let onsets = onsets.filter(|fault| fault.occurs());
    let onsets = onsets.map(|fault| view.window(fault).0);
    let onset_s = onsets
        .filter(|onset_s| *onset_s < failed_s)
        .reduce(f64::max);
    let from_s = onset_s.unwrap_or(failed_s - WITHOUT_FAULT_S);
    let from_s = from_s.min(failed_s - AT_LEAST_S);
    let room_s = ROOM * (failed_s - from_s);
    let range = ((from_s - room_s).max(0.0), failed_s + room_s);
    let what = match onset_s {
        Some(onset_s) => format!("from the onset of its last fault at {onset_s:.3} s"),
        None => "before any fault".to_string(),
    };
    let figure = Figure {
        panels: panels(view, agent, range),
        legend: view
            .traces
            .iter()
            .map(|trace| LegendEntry::line(trace.color(), trace.name))
            .collect(),
        caption: format!(
            "Tracking error of agent {agent} {what} to its failure under {} at {failed_s:.3} s. Curves end where the \
             controller of their colour has failed, or leave the frame at the limit.",
            asked.name
        ),
    };
    Some(Section::new("How it was lost", vec![Block::Figure(figure)]))
}

fn panels(view: &EpisodeView<'_>, agent: usize, range: (f64, f64)) -> Vec<Plot> {
    let group = view.group(agent);
    let names = group.channels().iter().enumerate();
    let panel = |(channel, name): (usize, &std::sync::Arc<str>)| {
        let limit = group.verdict.max_error[channel];
        let curves: Vec<_> = view
            .traces
            .iter()
            .rev()
            .map(|trace| {
                let until_s = view.until_s(trace, agent).min(range.1);
                let mut curve = view.curve(trace, (agent, channel), |shown| shown.e);
                curve.retain(|(t_s, _)| (range.0..=until_s).contains(t_s));
                (curve, trace.color())
            })
            .collect();
        let values = curves.iter().flat_map(|(curve, _)| curve);
        let values = values.map(|(_, value)| value.clamp(-limit, limit));
        let values = values.filter(|value| value.is_finite());
        let (low, high) = values.fold((0.0, 0.0), |(low, high), own| {
            (f64::min(low, own), f64::max(high, own))
        });
        let room = (0.08 * (high - low)).max(1e-9);
        let marks = curves
            .into_iter()
            .map(|(curve, color)| Mark::Line(curve, color, Stroke::Solid));
        Plot {
            title: name.to_string(),
            x: Axis {
                range: Some(range),
                ..Axis::new("time, s")
            },
            y: Axis {
                range: Some((low - room, high + room)),
                ..Axis::new(format!("e, {}", group.unit(channel)))
            },
            marks: marks.collect(),
            spans: view.windows(agent, channel),
            ..Plot::default()
        }
    };
    names.map(panel).collect()
}
