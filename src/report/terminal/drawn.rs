//! The ranges of all that a campaign draws.

use crate::campaign::{AgentGroup, Campaign};
use crate::draw::quantities::Source;
use crate::report::drawn_values::drawn_values;
use crate::report::page::document::{Block, Cell, Grid, Section};
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

/// The ranges, for people.
pub(super) fn drawn(campaign: &Campaign) -> Section {
    let mut blocks = Vec::new();
    for subject in subjects(campaign) {
        let mut grid = Grid::default();
        for (name, values) in &subject.quantities {
            let Some([low, high]) = range(values) else {
                continue;
            };
            let range = if low >= high {
                format!("{low:.6}")
            } else {
                format!("{low:.6} .. {high:.6}")
            };
            let values = format!("({} values)", values.len());
            grid.rows.push(vec![
                Cell::text(name),
                Cell::text(range),
                Cell::text(values),
            ]);
        }
        if subject.title.is_empty() {
            blocks.push(Block::Grid(grid));
        } else {
            let occurs = subject.occurs.map_or(String::new(), |[with, all]| {
                let percent = 100.0 * with as f64 / all.max(1) as f64;
                format!(", in {with} of {all} agents ({percent:.1} %)")
            });
            let title = format!("{}{occurs}", subject.title);
            blocks.push(Block::Folded(title, vec![Block::Grid(grid)]));
        }
    }
    let episodes = DRAWS.min(campaign.episodes);
    Section::explained(
        format!("drawn in the first {episodes} episodes"),
        ", as applied (lowest .. highest):",
        blocks,
    )
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

/// The agents, the disturbances and the faults of each group, in the campaign's order, with what the first episodes
/// draw for them.
fn subjects(campaign: &Campaign) -> Vec<Subject> {
    let groups = campaign.groups().iter().enumerate();
    let of_group = |(index, group): (usize, &AgentGroup)| {
        let prefix = match campaign.has_named_groups() {
            true => format!("group[{index}]."),
            false => String::new(),
        };
        subjects_of(group, &prefix)
    };
    groups.flat_map(of_group).collect()
}

fn subjects_of(group: &AgentGroup, prefix: &str) -> Vec<Subject> {
    let mut all: Vec<Subject> = Vec::new();
    for drawn in drawn_values(group, 0..DRAWS.min(group.episodes)) {
        let (quantity, occurs) = (drawn.quantity, drawn.occurs);
        let [key, title] = names(group, prefix, quantity.source);
        if all.last().is_none_or(|last| last.title != title) {
            all.push(Subject {
                key,
                title,
                occurs,
                quantities: Vec::new(),
            });
        }
        let name = match quantity.source {
            Source::Control => format!("control {}", quantity.name),
            Source::Initial => format!("initial {}", quantity.name),
            _ => quantity.name.to_string(),
        };
        if let Some(subject) = all.last_mut() {
            subject.quantities.push((name, drawn.values));
        }
    }
    all
}

/// What precedes the names of a source's quantities, and what it is called.
fn names(group: &AgentGroup, prefix: &str, source: Source) -> [String; 2] {
    match source {
        Source::Agent | Source::Control | Source::Initial => match &*group.name {
            "" => [String::new(), String::new()],
            name => [format!("{name} "), name.to_string()],
        },
        Source::Disturbance(k, kind) => [
            format!("{prefix}disturbance[{k}] "),
            format!("{prefix}disturbance[{k}] {}", kind.name()),
        ],
        Source::Fault(k) => {
            let title = format!("{prefix}fault[{k}] {}", group.faults[k].name);
            [format!("{title} "), title]
        }
    }
}
