//! One episode of a run again, with its trajectories.

use super::error::{MANIFEST, OutputError};
use super::manifest::{GIT_REVISION, Manifest};
use super::replay_rows::difference;
use crate::backend::cpu::{Cpu, Precision};
use crate::backend::gpu::{Adapter, Gpu, GpuError, Tuning, Wanted};
use crate::campaign::{AgentGroup, Campaign, CampaignError};
use crate::controllers::{GainSet, GainsError};
use crate::model::ChannelSample;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::results::table::Table;
use crate::simulation::Engine;
use crate::simulation::attenuation::{AttenuationAnalysis, Attenuations};
use crate::simulation::group_simulators::{GroupSimulators, GroupTrace};
use crate::util::shell::quoted;
use crate::util::suggest::did_you_mean;
use std::path::Path;
use thiserror::Error;

/// Time between two samples where none is asked for, s.
const DEFAULT_INTERVAL_S: f64 = 0.01;

/// Why an episode cannot be replayed.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The directory holds no run.
    #[error(transparent)]
    Run(#[from] OutputError),
    /// The run's campaign cannot be read any more.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The run's gains cannot be read any more.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// There is no such episode, controller or rate.
    #[error("{option} {value}: {limit}; {remedy}")]
    Usage {
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to do instead.
        remedy: String,
    },
}

/// An episode simulated again.
#[derive(Debug)]
pub struct Replay {
    /// The run's campaign.
    pub campaign: Campaign,
    /// Index of the episode.
    pub episode: u32,
    /// Which of the campaign's controllers was asked for.
    pub controller: usize,
    /// Why it was simulated in double precision on the CPU, if what simulated the run is not to be had here.
    pub stand_in: Option<String>,
    /// In what it is not the episode of the run's tables, if so.
    pub differs: Option<String>,
    /// How each agent ended; equal to the run's rows, bit by bit in the same arithmetic.
    pub outcomes: Vec<AgentOutcome>,
    /// What every agent and channel showed.
    pub snapshots: Vec<Snapshot>,
    /// The same episode under the campaign's other controllers, in its order, to look at side by side.
    pub others: Vec<OtherController>,
    /// What inequality (24) says about it, `[agent][channel]`, from an episode in double precision on the CPU.
    pub attenuations: Attenuations,
}

/// The episode under a controller that was not asked for.
#[derive(Debug)]
pub struct OtherController {
    /// Which of the campaign's controllers.
    pub controller: usize,
    /// How each agent ended.
    pub outcomes: Vec<AgentOutcome>,
    /// What every agent and channel showed.
    pub snapshots: Vec<Snapshot>,
}

/// Simulates an episode of a run under one of its controllers again, on the run's backend and with the run's gains, and
/// under the campaign's other controllers beside it, and shows it every `interval_s` (10 ms, or as near as the step
/// allows).
///
/// # Errors
/// If the directory holds no run, or the run has no such episode or controller.
pub fn replay(
    dir: &Path,
    episode: u32,
    controller: &str,
    interval_s: Option<f64>,
) -> Result<Replay, ReplayError> {
    let manifest = Manifest::read_verified(dir)?;
    let campaign = manifest.campaign()?;
    if episode >= manifest.episodes {
        return Err(no_such_episode(episode, manifest.episodes));
    }
    let index = index_of(&campaign, controller)?;
    let every = interval_steps(&campaign, interval_s)?;
    let gains = GainSet::read(&campaign, &dir.join("gains.json"))?;
    let segment = manifest
        .segments
        .iter()
        .find(|segment| (segment.first..segment.first + segment.episodes).contains(&episode));
    let simulate = |precision, simd| {
        let loops = GainSet::loops_of(&gains);
        let mut simulators = GroupSimulators::on_cpu(&campaign, &loops, precision, simd);
        // Nothing on the CPU fails.
        traced(&mut simulators, &campaign, episode, every).unwrap_or_default()
    };
    // The reference, where what simulated the run is not to be had.
    let stand_in = |reason: String| (simulate(Precision::F64, None), Some(reason));
    let (simulated, stand_in) = match segment.map(|segment| &segment.engine) {
        Some(Engine::Gpu { adapter, .. }) => {
            match on_gpu(adapter, &campaign, &gains, episode, every) {
                Ok(simulated) => (simulated, None),
                Err(reason) => stand_in(reason),
            }
        }
        // Other lanes round otherwise.
        Some(&Engine::Cpu {
            simd: Some(simd), ..
        }) if !simd.is_available() => stand_in("this processor lacks the run's lanes".to_string()),
        Some(&Engine::Cpu { simd, .. }) => (simulate(manifest.precision, simd), None),
        None => {
            return Err(OutputError::NoRun {
                path: dir.to_path_buf(),
                reason: format!(
                    "{MANIFEST}: segments does not say what simulated episode {episode}"
                ),
            }
            .into());
        }
    };
    let outcomes: Vec<&[AgentOutcome]> = simulated.iter().map(|(own, _)| &own[..]).collect();
    let differs = match &stand_in {
        None => difference(dir, &campaign, episode, &outcomes)?,
        Some(_) => None,
    };
    let differs = differs.map(|what| format!("{what}; {}", versions(&manifest)));
    let mut others: Vec<OtherController> = simulated
        .into_iter()
        .enumerate()
        .map(|(controller, (outcomes, snapshots))| OtherController {
            controller,
            outcomes,
            snapshots,
        })
        .collect();
    let OtherController {
        outcomes,
        snapshots,
        ..
    } = others.remove(index);
    Ok(Replay {
        attenuations: attenuations(&campaign, &gains, episode, index),
        campaign,
        episode,
        controller: index,
        stand_in,
        differs,
        outcomes,
        snapshots,
        others,
    })
}

/// Which versions of the program made a run and are at it now.
fn versions(manifest: &Manifest) -> String {
    let now = env!("CARGO_PKG_VERSION");
    match (manifest.version == now, &manifest.git_revision) {
        (true, same) if same.as_deref() == GIT_REVISION => {
            "this version made the run, so please report this".to_string()
        }
        _ => {
            let revision = manifest.git_revision.iter();
            let revision: String = revision.map(|own| format!(" ({own})")).collect();
            let made = &manifest.version;
            format!("version {made}{revision} made the run, and shows its episodes")
        }
    }
}

/// What (24) says about the agents of all groups under a controller.
fn attenuations(
    campaign: &Campaign,
    gains: &[GainSet],
    episode: u32,
    controller: usize,
) -> Attenuations {
    let groups = campaign.groups().iter().zip(gains);
    let of_group = |(group, gains): (&AgentGroup, &GainSet)| {
        let analysis = AttenuationAnalysis::new(group, gains, controller);
        analysis.of_episode(episode, || {
            let cpu = Cpu::new(group, &gains.loops(), Precision::F64, None);
            cpu.trace(episode, controller, 1).1
        })
    };
    groups.flat_map(of_group).collect()
}

/// The command that replays an episode of a run in a directory, as it is typed into a shell.
#[must_use]
pub fn command(dir: &Path, episode: u32, controller: &str) -> String {
    let dir = dir.display().to_string();
    // `./` keeps a name that begins with `-` from being read as an option.
    let dir = if dir.starts_with('-') {
        format!("./{dir}")
    } else {
        dir
    };
    format!(
        "urts-mc replay {} --episode {episode} --controller {}",
        quoted(&dir),
        quoted(controller)
    )
}

/// How each agent ended, and what it showed.
type Trajectory = (Vec<AgentOutcome>, Vec<Snapshot>);

/// Simulates under all controllers on the adapter of the run, or says why that cannot be.
fn on_gpu(
    adapter: &Adapter,
    campaign: &Campaign,
    gains: &[GainSet],
    episode: u32,
    every: u32,
) -> Result<Vec<Trajectory>, String> {
    let gpu = Gpu::open(Wanted::Same(adapter)).map_err(|error| error.to_string())?;
    let tuning = Tuning {
        batch: Some(1),
        ..Tuning::default()
    };
    let mut simulators = GroupSimulators::on_gpu(&gpu, campaign, &GainSet::loops_of(gains), tuning)
        .map_err(|error| error.to_string())?;
    traced(&mut simulators, campaign, episode, every).map_err(|error| error.to_string())
}

/// An episode under all controllers, with the agents of all groups one after the other.
fn traced(
    simulators: &mut GroupSimulators<'_>,
    campaign: &Campaign,
    episode: u32,
    every: u32,
) -> Result<Vec<Trajectory>, GpuError> {
    let controllers = campaign.controllers.len();
    let traced = simulators.trace(&[episode], controllers, every, &Snapshot::clone)?;
    let of_controller = |groups: Vec<GroupTrace<Snapshot>>| {
        let mut groups = groups.into_iter();
        let first = groups.next();
        let (mut outcomes, mut snapshots) =
            first.map_or_else(Default::default, |first| (first.outcomes, first.kept));
        for group in groups {
            outcomes.extend(group.outcomes);
            for (all, own) in snapshots.iter_mut().zip(group.kept) {
                all.agents.extend(own.agents);
                all.internals.extend(own.internals);
            }
        }
        (outcomes, snapshots)
    };
    Ok(traced.into_iter().flatten().map(of_controller).collect())
}

fn no_such_episode(episode: u32, episodes: u32) -> ReplayError {
    ReplayError::Usage {
        option: "--episode",
        value: episode.to_string(),
        limit: format!("the run has {} episodes, numbered from 0", episodes),
        remedy: format!("use 0 to {}", episodes.saturating_sub(1)),
    }
}

/// Which of the campaign's controllers has a name.
fn index_of(campaign: &Campaign, controller: &str) -> Result<usize, ReplayError> {
    campaign
        .controllers
        .iter()
        .position(|name| name == controller)
        .ok_or_else(|| ReplayError::Usage {
            option: "--controller",
            value: controller.to_string(),
            limit: format!(
                "the run has no such controller, but {}",
                campaign.controllers.join(", ")
            ),
            remedy: did_you_mean(
                controller,
                campaign.controllers.iter().map(String::as_str),
                "name one of them",
            ),
        })
}

/// The steps between two samples.
fn interval_steps(campaign: &Campaign, interval_s: Option<f64>) -> Result<u32, ReplayError> {
    let step_s = campaign.time.step_s;
    let steps = f64::from(campaign.time.steps);
    let every = match interval_s {
        None => (DEFAULT_INTERVAL_S / step_s).round().clamp(1.0, steps),
        Some(interval_s) => interval_s / step_s,
    };
    // A decimal multiple of the step is one up to rounding.
    let whole = (every - every.round()).abs() < 1e-6 * every;
    if !(whole && every.round() >= 1.0 && every.round() <= steps) {
        return Err(ReplayError::Usage {
            option: "--interval",
            value: interval_s.unwrap_or(DEFAULT_INTERVAL_S).to_string(),
            limit: format!(
                "samples are whole steps of {step_s} s apart, within {} s",
                steps * step_s
            ),
            remedy: "use a multiple of the step".to_string(),
        });
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to lie within the steps"
    )]
    Ok(every.round() as u32)
}

impl Replay {
    /// What has to be known of it, in sentences.
    #[must_use]
    pub fn cautions(&self) -> Vec<String> {
        let stand_in = self.stand_in.iter().map(|reason| {
            format!(
                "Simulated in f64 on the CPU, so digits beyond single precision differ from the run's: {reason}."
            )
        });
        let differs = self.differs.iter();
        let differs = differs.map(|what| format!("This is not the episode of the run: {what}."));
        stand_in.chain(differs).collect()
    }

    /// The trajectories as a table: a row per instant, agent and channel.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut table = Table::default();
        for snapshot in &self.snapshots {
            for (agent, channels) in snapshot.agents.iter().enumerate() {
                let (group, _) = self.campaign.member(agent);
                for (channel, shown) in group.channels().iter().zip(channels) {
                    let ChannelSample {
                        r,
                        x,
                        e,
                        e_rate,
                        e_hat,
                        f1,
                        f1_hat,
                        f2,
                        f2_hat,
                        u,
                    } = *shown;
                    let mut row = table.row();
                    row.real(
                        || "t_s".into(),
                        f64::from(snapshot.step) * self.campaign.time.step_s,
                    )
                    .count(|| "agent".into(), agent as u64)
                    .name(|| "channel".into(), channel.clone());
                    for (name, value) in [
                        ("r", r),
                        ("x", x),
                        ("e", e),
                        ("e_rate", e_rate),
                        ("e_hat", e_hat),
                        ("f1", f1),
                        ("f1_hat", f1_hat),
                        ("f2", f2),
                        ("f2_hat", f2_hat),
                        ("u", u),
                    ] {
                        row.real(|| name.into(), value);
                    }
                }
            }
        }
        table
    }
}
