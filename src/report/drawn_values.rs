//! What a campaign draws, drawn again: the values of each quantity in some episodes.

use crate::campaign::AgentGroup;
use crate::draw::quantities::{Quantity, Source, quantities};
use crate::draw::{AgentDraw, draw};

/// A quantity of a group of agents with its values, as applied.
pub(crate) struct DrawnValues {
    pub(crate) quantity: Quantity,
    /// Of a fault's quantity: how many agents of how many have the fault.
    pub(crate) occurs: Option<[usize; 2]>,
    /// Of all agents and channels on which it acts.
    pub(crate) values: Vec<f64>,
}

/// The quantities of a group of agents in some episodes, in the order of the file's keys.
pub(crate) fn drawn_values(
    group: &AgentGroup,
    episodes: impl Iterator<Item = u32>,
) -> Vec<DrawnValues> {
    let applied = |episode| draw(group, episode).applied(group).agents;
    let draws: Vec<AgentDraw> = episodes.flat_map(applied).collect();
    let of_quantity = |quantity: Quantity| {
        let occurs = match quantity.source {
            Source::Fault(index) => {
                let having = draws.iter().filter(|draw| draw.faults[index].occurs());
                Some([having.count(), draws.len()])
            }
            _ => None,
        };
        let values = draws.iter().flat_map(|draw| quantity.applied(draw));
        let values = values.map(|(_, value)| value).collect();
        DrawnValues {
            quantity,
            occurs,
            values,
        }
    };
    quantities(group).into_iter().map(of_quantity).collect()
}
