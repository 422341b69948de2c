//! The ranges of all that a campaign draws.

use super::text::line;
use crate::agent::Agent;
use crate::campaign::Campaign;
use crate::draw::draw;
use serde_json::{Value, json};

/// Episodes that are drawn to show real ranges.
const DRAWS: u32 = 200;

/// Something with quantities of its own: the agents, a disturbance or a fault.
struct Subject {
    /// What precedes the names of its quantities; empty for the agents.
    key: String,
    /// What it is called.
    title: String,
    /// Of a fault: how many agents of how many have it.
    occurs: Option<[usize; 2]>,
    /// Its quantities with all values, in the order of the file's keys.
    quantities: Vec<(String, Vec<f64>)>,
}

impl Subject {
    fn add(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        match self.quantities.iter_mut().find(|(own, _)| own == name) {
            Some((_, all)) => all.extend(values),
            None => {
                let values = values.into_iter().collect();
                self.quantities.push((name.to_string(), values));
            }
        }
    }
}

/// The ranges, for people.
pub(super) fn drawn(campaign: &Campaign) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "  drawn in the first {} episodes, as applied (lowest .. highest):",
            DRAWS.min(campaign.episodes)
        ),
    );
    for subject in subjects(campaign) {
        let indent = if subject.title.is_empty() {
            "    "
        } else {
            let occurs = subject.occurs.map_or(String::new(), |[with, all]| {
                let percent = 100.0 * with as f64 / all.max(1) as f64;
                format!(", in {with} of {all} agents ({percent:.1} %)")
            });
            line(&mut text, &format!("    {}{occurs}", subject.title));
            "      "
        };
        for (name, values) in &subject.quantities {
            let Some([low, high]) = range(values) else {
                continue;
            };
            let range = if low >= high {
                format!("{low:.6}")
            } else {
                format!("{low:.6} .. {high:.6}")
            };
            line(
                &mut text,
                &format!("{indent}{name:<24} {range}   ({} values)", values.len()),
            );
        }
    }
    text
}

/// The ranges, for programs: one after the other, and of each fault the share of the agents that have it.
pub(super) fn drawn_json(campaign: &Campaign) -> Value {
    let mut rows = Vec::new();
    for Subject {
        key,
        occurs,
        quantities,
        ..
    } in subjects(campaign)
    {
        if let Some([with, all]) = occurs {
            let share = with as f64 / all.max(1) as f64;
            rows.push(json!({ "name": format!("{key}occurs"), "share": share, "values": all }));
        }
        for (name, values) in quantities {
            if let Some([low, high]) = range(&values) {
                rows.push(json!({
                    "name": format!("{key}{name}"), "lowest": low, "highest": high, "values": values.len(),
                }));
            }
        }
    }
    rows.into()
}

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (!values.is_empty()).then_some([low, high])
}

/// The agents, the disturbances and the faults, in the campaign's order, with what the first episodes draw for them.
fn subjects(campaign: &Campaign) -> Vec<Subject> {
    let subject = |key: String, title: String, occurs| Subject {
        key,
        title,
        occurs,
        quantities: Vec::new(),
    };
    let mut agents = subject(String::new(), String::new(), None);
    let of_disturbance = |(k, kind)| {
        let title = format!("disturbance[{k}] {kind}");
        subject(format!("disturbance[{k}] "), title, None)
    };
    let kinds = campaign.disturbances.iter().map(|own| own.kind.name());
    let mut disturbances: Vec<Subject> = kinds.enumerate().map(of_disturbance).collect();
    let of_fault = |(k, name)| {
        let title = format!("fault[{k}] {name}");
        subject(format!("{title} "), title, Some([0, 0]))
    };
    let names = campaign.faults.iter().map(|own| &own.name);
    let mut faults: Vec<Subject> = names.enumerate().map(of_fault).collect();

    let episodes = 0..DRAWS.min(campaign.episodes);
    let applied = |episode| draw(campaign, episode).applied(campaign);
    for draws in episodes.flat_map(|episode| applied(episode).agents) {
        agents.add("mass_scale", [draws.mass_scale]);
        if let Agent::Uav(_) = campaign.agent {
            agents.add("inertia_scale", [draws.inertia_scale]);
        }
        agents.add("kappa", [draws.kappa]);
        if campaign.control.delay_s.is_some() {
            agents.add("control delay_s", [draws.control_delay_s]);
        }
        agents.add("initial error", draws.error);
        agents.add("initial error_rate", draws.error_rate);
        agents.add("initial error_integral", draws.error_integral);
        let own = campaign.disturbances.iter().zip(draws.disturbances);
        for (subject, (disturbance, values)) in disturbances.iter_mut().zip(own) {
            for (parameter, values) in disturbance.kind.parameters().iter().zip(values) {
                subject.add(parameter.name, values);
            }
        }
        let own = campaign.faults.iter().zip(draws.faults);
        for (subject, (fault, draw)) in faults.iter_mut().zip(own) {
            let there = draw.occurs();
            subject.occurs = subject
                .occurs
                .map(|[with, all]| [with + usize::from(there), all + 1]);
            let of_time = |value: f64| there.then_some(value);
            subject.add("onset_s", of_time(draw.onset_s));
            if fault.duration_s.is_some() {
                subject.add("duration_s", of_time(draw.duration_s));
            }
            if fault.ramp_s.is_some() {
                subject.add("ramp_s", of_time(draw.ramp_s));
            }
            for (parameter, values) in fault.kind.parameters().iter().zip(draw.parameters) {
                let struck = values.into_iter().zip(&draw.strikes);
                let struck = struck.filter(|(_, strikes)| **strikes);
                subject.add(parameter.name, struck.map(|(value, _)| value));
            }
        }
    }
    let mut all = vec![agents];
    all.append(&mut disturbances);
    all.append(&mut faults);
    all
}
