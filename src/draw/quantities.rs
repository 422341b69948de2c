//! The quantities that a campaign draws: the one list that tables, rankings, `check` and pages go through.
//!
//! Disturbances and faults are numbered through all groups of a campaign in the keys of the tables, and within their
//! group everywhere else.

use super::{AgentDraw, AppliedEpisode};
use crate::agent::Agent;
use crate::campaign::{AgentGroup, Campaign, DisturbanceKind};
use crate::statistics::root_mean_square;

/// What a quantity belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The agent.
    Agent,
    /// What is between measurement and command.
    Control,
    /// The start of an episode.
    Initial,
    /// A disturbance, by its place in the group.
    Disturbance(usize, DisturbanceKind),
    /// A fault, by its place in the group.
    Fault(usize),
}

/// A quantity that is drawn for every agent, or for each of its channels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quantity {
    /// What it belongs to.
    pub source: Source,
    /// Its name there, which is its key in the campaign file.
    pub name: &'static str,
    /// Its name in tables: `fault0_onset_s`; a quantity of channels has a column `fault0_magnitude_x` of each.
    pub key: String,
    place: Place,
}

/// Where a draw keeps a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    MassScale,
    InertiaScale,
    Kappa,
    ControlDelay,
    Error,
    ErrorRate,
    ErrorIntegral,
    Onset,
    Duration,
    Ramp,
    /// A parameter of a disturbance or fault, in the order of its kind.
    Parameter(usize),
}

/// All quantities of a group of agents, in the order of the tables.
#[must_use]
pub fn quantities(group: &AgentGroup) -> Vec<Quantity> {
    let mut all = Vec::new();
    let mut add = |source, name, place| all.push(Quantity::new(group, source, name, place));
    add(Source::Agent, "mass_scale", Place::MassScale);
    if let Agent::Uav(_) = group.agent {
        add(Source::Agent, "inertia_scale", Place::InertiaScale);
    }
    add(Source::Agent, "kappa", Place::Kappa);
    if group.control.delay_s.is_some() {
        add(Source::Control, "delay_s", Place::ControlDelay);
    }
    add(Source::Initial, "error", Place::Error);
    add(Source::Initial, "error_rate", Place::ErrorRate);
    add(Source::Initial, "error_integral", Place::ErrorIntegral);
    for (index, disturbance) in group.disturbances.iter().enumerate() {
        let source = Source::Disturbance(index, disturbance.kind);
        for (k, parameter) in disturbance.kind.parameters().iter().enumerate() {
            add(source, parameter.name, Place::Parameter(k));
        }
    }
    for (index, fault) in group.faults.iter().enumerate() {
        let source = Source::Fault(index);
        add(source, "onset_s", Place::Onset);
        if fault.duration_s.is_some() {
            add(source, "duration_s", Place::Duration);
        }
        if fault.ramp_s.is_some() {
            add(source, "ramp_s", Place::Ramp);
        }
        for (k, parameter) in fault.kind.parameters().iter().enumerate() {
            add(source, parameter.name, Place::Parameter(k));
        }
    }
    all
}

impl Quantity {
    fn new(group: &AgentGroup, source: Source, name: &'static str, place: Place) -> Self {
        let key = match source {
            Source::Agent => name.to_string(),
            Source::Control => format!("control_{name}"),
            Source::Initial => format!("initial_{name}"),
            Source::Disturbance(index, _) => {
                format!("disturbance{}_{name}", group.first_disturbance + index)
            }
            Source::Fault(index) => format!("fault{}_{name}", group.first_fault + index),
        };
        Self {
            source,
            name,
            key,
            place,
        }
    }

    /// Whether each channel has a value of its own.
    #[must_use]
    pub fn is_of_channels(&self) -> bool {
        matches!(
            self.place,
            Place::Error | Place::ErrorRate | Place::ErrorIntegral | Place::Parameter(_)
        )
    }

    /// Whether it is a parameter of a disturbance or fault, rather than when that is there.
    #[must_use]
    pub fn is_parameter(&self) -> bool {
        matches!(self.place, Place::Parameter(_))
    }

    /// The values of an agent: one of each channel, or one alone.
    fn values<'a>(&self, draw: &'a AgentDraw) -> &'a [f64] {
        use std::slice::from_ref;
        match (self.source, self.place) {
            (_, Place::MassScale) => from_ref(&draw.mass_scale),
            (_, Place::InertiaScale) => from_ref(&draw.inertia_scale),
            (_, Place::Kappa) => from_ref(&draw.kappa),
            (_, Place::ControlDelay) => from_ref(&draw.control_delay_s),
            (_, Place::Error) => &draw.error,
            (_, Place::ErrorRate) => &draw.error_rate,
            (_, Place::ErrorIntegral) => &draw.error_integral,
            (Source::Disturbance(index, _), Place::Parameter(k)) => &draw.disturbances[index][k],
            (Source::Fault(index), Place::Parameter(k)) => &draw.faults[index].parameters[k],
            (Source::Fault(index), Place::Onset) => from_ref(&draw.faults[index].onset_s),
            (Source::Fault(index), Place::Duration) => from_ref(&draw.faults[index].duration_s),
            (Source::Fault(index), Place::Ramp) => from_ref(&draw.faults[index].ramp_s),
            _ => &[],
        }
    }

    /// Whether value `k` means anything: a fault has parameters where it strikes, a disturbance where it acts.
    fn applies(&self, draw: &AgentDraw, k: usize) -> bool {
        match self.source {
            Source::Fault(index) if self.is_parameter() => draw.faults[index].strikes[k],
            Source::Fault(index) => draw.faults[index].occurs(),
            Source::Disturbance(_, kind) => kind.acts_on(k),
            Source::Agent | Source::Control | Source::Initial => true,
        }
    }

    /// The values of an agent, NaN where they do not apply: one of each channel, or one alone.
    pub fn cells<'a>(&'a self, draw: &'a AgentDraw) -> impl Iterator<Item = f64> + 'a {
        let values = self.values(draw).iter().enumerate();
        values.map(|(k, &value)| {
            if self.applies(draw, k) {
                value
            } else {
                f64::NAN
            }
        })
    }

    /// The values of an agent that apply, each with its channel; a quantity of the agent is with the first.
    pub fn applied<'a>(&'a self, draw: &'a AgentDraw) -> impl Iterator<Item = (usize, f64)> + 'a {
        let values = self.values(draw).iter().copied().enumerate();
        values.filter(|&(k, _)| self.applies(draw, k))
    }
}

/// What an episode met, in one number: what the ranking relates to the outcomes.
///
/// The sample unit is the episode, so a quantity that is drawn for each agent and channel is summed up by its root mean
/// square over the team: for errors and biases, whose sign does not matter, the size; for all others nearly the mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// Its name in tables: that of its quantity, with the name of its group in front where that has one; or
    /// `fault0_agents`.
    pub key: String,
    /// The group of agents whose it is, by index.
    group: usize,
    measure: Measure,
}

/// How a condition sums up a team.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Measure {
    /// Root mean square of all values that apply.
    Size(Quantity),
    /// The earliest time.
    Earliest(Quantity),
    /// How many agents have a fault.
    Agents(usize),
}

/// The conditions of a campaign's episodes, group by group.
#[must_use]
pub fn conditions(campaign: &Campaign) -> Vec<Condition> {
    let groups = campaign.groups().iter().enumerate();
    groups
        .flat_map(|(index, group)| conditions_of(index, group))
        .collect()
}

fn conditions_of(index: usize, group: &AgentGroup) -> Vec<Condition> {
    let mut all = Vec::new();
    let mut add = |key, measure| {
        all.push(Condition {
            key,
            group: index,
            measure,
        });
    };
    for quantity in quantities(group) {
        match (quantity.source, quantity.place) {
            (Source::Fault(fault), Place::Onset) => {
                let number = group.first_fault + fault;
                add(format!("fault{number}_agents"), Measure::Agents(fault));
                add(quantity.key.clone(), Measure::Earliest(quantity));
            }
            // Their keys have numbers of the campaign.
            (Source::Fault(_) | Source::Disturbance(..), _) => {
                add(quantity.key.clone(), Measure::Size(quantity));
            }
            (Source::Agent | Source::Control | Source::Initial, _) => {
                let key = group.titled(&quantity.key).replace(' ', "_");
                add(key, Measure::Size(quantity));
            }
        }
    }
    all
}

impl Condition {
    /// The condition in an episode, of which each group's draws are given; none where it does not apply, as the
    /// magnitude of a fault that nobody has.
    #[must_use]
    pub fn of(&self, groups: &[AppliedEpisode]) -> Option<f64> {
        let agents = groups[self.group].agents.iter();
        match &self.measure {
            Measure::Agents(index) => {
                let having = agents.filter(|draw| draw.faults[*index].occurs());
                Some(having.count() as f64)
            }
            Measure::Earliest(quantity) => {
                let times = agents.flat_map(|draw| quantity.applied(draw));
                times.map(|(_, time_s)| time_s).reduce(f64::min)
            }
            Measure::Size(quantity) => {
                let values = |draw| quantity.applied(draw).map(|(_, value)| value);
                let lists = agents.map(|draw| values(draw).collect::<Vec<f64>>());
                let lists: Vec<Vec<f64>> = lists.filter(|list| !list.is_empty()).collect();
                // Agents that are alike have the size of one of them, however many there are: the rounding of a longer
                // sum would make a constant list seem to vary.
                let alike = lists.windows(2).all(|pair| pair[0] == pair[1]);
                let counted = if alike { 1 } else { lists.len() };
                root_mean_square(lists.into_iter().take(counted).flatten())
            }
        }
    }
}

/// The fault that a condition is about, by its number in the campaign, and the rest of the condition's name.
#[must_use]
pub fn fault_of(condition: &str) -> Option<(usize, &str)> {
    let (index, rest) = condition.strip_prefix("fault")?.split_once('_')?;
    Some((index.parse().ok()?, rest))
}

/// A condition in the words of the campaign: with the name of its fault, or the kind of its disturbance.
#[must_use]
pub fn title(campaign: &Campaign, condition: &str) -> String {
    let of_fault = || {
        let (index, rest) = fault_of(condition)?;
        let (group, fault) = campaign.faults().nth(index)?;
        Some(group.titled(&format!("{} {rest}", fault.name)))
    };
    let of_group = || {
        let mut groups = campaign.groups().iter();
        groups.find_map(|group| {
            let rest = condition.strip_prefix(&*group.name)?.strip_prefix('_')?;
            (!group.name.is_empty()).then(|| group.titled(rest))
        })
    };
    of_fault()
        .or_else(|| disturbance_title(campaign, condition))
        .or_else(of_group)
        .unwrap_or_else(|| condition.to_string())
}

fn disturbance_title(campaign: &Campaign, condition: &str) -> Option<String> {
    let (index, rest) = condition.strip_prefix("disturbance")?.split_once('_')?;
    let index: usize = index.parse().ok()?;
    let mut groups = campaign.groups().iter().rev();
    let group = groups.find(|group| group.first_disturbance <= index)?;
    let place = index - group.first_disturbance;
    let kind = group.disturbances.get(place)?.kind;
    let alike = group.disturbances.iter().filter(|own| own.kind == kind);
    // Two of a kind are told apart by their places in the file.
    let place = match alike.count() {
        1 => String::new(),
        _ => format!(" [{place}]"),
    };
    Some(group.titled(&format!("{}{place} {rest}", kind.name())))
}
