//! The parts of a run that are looked at on their own.

use super::scores::Scores;
use crate::campaign::{ALL, Campaign};
use std::sync::Arc;

/// Episodes that are looked at together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Subset {
    pub(crate) name: Arc<str>,
    pub(crate) episodes: Vec<usize>,
}

/// All episodes, then those of each stratum. Where the campaign is not divided, those with and without each fault that
/// only some episodes have.
pub(crate) fn parts(campaign: &Campaign, scores: &Scores) -> Vec<Subset> {
    let all: Vec<usize> = (0..scores.episodes()).collect();
    let mut parts = vec![Subset {
        name: ALL.into(),
        episodes: all.clone(),
    }];
    for (index, stratum) in campaign.strata.all().iter().enumerate() {
        let own = (0u32..).zip(&all);
        let own = own.filter(|(episode, _)| campaign.strata.index(*episode) == Some(index));
        parts.push(Subset {
            name: stratum.name.clone(),
            episodes: own.map(|(_, place)| *place).collect(),
        });
    }
    if !campaign.strata.is_empty() {
        return parts;
    }
    let faults = campaign.faults().zip(&scores.fault_occurs).enumerate();
    for (index, ((group, fault), occurs)) in faults {
        if fault.probability.iter().any(|own| *own < 1.0) {
            let (with, without) = all.iter().copied().partition(|&episode| occurs[episode]);
            for (word, episodes) in [("with", with), ("without", without)] {
                let name = format!("{word} fault{index} {}", group.titled(&fault.name)).into();
                parts.push(Subset { name, episodes });
            }
        }
    }
    parts
}

/// The episodes of each replicate of the sampling design; none where it has no replicates.
pub(crate) fn replicates(campaign: &Campaign, episodes: &[usize]) -> Vec<Vec<usize>> {
    let count = campaign.sampling.replicates().unwrap_or(0) as usize;
    let mut replicates = vec![Vec::new(); count];
    for &episode in episodes {
        let place = u32::try_from(episode).ok();
        let place = place.and_then(|episode| campaign.sampling.place(episode));
        if let Some(own) = place.and_then(|(replicate, _)| replicates.get_mut(replicate as usize)) {
            own.push(episode);
        }
    }
    replicates
}
