//! Candidates under the same episodes: what is measured of each, and how large its loss is.

use super::structure::{Stage, Structure};
use super::watched::Watched;
use crate::backend::gpu::Gpu;
use crate::campaign::{Bound, Campaign, Limit, Measure, Side};
use crate::controllers::{ChannelController, GainSet, SimulatedController};
use crate::results::Measured;
use crate::results::measures::measured;
use crate::simulation::{RunOptions, Simulation, SimulationError, simulate};
use crate::statistics::LEVEL;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;

/// What a limit that is exceeded by a factor of e adds to the loss, in which a factor of e of the objective counts 1:
/// more than any exchange of one for the other is worth, so that the least loss keeps the limits.
const PENALTY: f64 = 30.0;
/// The largest size of the objective's logarithm: that of candidates that diverge, and of those that leave nothing.
const LARGEST_LOGARITHM: f64 = 50.0;
/// The confidence level of an interval of half a standard error to either side.
const HALF_A_STANDARD_ERROR: f64 = 0.3829;
/// The largest excess of a single limit.
const LARGEST_EXCESS: f64 = 10.0;

/// What is tried, and how.
pub(super) struct Trial<'a> {
    pub(super) campaign: &'a Campaign,
    pub(super) structure: &'static Structure,
    pub(super) watched: Watched,
    pub(super) options: &'a RunOptions,
    pub(super) gpu: Option<&'a Gpu>,
    /// The controllers whose measures are bounds, a set of each group of agents.
    pub(super) references: Vec<GainSet>,
    /// How many channel groups are searched.
    pub(super) searches: usize,
}

/// The episodes of a trial.
#[derive(Debug, Clone, Copy)]
pub(super) struct Episodes {
    pub(super) seed: u64,
    pub(super) count: u32,
    /// What has to be known of a limit for it to count as kept.
    pub(super) proof: Proof,
}

/// What has to be known of a limit for it to count as kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Proof {
    /// That the measured value keeps it.
    Value,
    /// That a quantile keeps it with half a standard error to spare: few episodes tell it so badly that a search which
    /// goes by the value finds what was lucky, and with more to spare it would leave too much. They tell nothing of a
    /// small failure rate, whose value has to do.
    HalfAStandardError,
    /// That the whole 95 % interval keeps it.
    Interval,
}

impl Proof {
    /// The confidence level of the intervals.
    fn level(self) -> f64 {
        match self {
            Self::HalfAStandardError => HALF_A_STANDARD_ERROR,
            Self::Value | Self::Interval => LEVEL,
        }
    }

    /// The end of an interval that has to keep a limit on some side.
    fn end(self, measure: &Measure, found: &Measured, side: Side) -> f64 {
        let counts = match self {
            Self::Value => false,
            Self::HalfAStandardError => *measure != Measure::FailureRate,
            Self::Interval => true,
        };
        match (found.interval.filter(|_| counts), side) {
            (Some(interval), Side::AtMost) => interval.upper,
            (Some(interval), Side::AtLeast) => interval.lower,
            (None, _) => found.value,
        }
    }
}

/// A candidate and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// The parameters of each channel group, one after the other.
    pub values: Vec<f64>,
    /// Why it cannot fly, if it cannot.
    pub refused: Option<String>,
    /// What was measured, in the order of `Tuning::measures`; empty if it was refused.
    pub measured: Vec<Measured>,
    /// The bound of each of `Tuning::limits`; empty if it was refused.
    pub bounds: Vec<f64>,
    /// Whether each of the limits holds.
    pub holds: Vec<bool>,
    /// What is to be small, in all; infinite if it was refused.
    pub objective: f64,
    /// By how much all limits are exceeded, the sum of logarithms; 0 if they hold.
    pub excess: f64,
    /// What the search of each channel group goes by.
    #[serde(skip)]
    pub(super) losses: Vec<f64>,
}

impl Evaluation {
    fn refused(values: Vec<f64>, reason: String, searches: usize) -> Self {
        Self {
            values,
            refused: Some(reason),
            measured: Vec::new(),
            bounds: Vec::new(),
            holds: Vec::new(),
            objective: f64::INFINITY,
            excess: f64::INFINITY,
            losses: vec![f64::INFINITY; searches],
        }
    }

    /// Whether it flies and all limits hold.
    #[must_use]
    pub fn holds_all(&self) -> bool {
        self.refused.is_none() && self.holds.iter().all(|holds| *holds)
    }

    /// The better one first: nearer to the limits, and if both keep them the smaller objective.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let by_excess = self.excess.total_cmp(&other.excess);
        by_excess.then(self.objective.total_cmp(&other.objective))
    }
}

/// Episodes that were simulated under the references and some candidates.
struct Flown {
    campaign: Campaign,
    gains: Vec<GainSet>,
    simulation: Simulation,
}

impl Flown {
    fn measured(&self, controller: usize, measure: &Measure, proof: Proof) -> Measured {
        let scores = &self.simulation.tables.scores;
        let (campaign, gains) = (&self.campaign, &self.gains);
        let found = measured(campaign, gains, scores, controller, measure, proof.level());
        found.unwrap_or(Measured {
            value: f64::INFINITY,
            interval: None,
        })
    }
}

impl Trial<'_> {
    /// Tries candidates of some parameters under the same episodes.
    ///
    /// # Errors
    /// If nothing can be simulated.
    pub(super) fn evaluate(
        &self,
        episodes: Episodes,
        candidates: Vec<Vec<f64>>,
    ) -> Result<Vec<Evaluation>, SimulationError> {
        let stage = match episodes.proof {
            Proof::HalfAStandardError => Stage::Search,
            Proof::Value | Proof::Interval => Stage::Choice,
        };
        let built = candidates
            .par_iter()
            .map(|values| self.build(values, stage));
        let built: Vec<Result<Vec<SimulatedController>, String>> = built.collect();
        let sound: Vec<&Vec<SimulatedController>> = built.iter().flatten().collect();
        if sound.is_empty() {
            let refused = candidates.into_iter().zip(built).map(|(values, built)| {
                let reason = built.err().unwrap_or_default();
                Evaluation::refused(values, reason, self.searches)
            });
            return Ok(refused.collect());
        }
        let flown = self.fly(episodes, &sound)?;
        let references = self.references.first();
        let mut places = references.map_or(0, |set| set.controllers.len())..;
        let judged = candidates
            .into_iter()
            .zip(built)
            .map(|(values, built)| match built {
                Ok(_) => self.judge(values, &flown, places.next().unwrap_or_default(), episodes),
                Err(reason) => Evaluation::refused(values, reason, self.searches),
            });
        Ok(judged.collect())
    }

    /// The controller of some parameters for each group of agents.
    ///
    /// # Errors
    /// Why there is none, in words.
    pub(super) fn build(
        &self,
        values: &[f64],
        stage: Stage,
    ) -> Result<Vec<SimulatedController>, String> {
        let mut values = values.chunks(self.structure.parameters.len());
        let mut of_groups = Vec::new();
        for group in self.campaign.groups() {
            let own = group.synthesis.designs.iter().zip(values.by_ref());
            let built =
                own.map(|(design, values)| (self.structure.controller)(design, values, stage));
            let built: Result<Vec<ChannelController>, _> = built.collect();
            let set = GainSet {
                controllers: vec![SimulatedController {
                    name: self.structure.tuned.to_string(),
                    source: "tuned".to_string(),
                    groups: built.map_err(|error| error.to_string())?,
                }],
            };
            set.check_step(group).map_err(|error| error.to_string())?;
            of_groups.extend(set.controllers);
        }
        Ok(of_groups)
    }

    /// Simulates the references and some candidates.
    fn fly(
        &self,
        episodes: Episodes,
        candidates: &[&Vec<SimulatedController>],
    ) -> Result<Flown, SimulationError> {
        let mut gains = self.references.clone();
        for (index, candidate) in candidates.iter().enumerate() {
            for (set, controller) in gains.iter_mut().zip(candidate.iter()) {
                set.controllers.push(SimulatedController {
                    name: format!("candidate {index}"),
                    ..controller.clone()
                });
            }
        }
        let controllers = gains.first().map_or(&[][..], |set| &set.controllers);
        let names = controllers.iter().map(|own| own.name.clone()).collect();
        let campaign = self.campaign.clone();
        let campaign = campaign.drawn_anew(episodes.seed, episodes.count, names);
        let simulation = simulate(&campaign, &gains, self.options, self.gpu, &|_| ())?;
        // Candidates are not judged by fewer episodes than they were to have.
        if let Some(error) = simulation.interrupted {
            return Err(SimulationError::Gpu(error));
        }
        Ok(Flown {
            campaign,
            gains,
            simulation,
        })
    }

    /// What became of a candidate that flew as number `place`.
    fn judge(
        &self,
        values: Vec<f64>,
        flown: &Flown,
        place: usize,
        episodes: Episodes,
    ) -> Evaluation {
        let watched = &self.watched;
        let measures = watched.measures.iter();
        let found: Vec<Measured> = measures
            .map(|own| flown.measured(place, own, episodes.proof))
            .collect();
        let bound = |(_, limit): &(usize, Limit)| match &limit.bound {
            Bound::Number(number) => *number,
            Bound::Of(name) => {
                let mut names = flown.campaign.controllers.iter();
                let reference = names.position(|own| own == name).unwrap_or_default();
                flown
                    .measured(reference, &limit.measure, episodes.proof)
                    .value
            }
        };
        let bounds: Vec<f64> = watched.limits.iter().map(bound).collect();
        let limits = watched.limits.iter().zip(&bounds);
        let excesses = limits.map(|((place, limit), bound)| {
            let value = episodes
                .proof
                .end(&limit.measure, &found[*place], limit.side);
            limit.excess(value, *bound, 0.5 / f64::from(episodes.count))
        });
        let excesses: Vec<f64> = excesses.collect();
        // The objective and the excess of what counts for some channels.
        let sums = |counts: &dyn Fn(&Measure) -> bool| {
            let objective = watched.objective.iter();
            let terms = objective.filter(|(place, _)| counts(&watched.measures[*place]));
            let terms: Vec<f64> = terms
                .map(|(place, factor)| factor * found[*place].value)
                .collect();
            let limits = watched.limits.iter().zip(&excesses);
            let limits = limits.filter(|((_, limit), _)| counts(&limit.measure));
            (terms, limits.map(|(_, excess)| excess).sum::<f64>())
        };
        let (terms, excess) = sums(&|_| true);
        let objective: f64 = terms.iter().sum();
        let of_search = |search: usize| {
            let (own, excess) = sums(&|measure| {
                let channels = measure.channels();
                channels.is_none_or(|channels| channels.index == search)
            });
            // Channels of which nothing is to be small serve the others.
            let own = if own.is_empty() {
                objective
            } else {
                own.iter().sum()
            };
            own.ln().clamp(-LARGEST_LOGARITHM, LARGEST_LOGARITHM) + PENALTY * excess
        };
        Evaluation {
            values,
            refused: None,
            losses: (0..self.searches).map(of_search).collect(),
            holds: excesses.iter().map(|excess| *excess <= 0.0).collect(),
            measured: found,
            bounds,
            objective,
            excess,
        }
    }
}

impl Limit {
    /// By how much a measured value exceeds a bound, as a logarithm; of a failure rate that may be 0 with half an
    /// episode added.
    fn excess(&self, value: f64, bound: f64, half_an_episode: f64) -> f64 {
        let added = match self.measure {
            Measure::FailureRate => half_an_episode,
            _ => 0.0,
        };
        let (larger, smaller) = match self.side {
            Side::AtMost => (value, bound),
            Side::AtLeast => (bound, value),
        };
        if larger <= smaller {
            return 0.0;
        }
        // Also where one of them is 0 or infinite.
        ((larger + added) / (smaller + added))
            .ln()
            .min(LARGEST_EXCESS)
    }
}
