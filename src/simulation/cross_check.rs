//! Some episodes of a run again on the CPU in double precision: whether the run may be trusted.

use super::attenuation::{AttenuationAnalysis, Attenuations, GroupAttenuation};
use super::group_simulators::{GroupSimulators, GroupTrace, trace_on_cpu};
use super::{Engine, RunOptions, Segment};
use crate::backend::cpu::{Cpu, Precision};
use crate::backend::gpu::{Gpu, GpuError, Tuning};
use crate::campaign::{Campaign, Verdict};
use crate::controllers::GainSet;
use crate::model::ChannelSample;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::random::philox::{Address, Stream};
use crate::results::scores::{Scores, Status, status};
use crate::synthesis::LoopGains;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::cell::LazyCell;
use std::collections::BTreeSet;

/// Largest difference of |e| between backends, m or rad (the contract between backends): what single precision costs is
/// 20 times less.
pub const ERROR_LIMIT: f64 = 2e-4;
/// Largest difference of an RMS error between backends, relative to it or to [`RMSE_FLOOR`], whichever is larger.
pub const RMSE_LIMIT: f64 = 1e-4;
/// An RMS error below this, m or rad, is compared as if it were this large: single precision alone, on the CPU as on a
/// GPU, costs up to 2e-6 m of the smallest errors (1 cm over short times), which is more than 1e-4 of them. Together
/// the limits let 5e-6 m pass, a fortieth of [`ERROR_LIMIT`].
pub const RMSE_FLOOR: f64 = 0.05;
/// By how much the feedback gains are raised in an episode that shows how sensitive another is, relative: what single
/// precision loses over some hundred operations, in every step.
const NUDGE: f64 = 1e-6;
/// An episode is sensitive if such a nudge, in double precision, moves it by more than this share of the limits. Others
/// move by some hundredths of them, as errors change with the gains. A loop that a limit of rate, a delay or lost
/// messages keep in a bounded oscillation without a period is sensitive: there every difference grows, and no two
/// number formats agree for long, however right both are.
const SENSITIVE_SHARE: f64 = 0.1;
/// Instants at which the errors are compared, besides their maxima over all steps.
const SAMPLES: u32 = 256;
/// Episodes whose trajectories are in memory at once.
const CHUNK: usize = 64;
/// Episodes whose trajectories at every step are in memory at once: each takes up to 100 MB.
const WHOLE: usize = 4;

/// How a run's episodes differ from the reference.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossCheck {
    /// Episodes that were simulated again under every controller.
    pub episodes: Vec<u32>,
    /// Pairs of episode and controller whose errors were compared: neither backend fails or saturates in them.
    pub compared: usize,
    /// Pairs that differ by more than the limits and are left out, since the reference itself differs as much from one
    /// whose gains are a millionth larger.
    #[serde(default)]
    pub sensitive: usize,
    /// Largest difference of |e|, m or rad.
    pub largest_error_difference: f64,
    /// Largest difference of a channel's RMS error, relative to it or to [`RMSE_FLOOR`].
    pub largest_rmse_difference: f64,
    /// Pairs whose verdicts differ.
    pub verdicts_differ: usize,
    /// Those among them that fail on one backend only and are not near a threshold on either.
    pub verdicts_differ_clearly: usize,
    /// Pairs that give other numbers than those in the tables when they are simulated again on the run's own engine.
    pub not_repeated: usize,
    /// What inequality (24) says about these episodes, by controller and channel group; empty in runs of older
    /// versions.
    #[serde(default)]
    pub attenuation: Vec<GroupAttenuation>,
}

impl CrossCheck {
    /// Why episodes are left out as sensitive.
    pub const SENSITIVE: &str = "so sensitive that gains a millionth larger move them too";

    /// Whether the backends agree within the limits.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.largest_error_difference <= ERROR_LIMIT
            && self.largest_rmse_difference <= RMSE_LIMIT
            && self.verdicts_differ_clearly == 0
            && self.not_repeated == 0
    }
}

/// Simulates `count` random episodes of a segment again, on its own engine and on the CPU in double precision: the
/// former must give the numbers of the tables, `scores`, to the last digit, the latter nearly the same.
///
/// # Errors
/// If the GPU fails.
pub fn cross_check(
    campaign: &Campaign,
    gains: &[GainSet],
    options: &RunOptions,
    segment: &Segment,
    scores: &Scores,
    gpu: Option<&Gpu>,
    count: u32,
) -> Result<CrossCheck, GpuError> {
    let episodes = choose(campaign.seed, segment, count);
    let every = campaign.time.steps.div_ceil(SAMPLES);
    let loops = GainSet::loops_of(gains);
    let controllers = campaign.controllers.len();
    let in_f64 = |loops: &[Vec<Vec<LoopGains>>]| -> Vec<Cpu> {
        let groups = campaign.groups().iter().zip(loops);
        let cpu = groups.map(|(group, loops)| Cpu::new(group, loops, Precision::F64, None));
        cpu.collect()
    };
    let reference = in_f64(&loops);
    // Built only when it is needed.
    let nudged = LazyCell::new(|| in_f64(&nudged(&loops)));
    let mut engine = match (&segment.engine, gpu) {
        (Engine::Gpu { .. }, Some(gpu)) => {
            let tuning = Tuning {
                batch: u32::try_from(episodes.len()).ok(),
                ..options.tuning
            };
            GroupSimulators::on_gpu(gpu, campaign, &loops, tuning)?
        }
        _ => GroupSimulators::on_cpu(campaign, &loops, options.precision, options.simd),
    };
    let mut check = CrossCheck {
        episodes: episodes.clone(),
        attenuation: attenuation(campaign, gains, &reference, &episodes),
        ..CrossCheck::default()
    };
    let mut reference = GroupSimulators::Cpu(reference);
    for episodes in episodes.chunks(CHUNK) {
        let found = engine.trace(episodes, controllers, every, &errors)?;
        let expected = reference.trace(episodes, controllers, every, &errors)?;
        for (&episode, found) in episodes.iter().zip(&found) {
            let repeated = |(controller, traced): (usize, &Traced)| {
                let groups = campaign.groups().iter().zip(&scores.groups);
                let mut groups = groups.zip(traced);
                groups.all(|((group, scores), traced)| {
                    scores.holds(group, controller, episode, &traced.outcomes)
                })
            };
            let pairs = found.iter().enumerate();
            check.not_repeated += pairs.filter(|&pair| !repeated(pair)).count();
        }
        for (&episode, (found, expected)) in episodes.iter().zip(found.iter().zip(&expected)) {
            for (controller, (found, expected)) in found.iter().zip(expected).enumerate() {
                check.take(campaign, found, expected, || {
                    trace_on_cpu(&nudged, episode, controller, every, &errors)
                });
            }
        }
    }
    Ok(check)
}

/// What inequality (24) says about some episodes under each controller that has a certificate.
fn attenuation(
    campaign: &Campaign,
    gains: &[GainSet],
    reference: &[Cpu],
    episodes: &[u32],
) -> Vec<GroupAttenuation> {
    let of_controller = |index: usize| {
        let groups = campaign.groups().iter().zip(gains).zip(reference);
        let certified =
            groups.filter(move |((_, gains), _)| gains.controllers[index].is_certified());
        certified.flat_map(move |((group, gains), reference)| {
            let analysis = AttenuationAnalysis::new(group, gains, index);
            let of_episode = |&episode: &u32| {
                analysis.of_episode(episode, || reference.trace(episode, index, 1).1)
            };
            let chunks = episodes.chunks(WHOLE);
            let attenuations: Vec<Attenuations> = chunks
                .flat_map(|chunk| chunk.par_iter().map(of_episode).collect::<Vec<_>>())
                .collect();
            analysis.by_group(&attenuations)
        })
    };
    (0..campaign.controllers.len())
        .flat_map(of_controller)
        .collect()
}

/// One episode under one controller, group by group: how the agents ended, and e at some instants.
type Traced = Vec<GroupTrace<Errors>>;

/// e at an instant, `[agent][channel]`.
type Errors = Vec<Vec<f64>>;

fn errors(snapshot: &Snapshot) -> Errors {
    let of_agent = |channels: &Vec<ChannelSample>| channels.iter().map(|shown| shown.e).collect();
    snapshot.agents.iter().map(of_agent).collect()
}

/// Feedback gains that are [`NUDGE`] larger.
fn nudged(loops: &[Vec<Vec<LoopGains>>]) -> Vec<Vec<Vec<LoopGains>>> {
    let mut nudged = loops.to_vec();
    for own in nudged.iter_mut().flatten().flatten() {
        own.k = own.k.map(|k| k * (1.0 + NUDGE));
    }
    nudged
}

/// Distinct episodes of a segment, drawn evenly, in ascending order.
fn choose(seed: u64, segment: &Segment, count: u32) -> Vec<u32> {
    let count = count.min(segment.episodes) as usize;
    let mut chosen = BTreeSet::new();
    for index in 0.. {
        if chosen.len() == count {
            break;
        }
        let address = Address {
            episode: segment.first,
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
        let offset = (address.unit(seed) * f64::from(segment.episodes)) as u32;
        chosen.insert(segment.first + offset.min(segment.episodes - 1));
    }
    chosen.into_iter().collect()
}

impl CrossCheck {
    /// Takes in an episode, of which `nudged` is the reference with slightly larger gains.
    fn take(
        &mut self,
        campaign: &Campaign,
        found: &Traced,
        expected: &Traced,
        nudged: impl FnOnce() -> Traced,
    ) {
        let groups = || campaign.groups().iter().zip(found.iter().zip(expected));
        let worst = |traced: &Traced| {
            let groups = campaign.groups().iter().zip(traced);
            let agents = groups.flat_map(|(group, traced)| {
                traced
                    .outcomes
                    .iter()
                    .map(move |agent| status(group, agent))
            });
            agents.max().unwrap_or(Status::Ok)
        };
        let (own, reference) = (worst(found), worst(expected));
        if own != reference {
            self.verdicts_differ += 1;
        }
        let near = groups().any(|(group, (found, expected))| {
            let mut agents = found.outcomes.iter().chain(&expected.outcomes);
            agents.any(|agent| near_threshold(&group.verdict, agent))
        });
        // A loop that grows leaves the numbers earlier in single precision: both fail, one is said to diverge.
        let one_fails = (own == Status::Ok) != (reference == Status::Ok);
        let clearly = one_fails && !near;
        // Demands beyond limits that cut nothing are counted too, but change no trajectory.
        let saturated = groups().any(|(group, (found, expected))| {
            let agents = found.outcomes.iter().chain(&expected.outcomes);
            let mut channels = agents.flat_map(|agent| &agent.channels);
            group.is_limited() && channels.any(|channel| channel.saturated_fraction > 0.0)
        });
        let calm = own == Status::Ok && reference == Status::Ok;
        let compared = calm && !saturated;
        let difference = Difference::between(found, expected);
        // What leaves the numbers grows without bound, which a nudge does not excuse.
        let bounded = own != Status::Diverged && reference != Status::Diverged;
        if bounded
            && (clearly || compared && difference.exceeds(1.0))
            && Difference::between(&nudged(), expected).exceeds(SENSITIVE_SHARE)
        {
            self.sensitive += 1;
            return;
        }
        self.verdicts_differ_clearly += usize::from(clearly);
        if compared {
            self.compared += 1;
            self.largest_error_difference = self.largest_error_difference.max(difference.error);
            self.largest_rmse_difference = self.largest_rmse_difference.max(difference.rmse);
        }
    }
}

/// How far two simulations of an episode are from each other.
#[derive(Debug)]
struct Difference {
    /// Largest difference of e at an instant, or of max |e|, m or rad.
    error: f64,
    /// Largest difference of an RMS error, relative to it or to [`RMSE_FLOOR`].
    rmse: f64,
}

impl Difference {
    fn between(found: &Traced, expected: &Traced) -> Self {
        let errors = |traced: &Traced| {
            let instants = traced.iter().flat_map(|group| &group.kept);
            let errors = instants.flatten().flatten();
            errors.copied().collect::<Vec<f64>>()
        };
        let (of_own, of_reference) = (errors(found), errors(expected));
        let instants = of_own.iter().zip(&of_reference);
        let at_instants = instants.map(|(own, reference)| size(own - reference));
        let channels = |traced: &Traced| {
            let agents = traced.iter().flat_map(|group| &group.outcomes);
            let channels = agents.flat_map(|agent| &agent.channels);
            channels.copied().collect::<Vec<_>>()
        };
        let (own, reference) = (channels(found), channels(expected));
        let pairs = || own.iter().zip(&reference);
        let of_maxima = pairs().map(|(own, reference)| size(own.max_abs - reference.max_abs));
        let of_rmse = pairs().map(|(own, reference)| {
            size((own.rmse - reference.rmse) / reference.rmse.max(RMSE_FLOOR))
        });
        Self {
            error: at_instants.chain(of_maxima).fold(0.0, f64::max),
            rmse: of_rmse.fold(0.0, f64::max),
        }
    }

    /// Whether they are further from each other than a share of the limits.
    fn exceeds(&self, share: f64) -> bool {
        self.error > share * ERROR_LIMIT || self.rmse > share * RMSE_LIMIT
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

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use std::path::Path;

    /// Episodes of the campaign in double precision, with its gains and with larger ones.
    fn smoke() -> (Campaign, [Vec<Cpu>; 2]) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/smoke.toml");
        let campaign = Campaign::load(&path).unwrap();
        let loops = GainSet::loops_of(&GainSet::of_groups(&campaign).unwrap());
        let cpu = [&loops, &nudged(&loops)].map(|loops| {
            let group = campaign.first_group();
            vec![Cpu::new(group, &loops[0], Precision::F64, None)]
        });
        (campaign, cpu)
    }

    #[test]
    fn ordinary_episodes_hardly_feel_a_nudge() {
        let (campaign, cpu) = smoke();
        for episode in 0..6 {
            for controller in 0..campaign.controllers.len() {
                let trace = |cpu: &Vec<Cpu>| trace_on_cpu(cpu, episode, controller, 10, &errors);
                let [own, moved] = cpu.each_ref().map(trace);
                let difference = Difference::between(&moved, &own);
                // A PID's error goes with its gains, so that the RMS error changes by about 1e-6 of itself: far from a
                // tenth of the limit of 1e-4.
                assert!(!difference.exceeds(0.5 * SENSITIVE_SHARE), "{difference:?}");
                assert!(difference.error > 0.0 && difference.rmse > 0.0);
            }
        }
    }

    #[test]
    fn a_difference_is_excused_where_the_reference_is_as_sensitive_and_nowhere_else() {
        let (campaign, [cpu, _]) = smoke();
        let expected = trace_on_cpu(&cpu, 0, 0, 10, &errors);
        let off_by = |difference: f64| {
            let mut moved = expected.clone();
            moved[0].kept[40][1][2] += difference;
            moved
        };
        let taken = |found: &Traced, nudged: &dyn Fn() -> Traced| {
            let mut check = CrossCheck::default();
            check.take(&campaign, found, &expected, nudged);
            check
        };
        // Within the limits nobody is asked.
        let near = taken(&off_by(0.9 * ERROR_LIMIT), &|| unreachable!());
        assert!(near.holds() && near.compared == 1 && near.sensitive == 0);
        let far = off_by(1.1 * ERROR_LIMIT);
        let wrong = taken(&far, &|| off_by(0.09 * ERROR_LIMIT));
        assert!(!wrong.holds() && wrong.compared == 1 && wrong.sensitive == 0);
        let sensitive = taken(&far, &|| off_by(0.11 * ERROR_LIMIT));
        assert!(sensitive.holds() && sensitive.compared == 0 && sensitive.sensitive == 1);
        // The same of verdicts that differ; but not of an episode that leaves the numbers.
        let mut failed = expected.clone();
        failed[0].outcomes[1].channels[2].max_abs = 9.0;
        failed[0].outcomes[1].failed_step = Some(2000);
        let moved = || off_by(0.11 * ERROR_LIMIT);
        let still = taken(&failed, &|| expected.clone());
        assert_eq!((still.verdicts_differ_clearly, still.sensitive), (1, 0));
        let told = taken(&failed, &moved);
        assert_eq!(
            (
                told.verdicts_differ,
                told.verdicts_differ_clearly,
                told.sensitive
            ),
            (1, 0, 1)
        );
        failed[0].outcomes[1].diverged = true;
        assert_eq!(taken(&failed, &moved).verdicts_differ_clearly, 1);
    }
}
