//! The search for the free parameters of a controller on a campaign, and its confirmation on episodes that the search
//! has never seen.
//!
//! A generation of candidates flies in the same episodes, those of the next one in others. What the search liked best
//! is tried again under more episodes, in which limits have to be proved; the best of that is confirmed on fresh
//! episodes. No run of the campaign has any of these episodes.

mod cma_es;
mod files;
mod search;
mod structure;
mod trial;
mod tuning;
mod watched;

pub use cma_es::{CmaEs, usual_population};
pub use files::{Provenance, claim, json, write};
pub use structure::{FreeParameter, STRUCTURES, Structure};
pub use trial::Evaluation;
pub use tuning::{TuneError, Tuning};

use crate::campaign::{Campaign, CampaignError, Tune};
use crate::controllers::{GainSet, GainsError};
use crate::random::philox::{Address, Stream};
use crate::simulation::{RunOptions, open};
use search::Search;
use structure::Stage;
use trial::{Episodes, Proof, Trial};
use watched::Watched;

/// Episodes of the choice among the finalists, for each of those of a generation.
const FINAL_EPISODES: u32 = 16;

/// What seeds of episodes are for, beside the campaign's own; the numbers never change.
#[derive(Clone, Copy)]
enum Purpose {
    /// A generation of the search.
    Generation = 1,
    /// The choice among the finalists.
    Choice = 2,
    /// The confirmation of the result.
    Confirmation = 3,
}

/// The seed of episodes that nothing else has.
fn seed(campaign: &Campaign, purpose: Purpose, number: u32) -> u64 {
    let address = Address {
        episode: number,
        stream: Stream::Seed,
        entry: purpose as u32,
        member: 0,
        index: 0,
    };
    let [high, low, ..] = address.words(campaign.seed);
    u64::from(high) << 32 | u64::from(low)
}

/// What hears of each generation: how many candidates were tried, and the best so far.
pub type Heard<'a> = &'a dyn Fn(u32, &Evaluation);

/// Searches the parameters of a structure on a campaign with a `[tune]`.
///
/// # Errors
/// If the campaign has no `[tune]`, there are no gains to begin with, nothing can be simulated, or no candidate can
/// fly.
pub fn tune(
    campaign: &Campaign,
    structure: &'static Structure,
    options: &RunOptions,
    progress: Heard<'_>,
) -> Result<Tuning, TuneError> {
    let asked = asked(campaign)?;
    let (gpu, notes) = open(options)?;
    let start = gains(campaign, vec![structure.starts_from.to_string()])?;
    let start = start.iter().flat_map(|set| &set.controllers[0].groups);
    let start: Vec<f64> = start.flat_map(structure.start).collect();
    let trial = Trial {
        campaign,
        structure,
        watched: Watched::new(campaign, asked),
        options,
        gpu: gpu.as_ref(),
        references: gains(campaign, asked.references())?,
        searches: campaign.channel_groups().len(),
    };
    let search = Search::new(structure, start.clone(), campaign);
    let (search, generations) = searched(&trial, search, asked, progress)?;
    let finalists = chosen(&trial, &search, &generations, asked, &start)?;
    let winner = finalists[0].values.clone();
    let refused = |reason| TuneError::NoneFlies {
        tried: generations.iter().map(Vec::len).sum(),
        reason,
    };
    let controllers = trial.build(&winner, Stage::Choice).map_err(refused)?;
    let fresh = Episodes {
        seed: seed(campaign, Purpose::Confirmation, 0),
        count: asked.confirmation,
        proof: Proof::Value,
    };
    let mut confirmed = trial.evaluate(fresh, vec![winner, start])?.into_iter();
    let (Some(confirmed), Some(start)) = (confirmed.next(), confirmed.next()) else {
        return Err(refused("there was none".to_string()));
    };
    let Watched {
        measures,
        objective,
        limits,
    } = trial.watched;
    Ok(Tuning {
        campaign: campaign.clone(),
        asked: asked.clone(),
        structure,
        measures,
        minimised: objective.into_iter().map(|(place, _)| place).collect(),
        limits,
        generations,
        finalists,
        start,
        confirmed,
        controllers,
        notes,
    })
}

/// A search after all generations that its budget allows, and these.
fn searched(
    trial: &Trial<'_>,
    mut search: Search,
    asked: &Tune,
    progress: Heard<'_>,
) -> Result<(Search, Vec<Vec<Evaluation>>), TuneError> {
    let mut generations: Vec<Vec<Evaluation>> = Vec::new();
    let (mut tried, mut best): (u32, Option<Evaluation>) = (0, None);
    loop {
        let candidates = search.candidates();
        let count = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
        if tried > 0 && tried.saturating_add(count) > asked.budget {
            return Ok((search, generations));
        }
        let fresh = Episodes {
            seed: seed(trial.campaign, Purpose::Generation, tried),
            count: asked.episodes,
            proof: Proof::HalfAStandardError,
        };
        let generation = trial.evaluate(fresh, candidates)?;
        search = search.after(&generation);
        tried += count;
        best = generation
            .iter()
            .cloned()
            .chain(best)
            .min_by(Evaluation::order);
        if let Some(best) = &best {
            progress(tried, best);
        }
        generations.push(generation);
    }
}

/// What is worth another trial, under more episodes, best first.
fn chosen(
    trial: &Trial<'_>,
    search: &Search,
    generations: &[Vec<Evaluation>],
    asked: &Tune,
    start: &[f64],
) -> Result<Vec<Evaluation>, TuneError> {
    let all: Vec<&Evaluation> = generations.iter().flatten().collect();
    let choice = Episodes {
        seed: seed(trial.campaign, Purpose::Choice, 0),
        count: asked.episodes.saturating_mul(FINAL_EPISODES),
        proof: Proof::Interval,
    };
    let mut finalists = trial.evaluate(choice, search.finalists(&all))?;
    finalists.sort_by(Evaluation::order);
    // What the search began with stays if it keeps the limits and nothing better was proved.
    let as_measured = Episodes {
        proof: Proof::Value,
        ..choice
    };
    let begun = trial.evaluate(as_measured, vec![start.to_vec()])?;
    let stays = |begun: &Evaluation| begun.holds_all() && begun.objective < finalists[0].objective;
    if let Some(begun) = begun.into_iter().find(stays) {
        finalists.insert(0, begun);
    }
    Ok(finalists)
}

/// What a campaign says is to be searched.
///
/// # Errors
/// If it says nothing.
pub fn asked(campaign: &Campaign) -> Result<&Tune, CampaignError> {
    campaign.tune().ok_or_else(|| {
        campaign.invalid(
            "tune",
            "absent",
            "it says what is to be small, and within which limits",
            "add [tune] with minimise = \"rmse p50\" and limits = \"failure_rate <= 0.01\"",
        )
    })
}

/// The gains of some controllers of a campaign, a set of each group of agents.
fn gains(campaign: &Campaign, controllers: Vec<String>) -> Result<Vec<GainSet>, GainsError> {
    let (seed, episodes) = (campaign.seed, campaign.episodes);
    GainSet::of_groups(&campaign.clone().drawn_anew(seed, episodes, controllers))
}
