//! Which recorded parameters matter: effects on an outcome, with intervals and permutation tests.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::arrangement::{Arrangement, Association};
use super::correlation;
use super::interval::Estimate;
use super::permutation::{Permutations, large_sample_p, permutation_p};
use super::rank::Ranked;

/// What the parameters may have an effect on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// A metric, or a log-ratio of metrics, of every episode.
    Metric(Ranked),
    /// Whether every episode failed: [`Ranked::of_flags`].
    Failure(Ranked),
}

/// The effect of one parameter on an outcome, over the episodes in which it applies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Episodes in which the parameter applies.
    pub n: usize,
    /// The monotone part: [`spearman`](super::spearman) for a metric, and for failures
    /// [`somers_d`](super::somers_d); positive if a larger parameter goes with a larger metric or
    /// more failures.
    pub trend: Estimate,
    /// Permutation p-value of no monotone effect.
    pub trend_p: f64,
    /// The share of the variance of the outcome's ranks that lies between bins of the parameter:
    /// the squared correlation ratio, corrected for what chance puts there (epsilon squared, Kelley
    /// 1935, PNAS 21:554-559) and never below 0. Unlike the trend it sees an effect of |x|.
    pub shape: f64,
    /// Permutation p-value of no effect on the bins' mean ranks (of Kruskal and Wallis's
    /// statistic, of which `shape` is a function).
    pub shape_p: f64,
}

impl Effect {
    /// p-value of no effect of either kind: the smaller one, doubled. What [`holm`](super::holm) is
    /// to be given for the family of all parameters.
    pub fn p_value(&self) -> f64 {
        (2.0 * self.trend_p.min(self.shape_p)).min(1.0)
    }
}

/// The effect of each parameter on the outcome; `None` where a parameter is constant over the
/// episodes in which it applies, where the outcome is, or where rows do not match.
///
/// A p-value is (b + 1) / (m + 1) for b of m random permutations of the outcome, among the episodes
/// in which the parameter applies, that are at least as extreme as the data: a valid p-value at any
/// size, without an assumption on distributions or ties (Phipson and Smyth 2010, SAGMB 9:39).
/// Sampling ends at the 50th such permutation, which keeps it valid (Besag and Clifford 1991,
/// Biometrika 78:301-304) and makes parameters without effect cheap.
///
/// Of more than [`Permutations::shuffled`] rows the p-values are those of the limit of many rows, or are found from the
/// few rows that decide.
///
/// The permutations depend on the seed alone. Parameters with the same rows and the same ties have
/// the same permutation distribution and share it: 300 continuous parameters cost little more than
/// one.
pub fn effects(
    parameters: &[Ranked],
    outcome: &Outcome,
    level: f64,
    permutations: Permutations,
) -> Vec<Option<Effect>> {
    let ranked = match outcome {
        Outcome::Metric(ranked) | Outcome::Failure(ranked) => ranked,
    };
    let mut effects: Vec<Option<Effect>> = parameters
        .par_iter()
        .map(|parameter| {
            let trend = match outcome {
                Outcome::Metric(_) => correlation::spearman(parameter, ranked, level),
                Outcome::Failure(_) => correlation::somers_d(parameter, ranked, level),
            };
            Some(Effect {
                n: parameter.len(),
                trend: trend?,
                trend_p: 1.0,
                shape: 0.0,
                shape_p: 1.0,
            })
        })
        .collect();

    let is_large = |parameter: &Ranked| parameter.len() > permutations.shuffled;
    let large: Vec<Option<Tested>> = parameters
        .par_iter()
        .map(|parameter| {
            let outcomes = ranked.along(parameter).filter(|_| is_large(parameter))?;
            let outcomes = outcomes.ranks_by_row();
            let arrangement = Arrangement::of(parameter);
            let observed = arrangement.association(&outcomes);
            let p = large_sample_p(&arrangement, &outcomes, observed, permutations);
            Some(Tested::new(&arrangement, &outcomes, observed, p))
        })
        .collect();
    for (effect, tested) in effects.iter_mut().zip(large) {
        if let (Some(effect), Some(tested)) = (effect, tested) {
            tested.tell(effect);
        }
    }

    // Those with the same rows and ties, by the index of the parameter.
    let mut groups: BTreeMap<(Vec<u32>, Vec<usize>), Vec<usize>> = BTreeMap::new();
    for (i, parameter) in parameters.iter().enumerate() {
        if effects[i].is_some() && !is_large(parameter) {
            let mut rows = parameter.order().to_vec();
            rows.sort_unstable();
            let ties = parameter.runs().map(|run| run.end).collect();
            groups.entry((rows, ties)).or_default().push(i);
        }
    }
    for members in groups.values() {
        let arrangement = Arrangement::of(&parameters[members[0]]);
        let outcomes_of = |i: &usize| Some(ranked.along(&parameters[*i])?.ranks_by_row());
        let observed: Vec<Association> = members
            .par_iter()
            .filter_map(|i| Some(arrangement.association(&outcomes_of(i)?)))
            .collect();
        let Some(outcomes) = outcomes_of(&members[0]) else {
            continue;
        };
        let p_values = permutation_p(&arrangement, &outcomes, &observed, permutations);
        for ((&i, observed), p) in members.iter().zip(&observed).zip(p_values) {
            if let Some(effect) = &mut effects[i] {
                Tested::new(&arrangement, &outcomes, *observed, p).tell(effect);
            }
        }
    }
    effects
}

/// What the test of a parameter says.
struct Tested {
    shape: f64,
    /// Of the trend and of the shape.
    p: [f64; 2],
}

impl Tested {
    fn new(
        arrangement: &Arrangement,
        outcomes: &[f64],
        observed: Association,
        p: [f64; 2],
    ) -> Self {
        let total: f64 = outcomes.iter().map(|y| y * y).sum();
        let shape = arrangement.shape(observed.between / total);
        Self { shape, p }
    }

    fn tell(&self, effect: &mut Effect) {
        effect.shape = self.shape;
        [effect.trend_p, effect.shape_p] = self.p;
    }
}
