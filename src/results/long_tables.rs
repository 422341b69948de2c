//! What was drawn, a row for each fault that somebody had and one for each number: the same as in the wide columns of
//! the table of episodes, for programs that join, filter and plot by name.

use super::dictionary::unit_of_parameter;
use super::table::{Row, Table};
use crate::campaign::{AgentGroup, Campaign, Parameter};
use crate::draw::quantities::{Quantity, Source};
use crate::draw::{AgentDraw, AppliedEpisode, FaultDraw};
use std::collections::BTreeMap;

/// The agent of an episode that a row is about.
fn key(row: &mut Row<'_>, campaign: &Campaign, group: &AgentGroup, episode: u32, place: usize) {
    row.count(|| "episode".into(), u64::from(episode));
    if campaign.has_named_groups() {
        row.name(|| "group".into(), group.name.clone());
    }
    row.count(|| "agent".into(), (group.first_agent + place) as u64);
}

/// Adds the faults that the agents of a group have in an episode.
pub(super) fn add_faults(
    table: &mut Table,
    campaign: &Campaign,
    group: &AgentGroup,
    applied: &AppliedEpisode,
) {
    for (place, draw) in applied.agents.iter().enumerate() {
        let faults = group.faults.iter().zip(&draw.faults);
        for (fault, drawn) in faults.filter(|(_, drawn)| drawn.occurs()) {
            let struck = group.channels().iter().zip(&drawn.strikes);
            let struck: Vec<&str> = struck
                .filter(|(_, strikes)| **strikes)
                .map(|(name, _)| &**name)
                .collect();
            let mut row = table.row();
            key(&mut row, campaign, group, applied.index, place);
            row.name(|| "fault".into(), fault.name.clone())
                .word(|| "target".into(), fault.target.name())
                .word(|| "kind".into(), fault.kind.name())
                .name(|| "channels".into(), struck.join(" ").into())
                .real(|| "onset_s".into(), drawn.onset_s)
                .real(|| "duration_s".into(), finite(drawn.duration_s))
                .real(|| "ramp_s".into(), drawn.ramp_s)
                .name(
                    || "parameters".into(),
                    parameters(group, fault.kind.parameters(), drawn).into(),
                );
        }
    }
}

/// A length of time, or "does not apply" if it lasts to the end.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// The parameters of a fault as JSON, by name and then by channel that it strikes; empty of a kind that has none.
fn parameters(group: &AgentGroup, named: &[Parameter], drawn: &FaultDraw) -> String {
    let of_parameter = |(parameter, values): (&Parameter, &Vec<f64>)| {
        let channels = group.channels().iter().zip(values).zip(&drawn.strikes);
        let struck = channels.filter(|(_, strikes)| **strikes);
        let by_channel: BTreeMap<&str, f64> =
            struck.map(|((name, value), _)| (&**name, *value)).collect();
        (parameter.name, by_channel)
    };
    let all: BTreeMap<_, _> = named
        .iter()
        .zip(&drawn.parameters)
        .map(of_parameter)
        .collect();
    if all.is_empty() {
        return String::new();
    }
    serde_json::to_string(&all).unwrap_or_default()
}

/// Adds every number that was drawn for the agents of a group in an episode and applies there.
pub(super) fn add_conditions(
    table: &mut Table,
    campaign: &Campaign,
    group: &AgentGroup,
    quantities: &[Quantity],
    applied: &AppliedEpisode,
) {
    for (place, draw) in applied.agents.iter().enumerate() {
        for quantity in quantities {
            let source = source(group, quantity.source);
            for (channel, value) in values(quantity, draw) {
                let unit = unit_of_parameter(quantity, group, channel.unwrap_or_default());
                let name = channel.map(|channel| group.channels()[channel].clone());
                let mut row = table.row();
                key(&mut row, campaign, group, applied.index, place);
                row.name(|| "source".into(), source.as_str().into())
                    .word(|| "quantity".into(), quantity.name)
                    .name(|| "channel".into(), name.unwrap_or_default())
                    .real(|| "value".into(), finite(value))
                    .name(|| "unit".into(), unit.into());
            }
        }
    }
}

/// The values of a quantity that apply, each with its channel where it is one of channels.
fn values(quantity: &Quantity, draw: &AgentDraw) -> impl Iterator<Item = (Option<usize>, f64)> {
    let of_channels = quantity.is_of_channels();
    let applied: Vec<(usize, f64)> = quantity.applied(draw).collect();
    applied
        .into_iter()
        .map(move |(channel, value)| (of_channels.then_some(channel), value))
}

/// What a quantity belongs to, by name.
fn source(group: &AgentGroup, source: Source) -> String {
    match source {
        Source::Agent => "agent".to_string(),
        Source::Control => "control".to_string(),
        Source::Initial => "initial".to_string(),
        Source::Disturbance(index, kind) => {
            let number = group.first_disturbance + index;
            format!("disturbance {number} ({})", kind.name())
        }
        Source::Fault(index) => group.titled(&group.faults[index].name),
    }
}
