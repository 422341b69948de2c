//! Whether two runs met the same: only then can their episodes be compared pair by pair.

use crate::campaign::{AgentGroup, Campaign};
use crate::draw::quantities::quantities;
use crate::run::table_reader::TableReader;
use std::fmt::Debug;

/// In what two campaigns differ that decides what an episode meets and how it is judged, each in a few words: all but
/// the controllers, their gains, and what is required of them.
pub(super) fn of_campaigns(a: &Campaign, b: &Campaign) -> Vec<String> {
    let mut found = Differences::default();
    found.shown("seed", &a.seed, &b.seed);
    found.shown("time.step_s", &a.time.step_s, &b.time.step_s);
    found.shown("steps of an episode", &a.time.steps, &b.time.steps);
    found.shown(
        "time.settle_s in steps",
        &a.time.settle_step,
        &b.time.settle_step,
    );
    found.named("strata", &a.strata, &b.strata);
    found.named("sampling", &a.sampling, &b.sampling);
    // What a design draws belongs to the number of episodes that was asked for.
    if a.sampling.replicates().is_some() {
        found.shown("episodes", &a.episodes, &b.episodes);
    }
    found.shown("groups of agents", &a.groups().len(), &b.groups().len());
    for (a, b) in a.groups().iter().zip(b.groups()) {
        of_groups(&mut found, a, b);
    }
    found.0
}

fn of_groups(found: &mut Differences, a: &AgentGroup, b: &AgentGroup) {
    let key = |name: &str| a.titled(name);
    found.shown("name of a group", &a.name, &b.name);
    found.shown(&key("agent.team"), &a.team, &b.team);
    found.named(&key("agent"), &a.agent, &b.agent);
    found.named(&key("reference"), &a.reference, &b.reference);
    found.named(&key("plant.mass_scale"), &a.mass_scale, &b.mass_scale);
    found.named(
        &key("plant.inertia_scale"),
        &a.inertia_scale,
        &b.inertia_scale,
    );
    found.named(
        &key("coupling"),
        &(&a.kappa, a.coordinates),
        &(&b.kappa, b.coordinates),
    );
    found.named(&key("control"), &a.control, &b.control);
    found.named(&key("initial"), &a.initial, &b.initial);
    let [ours, theirs] = [a, b].map(|group| (group.disturbances.len(), group.faults.len()));
    found.shown(&key("disturbances and faults"), &ours, &theirs);
    for (index, (a, b)) in a.disturbances.iter().zip(&b.disturbances).enumerate() {
        found.named(&key(&format!("disturbance[{index}]")), a, b);
    }
    for (index, (a, b)) in a.faults.iter().zip(&b.faults).enumerate() {
        found.named(&key(&format!("fault[{index}]")), a, b);
    }
    let (ours, theirs) = (&a.verdict, &b.verdict);
    found.shown(
        &key("verdict.max_error"),
        &ours.max_error,
        &theirs.max_error,
    );
    found.shown(&key("verdict.max_rmse"), &ours.max_rmse, &theirs.max_rmse);
    found.shown(
        &key("verdict.settled_error"),
        &ours.settled_error,
        &theirs.settled_error,
    );
}

#[derive(Default)]
struct Differences(Vec<String>);

impl Differences {
    /// Two values that are short enough to be shown.
    fn shown<T: PartialEq + Debug>(&mut self, name: &str, a: &T, b: &T) {
        if a != b {
            self.0.push(format!("{name}: {a:?} and {b:?}"));
        }
    }

    /// Two parts of the campaigns.
    fn named<T: PartialEq>(&mut self, name: &str, a: &T, b: &T) {
        if a != b {
            self.0.push(name.to_string());
        }
    }
}

/// A table of episodes with its campaign, whose controllers decide where a row is.
pub(super) type Drawn<'a> = (&'a Campaign, &'a TableReader);

/// The first difference in what the tables of two runs say was drawn for the first episodes: versions of the program
/// may draw other numbers of the same campaign.
pub(super) fn of_tables(a: Drawn<'_>, b: Drawn<'_>, episodes: usize) -> Option<String> {
    let campaign = a.0;
    let columns = |(campaign, table): Drawn<'_>| {
        let own = table.names().iter();
        let drawn = own.filter(|name| is_drawn(campaign, name));
        drawn.cloned().collect::<Vec<String>>()
    };
    let [ours, theirs] = [a, b].map(columns);
    if ours != theirs {
        let other = |own: &[String], others: &[String]| {
            own.iter().find(|name| !others.contains(name)).cloned()
        };
        let only = other(&ours, &theirs).or(other(&theirs, &ours));
        let only = only.unwrap_or_else(|| "their order".to_string());
        return Some(format!("the columns of episodes.parquet ({only})"));
    }
    let agents = campaign.agents();
    for episode in 0..episodes {
        for agent in 0..agents {
            let row =
                |(campaign, _): Drawn<'_>| episode * campaign.controllers.len() * agents + agent;
            let of = |own: Drawn<'_>, name: &str| {
                let (table, row) = (own.1, row(own));
                (table.real(row, name), table.text(row, name).to_string())
            };
            for name in &ours {
                let ((x, x_text), (y, y_text)) = (of(a, name), of(b, name));
                if x.to_bits() != y.to_bits() && !(x.is_nan() && y.is_nan()) {
                    return Some(format!(
                        "{name} of agent {agent} in episode {episode}: {x} and {y}"
                    ));
                }
                if x_text != y_text {
                    return Some(format!(
                        "{name} of agent {agent} in episode {episode}: {x_text:?} and {y_text:?}"
                    ));
                }
            }
        }
    }
    None
}

/// Whether a column says what was drawn.
fn is_drawn(campaign: &Campaign, name: &str) -> bool {
    let mut keys = campaign.groups().iter().flat_map(quantities);
    let of_quantity = |key: &str| {
        let rest = name.strip_prefix(key);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    let of_fault = |number| of_quantity(&format!("fault{number}"));
    keys.any(|quantity| of_quantity(&quantity.key)) || (0..campaign.faults().count()).any(of_fault)
}
