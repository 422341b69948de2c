//! Where the candidates of a search come from.
//!
//! Every channel group is searched on its own, all side by side: a candidate is one of each search, all fly in the same
//! episodes, and each search goes by what concerns its own channels. Half as many dimensions take less than half as
//! many candidates. Where channel groups act on each other, as those of a UAV that tilts to accelerate, the partners of
//! a candidate are one more thing that chance decides, and less and less so as the searches end.

use super::cma_es::{CmaEs, usual_population};
use super::structure::Structure;
use super::trial::Evaluation;
use crate::agent::ActuationKind;
use crate::campaign::{AgentGroup, Campaign};

/// Candidates of a generation, for each of the usual number: more of them are less often misled by chance, and end less
/// often at the best of a neighbourhood.
const LARGER: usize = 2;
/// Parts of the search that send their best to the choice.
const PARTS: usize = 15;
/// Candidates of the whole search that are sent to the choice.
const BEST: usize = 16;

/// The searches of a structure's parameters on a campaign.
#[derive(Debug, Clone)]
pub(super) struct Search {
    structure: &'static Structure,
    /// The parameters of each channel group, one after the other, where the search begins.
    start: Vec<f64>,
    /// Of each channel group.
    searches: Vec<CmaEs>,
    /// Whether channel groups of some agent act on each other.
    is_coupled: bool,
}

impl Search {
    /// A search before its first generation.
    pub(super) fn new(structure: &'static Structure, start: Vec<f64>, campaign: &Campaign) -> Self {
        let each = structure.parameters.len();
        let population = LARGER * usual_population(each);
        let origin = vec![0.0; each];
        let of_channels = |number: u32| CmaEs::new(&origin, 1.0, population, campaign.seed, number);
        let channels = start.len() / each.max(1);
        Self {
            searches: (0..).take(channels).map(of_channels).collect(),
            is_coupled: campaign.groups().iter().any(is_coupled),
            structure,
            start,
        }
    }

    /// The parameters of the next generation's candidates: each is one of every search.
    pub(super) fn candidates(&self) -> Vec<Vec<f64>> {
        let points: Vec<Vec<Vec<f64>>> = self.searches.iter().map(CmaEs::candidates).collect();
        let count = points.first().map_or(0, Vec::len);
        let of_candidate = |candidate: usize| {
            let own: Vec<&[f64]> = points.iter().map(|own| &own[candidate][..]).collect();
            self.values(&own)
        };
        (0..count).map(of_candidate).collect()
    }

    /// The search after a generation.
    pub(super) fn after(mut self, generation: &[Evaluation]) -> Self {
        let numbered = self.searches.into_iter().enumerate();
        let learnt = numbered.map(|(number, search)| {
            let losses: Vec<f64> = generation.iter().map(|own| own.losses[number]).collect();
            search.after(&losses)
        });
        self.searches = learnt.collect();
        self
    }

    /// The parameters that are worth another trial: the middle of the last generation, the best of all, and the best of
    /// each part of the search, which ventured less the earlier it was. Each is made of what the searches of all
    /// channel groups liked or, where these act on each other, a candidate as it flew.
    pub(super) fn finalists(&self, tried: &[&Evaluation]) -> Vec<Vec<f64>> {
        let each = self.structure.parameters.len();
        let middle: Vec<&[f64]> = self.searches.iter().map(CmaEs::mean).collect();
        let of_part = tried.len().div_ceil(PARTS).max(1);
        let best_of = |loss: &dyn Fn(&Evaluation) -> f64| -> Vec<&Evaluation> {
            let order = |a: &&Evaluation, b: &&Evaluation| loss(a).total_cmp(&loss(b));
            let mut all = tried.to_vec();
            all.sort_by(order);
            let parts = tried.chunks(of_part);
            let of_parts = parts.filter_map(|part| part.iter().copied().min_by(order));
            all.into_iter().take(BEST).chain(of_parts).collect()
        };
        let best: Vec<Vec<&Evaluation>> = (0..self.searches.len())
            .map(|search| match self.is_coupled {
                true => best_of(&|own| own.losses.iter().sum()),
                false => best_of(&|own| own.losses[search]),
            })
            .collect();
        let composed = |place: usize| {
            let own = best
                .iter()
                .enumerate()
                .flat_map(|(search, best)| &best[place].values[search * each..(search + 1) * each]);
            own.copied().collect()
        };
        let count = best.first().map_or(0, Vec::len);
        let composed = (0..count).map(composed);
        std::iter::once(self.values(&middle))
            .chain(composed)
            .collect()
    }

    /// The parameters at a point of each search.
    fn values(&self, points: &[&[f64]]) -> Vec<f64> {
        let free = self.structure.parameters.iter().cycle();
        let coordinates = points.iter().copied().flatten();
        let all = self.start.iter().zip(coordinates).zip(free);
        all.map(|((start, coordinate), free)| free.at(*start, *coordinate))
            .collect()
    }
}

/// Whether the commands of a channel act on others: where thrust has to be turned.
fn is_coupled(group: &AgentGroup) -> bool {
    group.agent.actuation() == ActuationKind::Thrust
}
