//! Some episodes of a run again on the CPU in double precision: whether the run may be trusted.

use crate::attenuation::{Attenuations, GroupAttenuation, Witness};
use crate::backend::Flown;
use crate::backend::cpu::{Cpu, Precision};
use crate::backend::gpu::{Gpu, GpuError, GpuFlyer, Tuning};
use crate::campaign::{Campaign, Verdict};
use crate::flight::{Engine, Leg, Settings};
use crate::gains::GainSet;
use crate::model::Shown;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::model::rng::{Address, Stream};
use crate::tables::{Scores, Status, status};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Largest difference of |e| between backends, m or rad (model.md, section 7): what single precision costs is 20 times less.
pub const ERROR_LIMIT: f64 = 2e-4;
/// Largest difference of an RMS error between backends, relative to it or to [`RMSE_FLOOR`], whichever is larger.
pub const RMSE_LIMIT: f64 = 1e-4;
/// An RMS error below this, m or rad, is compared as if it were this large: single precision alone, on the CPU as on a GPU,
/// costs up to 2e-6 m of the smallest errors (1 cm over short times), which is more than 1e-4 of them. Together the limits let
/// 5e-6 m pass, a fortieth of [`ERROR_LIMIT`].
pub const RMSE_FLOOR: f64 = 0.05;
/// Instants at which the errors are compared, besides their maxima over all steps.
const SAMPLES: u32 = 256;
/// Episodes whose trajectories are in memory at once.
const CHUNK: usize = 64;
/// Episodes whose trajectories at every step are in memory at once: each takes up to 100 MB.
const WHOLE: usize = 4;

/// How a run's episodes differ from the reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossCheck {
    /// Episodes that were flown again under every controller.
    pub episodes: Vec<u32>,
    /// Pairs of episode and controller whose errors were compared: neither backend fails or saturates in them.
    pub compared: usize,
    /// Largest difference of |e|, m or rad.
    pub largest_error_difference: f64,
    /// Largest difference of a channel's RMS error, relative to it or to [`RMSE_FLOOR`].
    pub largest_rmse_difference: f64,
    /// Pairs whose verdicts differ.
    pub verdicts_differ: usize,
    /// Those among them that fail on one backend only and are not near a threshold on either.
    pub verdicts_differ_clearly: usize,
    /// Pairs that give other numbers than those in the tables when they fly again on the run's own engine.
    pub not_repeated: usize,
    /// What inequality (24) says about these episodes, by controller and channel group; empty in runs of older versions.
    #[serde(default)]
    pub attenuation: Vec<GroupAttenuation>,
}

impl CrossCheck {
    /// Whether the backends agree within the limits.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.largest_error_difference <= ERROR_LIMIT
            && self.largest_rmse_difference <= RMSE_LIMIT
            && self.verdicts_differ_clearly == 0
            && self.not_repeated == 0
    }
}

/// Flies `count` random episodes of a leg again, on its own engine and on the CPU in double precision: the former must give
/// the numbers of the tables, `scores`, to the last digit, the latter nearly the same.
///
/// # Errors
/// If the GPU fails.
pub fn cross_check(
    campaign: &Campaign,
    gains: &GainSet,
    settings: &Settings,
    leg: &Leg,
    scores: &Scores,
    gpu: Option<&Gpu>,
    count: u32,
) -> Result<CrossCheck, GpuError> {
    let episodes = choose(campaign.seed, leg, count);
    let every = campaign.time.steps.div_ceil(SAMPLES);
    let loops = gains.loops();
    let reference = Cpu::new(campaign, &loops, Precision::F64, None);
    let mut engine = match (&leg.engine, gpu) {
        (Engine::Gpu { .. }, Some(gpu)) => {
            let tuning = Tuning {
                batch: u32::try_from(episodes.len()).ok(),
                ..settings.tuning
            };
            Tracer::Gpu(Box::new(GpuFlyer::new(gpu, campaign, &loops, tuning)?))
        }
        _ => Tracer::Cpu(Box::new(Cpu::new(
            campaign,
            &loops,
            settings.precision,
            settings.simd,
        ))),
    };
    let mut check = CrossCheck {
        episodes: episodes.clone(),
        compared: 0,
        largest_error_difference: 0.0,
        largest_rmse_difference: 0.0,
        verdicts_differ: 0,
        verdicts_differ_clearly: 0,
        not_repeated: 0,
        attenuation: attenuation(campaign, gains, &reference, &episodes),
    };
    for episodes in episodes.chunks(CHUNK) {
        let found = match &mut engine {
            Tracer::Gpu(flyer) => trace_on_gpu(flyer, episodes, loops.len(), every)?,
            Tracer::Cpu(cpu) => trace_on_cpu(cpu, episodes, loops.len(), every),
        };
        let expected = trace_on_cpu(&reference, episodes, loops.len(), every);
        for (&episode, found) in episodes.iter().zip(&found) {
            let repeated = |(controller, traced): (usize, &Traced)| {
                scores.holds(campaign, controller, episode, &traced.outcomes)
            };
            let pairs = found.iter().enumerate();
            check.not_repeated += pairs.filter(|&pair| !repeated(pair)).count();
        }
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            check.take(campaign, found, expected);
        }
    }
    Ok(check)
}

/// What inequality (24) says about some episodes under each controller that has a certificate.
fn attenuation(
    campaign: &Campaign,
    gains: &GainSet,
    reference: &Cpu,
    episodes: &[u32],
) -> Vec<GroupAttenuation> {
    let controllers = gains.controllers.iter().enumerate();
    let certified = controllers.filter(|(_, controller)| controller.is_certified());
    let of_controller = |(index, _)| {
        let witness = Witness::new(campaign, gains, index);
        let of_episode =
            |&episode: &u32| witness.of_episode(episode, || reference.trace(episode, index, 1).1);
        let chunks = episodes.chunks(WHOLE);
        let flights: Vec<Attenuations> = chunks
            .flat_map(|chunk| chunk.par_iter().map(of_episode).collect::<Vec<_>>())
            .collect();
        witness.by_group(&flights)
    };
    certified.flat_map(of_controller).collect()
}

/// What flies the episodes that are checked.
enum Tracer<'g> {
    Gpu(Box<GpuFlyer<'g>>),
    Cpu(Box<Cpu>),
}

/// One episode under one controller: how its agents ended, and e at some instants, `[instant][agent][channel]`.
struct Traced {
    outcomes: Vec<AgentOutcome>,
    errors: Vec<Vec<Vec<f64>>>,
}

fn errors(agents: &[Vec<Shown>]) -> Vec<Vec<f64>> {
    let of_agent = |channels: &Vec<Shown>| channels.iter().map(|shown| shown.e).collect();
    agents.iter().map(of_agent).collect()
}

/// `[episode][controller]`.
fn trace_on_cpu(cpu: &Cpu, episodes: &[u32], controllers: usize, every: u32) -> Vec<Vec<Traced>> {
    let trace = |&episode: &u32| {
        let under = |controller| {
            let (outcomes, snapshots) = cpu.trace(episode, controller, every);
            let shown = |snapshot: &Snapshot| errors(&snapshot.agents);
            Traced {
                outcomes,
                errors: snapshots.iter().map(shown).collect(),
            }
        };
        (0..controllers).map(under).collect()
    };
    episodes.par_iter().map(trace).collect()
}

/// `[episode][controller]`.
fn trace_on_gpu(
    flyer: &mut GpuFlyer<'_>,
    episodes: &[u32],
    controllers: usize,
    every: u32,
) -> Result<Vec<Vec<Traced>>, GpuError> {
    let mut seen: Vec<Vec<Vec<Vec<Vec<f64>>>>> =
        vec![vec![Vec::new(); controllers]; episodes.len()];
    let flown: Vec<Flown> = flyer.trace(episodes, every, &mut |instant| {
        for (episode, seen) in seen.iter_mut().enumerate() {
            for (controller, seen) in seen.iter_mut().enumerate() {
                seen.push(errors(&instant.agents(episode, controller)));
            }
        }
    })?;
    let of_episode = |(flown, seen): (Flown, Vec<_>)| {
        let pairs = flown.outcomes.into_iter().zip(seen);
        pairs
            .map(|(outcomes, errors)| Traced { outcomes, errors })
            .collect()
    };
    Ok(flown.into_iter().zip(seen).map(of_episode).collect())
}

/// Distinct episodes of a leg, drawn evenly, in ascending order.
fn choose(seed: u64, leg: &Leg, count: u32) -> Vec<u32> {
    let count = count.min(leg.episodes) as usize;
    let mut chosen = BTreeSet::new();
    for index in 0.. {
        if chosen.len() == count {
            break;
        }
        let address = Address {
            episode: leg.first,
            stream: Stream::CrossCheck,
            entry: 0,
            member: 0,
            index,
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number below the count of episodes"
        )]
        let offset = (address.unit(seed) * f64::from(leg.episodes)) as u32;
        chosen.insert(leg.first + offset.min(leg.episodes - 1));
    }
    chosen.into_iter().collect()
}

impl CrossCheck {
    fn take(&mut self, campaign: &Campaign, found: &Traced, expected: &Traced) {
        let worst = |traced: &Traced| {
            let each = traced.outcomes.iter().map(|agent| status(campaign, agent));
            each.max().unwrap_or(Status::Ok)
        };
        let (own, reference) = (worst(found), worst(expected));
        if own != reference {
            self.verdicts_differ += 1;
            let agents = found.outcomes.iter().zip(&expected.outcomes);
            let mut near = agents.flat_map(|(found, expected)| {
                [
                    near_threshold(&campaign.verdict, found),
                    near_threshold(&campaign.verdict, expected),
                ]
            });
            // A loop that grows leaves the numbers earlier in single precision: both fail, one is said to diverge.
            let one_fails = (own == Status::Ok) != (reference == Status::Ok);
            if one_fails && !near.any(|near| near) {
                self.verdicts_differ_clearly += 1;
            }
        }
        // Demands beyond limits that cut nothing are counted too, but change no trajectory.
        let saturated = |traced: &Traced| {
            let mut channels = traced.outcomes.iter().flat_map(|agent| &agent.channels);
            campaign.is_limited() && channels.any(|channel| channel.saturated_fraction > 0.0)
        };
        let calm = own == Status::Ok && reference == Status::Ok;
        if !calm || saturated(found) || saturated(expected) {
            return;
        }
        self.compared += 1;
        let sampled = found.errors.iter().flatten().flatten();
        for (own, reference) in sampled.zip(expected.errors.iter().flatten().flatten()) {
            self.take_error(own - reference);
        }
        let channels = |traced: &Traced| {
            let channels = traced.outcomes.iter().flat_map(|agent| &agent.channels);
            channels.copied().collect::<Vec<_>>()
        };
        for (own, reference) in channels(found).iter().zip(&channels(expected)) {
            self.take_error(own.max_abs - reference.max_abs);
            let relative = size((own.rmse - reference.rmse) / reference.rmse.max(RMSE_FLOOR));
            self.largest_rmse_difference = self.largest_rmse_difference.max(relative);
        }
    }

    fn take_error(&mut self, difference: f64) {
        self.largest_error_difference = self.largest_error_difference.max(size(difference));
    }
}

/// |difference|; one that is no number is as large as can be, or a maximum would pass over it.
fn size(difference: f64) -> f64 {
    if difference.is_finite() {
        difference.abs()
    } else {
        f64::MAX
    }
}

/// Whether an agent's largest error or RMS error lies within the limits of a threshold of the verdict.
fn near_threshold(verdict: &Verdict, agent: &AgentOutcome) -> bool {
    let mut channels = agent.channels.iter().enumerate();
    channels.any(|(channel, metrics)| {
        let (max_error, max_rmse) = (verdict.max_error[channel], verdict.max_rmse[channel]);
        (metrics.max_abs - max_error).abs() <= ERROR_LIMIT
            || max_rmse.is_finite()
                && (metrics.rmse - max_rmse).abs() <= RMSE_LIMIT * max_rmse.max(RMSE_FLOOR)
    })
}
