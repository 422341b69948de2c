//! What an episode met, one number per quantity of the campaign: what the ranking relates to the outcomes.
//!
//! The sample unit is the episode, so a quantity that is drawn for each agent and channel is summed up by its root mean
//! square over the team: for errors and biases, whose sign does not matter, the size; for all others nearly the mean.
//! Times are those at which things happen, in whole steps, as in the tables.

use super::{AgentDraw, Episode, FaultDraw};
use crate::agent::Agent;
use crate::campaign::Campaign;
use crate::statistics::root_mean_square;

/// A quantity and its size in an episode; none where it does not apply, as the magnitude of a fault that nobody has.
pub type DrawnQuantity = (String, Option<f64>);

/// The conditions of an episode, the same quantities in the same order for all episodes of a campaign.
#[must_use]
pub fn conditions(campaign: &Campaign, episode: &Episode) -> Vec<DrawnQuantity> {
    let agents = &episode.applied(campaign).agents;
    let of_agents = |pick: &dyn Fn(&AgentDraw) -> f64| root_mean_square(agents.iter().map(pick));
    let of_channels = |pick: &dyn Fn(&AgentDraw) -> &Vec<f64>| {
        root_mean_square(agents.iter().flat_map(|draw| pick(draw).iter().copied()))
    };
    let mut all = vec![("mass_scale".to_string(), of_agents(&|draw| draw.mass_scale))];
    if let Agent::Uav(_) = campaign.agent {
        let scale = of_agents(&|draw| draw.inertia_scale);
        all.push(("inertia_scale".to_string(), scale));
    }
    all.push(("kappa".to_string(), of_agents(&|draw| draw.kappa)));
    if campaign.control.delay_s.is_some() {
        let delay = of_agents(&|draw| draw.control_delay_s);
        all.push(("control_delay_s".to_string(), delay));
    }
    let mut initial = |name: &str, size: Option<f64>| all.push((format!("initial_{name}"), size));
    initial("error", of_channels(&|draw| &draw.error));
    initial("error_rate", of_channels(&|draw| &draw.error_rate));
    initial("error_integral", of_channels(&|draw| &draw.error_integral));
    for (index, disturbance) in campaign.disturbances.iter().enumerate() {
        for (k, parameter) in disturbance.kind.parameters().iter().enumerate() {
            let values = agents.iter().flat_map(|draw| {
                let of_channels = draw.disturbances[index][k].iter().enumerate();
                of_channels
                    .filter(|(channel, _)| disturbance.kind.acts_on(*channel))
                    .map(|(_, value)| *value)
            });
            all.push((
                format!("disturbance{index}_{}", parameter.name),
                root_mean_square(values),
            ));
        }
    }
    for (index, fault) in campaign.faults.iter().enumerate() {
        let struck = || agents.iter().map(|draw| &draw.faults[index]);
        let having = struck().filter(|fault| fault.occurs()).count();
        all.push((format!("fault{index}_agents"), Some(having as f64)));
        let onsets = struck().filter(|fault| fault.occurs());
        let first = onsets.map(|fault| fault.onset_s).reduce(f64::min);
        all.push((format!("fault{index}_onset_s"), first));
        let mut of_time = |name: &str, pick: fn(&FaultDraw) -> f64| {
            let lengths = struck().filter(|fault| fault.occurs()).map(pick);
            all.push((format!("fault{index}_{name}"), root_mean_square(lengths)));
        };
        if fault.duration_s.is_some() {
            of_time("duration_s", |fault| fault.duration_s);
        }
        if fault.ramp_s.is_some() {
            of_time("ramp_s", |fault| fault.ramp_s);
        }
        for (k, parameter) in fault.kind.parameters().iter().enumerate() {
            let values = struck().flat_map(|fault| {
                let of_channels = fault.parameters[k].iter().zip(&fault.strikes);
                of_channels
                    .filter(|(_, strikes)| **strikes)
                    .map(|(value, _)| *value)
            });
            let name = format!("fault{index}_{}", parameter.name);
            all.push((name, root_mean_square(values)));
        }
    }
    all
}

/// The fault that a condition is about, and the rest of the condition's name.
#[must_use]
pub fn fault_of(condition: &str) -> Option<(usize, &str)> {
    let (index, rest) = condition.strip_prefix("fault")?.split_once('_')?;
    Some((index.parse().ok()?, rest))
}

/// A condition in the words of the campaign: with the name of its fault, or the kind of its disturbance.
#[must_use]
pub fn title(campaign: &Campaign, condition: &str) -> String {
    let of_fault = fault_of(condition)
        .and_then(|(index, rest)| Some(format!("{} {rest}", campaign.faults.get(index)?.name)));
    of_fault
        .or_else(|| of_disturbance(campaign, condition))
        .unwrap_or_else(|| condition.to_string())
}

fn of_disturbance(campaign: &Campaign, condition: &str) -> Option<String> {
    let (index, rest) = condition.strip_prefix("disturbance")?.split_once('_')?;
    let kind = campaign
        .disturbances
        .get(index.parse::<usize>().ok()?)?
        .kind;
    let of_kind = campaign.disturbances.iter().filter(|own| own.kind == kind);
    // Two of a kind are told apart by their places in the file.
    let place = match of_kind.count() {
        1 => String::new(),
        _ => format!(" [{index}]"),
    };
    Some(format!("{}{place} {rest}", kind.name()))
}
