//! Two flights of a run to look at, the median and the worst of its first controller, each under every controller: how
//! error and command go over time, and how restless the commands are.

use crate::agent::ChannelGroup;
use crate::backend::cpu::Precision;
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use crate::model::ChannelSample;
use crate::model::episode::Snapshot;
use crate::results::flights::{Flights, Pace, PickedFlight, pick};
use crate::results::scores::Scores;
use crate::results::table::Table;
use crate::simulation::group_simulators::{GroupSimulators, GroupTrace};

/// Instants of a flight that are looked at, at most.
const MOST_INSTANTS: u32 = 10_000;
/// Instants of a flight that are kept for its picture.
const SHOWN: usize = 160;

/// What is kept of an instant on a channel group.
#[derive(Debug, Clone)]
struct Instant {
    /// Root mean square of e over agents and channels.
    error: f64,
    /// Largest |u|.
    command: f64,
    /// Every u.
    commands: Vec<f64>,
}

/// Simulates the flights again, on the CPU in double precision whatever simulated the run, so that they are the same
/// everywhere.
pub(super) fn flights(campaign: &Campaign, gains: &[GainSet], scores: &Scores) -> Flights {
    let picked = pick(campaign, scores);
    let episodes: Vec<u32> = picked.iter().map(|own| own.episode).collect();
    let loops = GainSet::loops_of(gains);
    let mut simulators = GroupSimulators::on_cpu(campaign, &loops, Precision::F64, None);
    // An odd number of steps, so that what changes sign in every step is seen to change.
    let every = campaign.time.steps.div_ceil(MOST_INSTANTS) | 1;
    let every_s = f64::from(every) * campaign.time.step_s;
    let keep = |snapshot: &Snapshot| snapshot.agents.clone();
    let controllers = campaign.controllers.len();
    // Nothing on the CPU fails.
    let traced = simulators.trace(&episodes, controllers, every, &keep);
    let traced = traced.unwrap_or_default();
    let (mut table, mut paces) = (Table::default(), Vec::new());
    for (PickedFlight { name, episode }, controllers) in picked.iter().zip(traced) {
        let names = campaign.controllers.iter().enumerate();
        for ((index, controller), groups) in names.zip(controllers) {
            let failed_at_s = scores.failed_at_s(campaign.time, index, *episode as usize);
            for (of, all) in channel_groups(campaign, &groups) {
                let shown = all.len().div_ceil(SHOWN).max(1);
                for (instant, own) in all.iter().enumerate().step_by(shown) {
                    let mut row = table.row();
                    row.word(|| "flight".into(), name)
                        .count(|| "episode".into(), u64::from(*episode))
                        .name(|| "controller".into(), controller.as_str().into())
                        .name(|| "group".into(), of.clone())
                        .real(|| "t_s".into(), instant as f64 * every_s)
                        .real(|| "error".into(), own.error)
                        .real(|| "command".into(), own.command)
                        .real_if("failed_at_s", failed_at_s);
                }
                paces.push(Pace {
                    flight: name,
                    controller: controller.clone(),
                    group: of,
                    reversals_per_s: reversals(&all) / (all.len().max(2) - 1) as f64 / every_s,
                    rate_per_s: rate(&all) / every_s,
                });
            }
        }
    }
    Flights {
        picked,
        table,
        paces,
    }
}

/// What each channel group of the campaign showed in a flight, by its name.
fn channel_groups(
    campaign: &Campaign,
    groups: &[GroupTrace<Vec<Vec<ChannelSample>>>],
) -> Vec<(std::sync::Arc<str>, Vec<Instant>)> {
    let of_group = |of: crate::campaign::ChannelsOfCampaign| {
        let own = campaign.groups()[of.group]
            .channel_groups()
            .swap_remove(of.place);
        let kept = groups[of.group].kept.iter();
        (of.name, kept.map(|agents| instant(agents, &own)).collect())
    };
    campaign
        .channel_groups()
        .into_iter()
        .map(of_group)
        .collect()
}

fn instant(agents: &[Vec<ChannelSample>], of: &ChannelGroup) -> Instant {
    let samples = agents
        .iter()
        .flat_map(|channels| &channels[of.channels.clone()]);
    let commands: Vec<f64> = samples.clone().map(|own| own.u).collect();
    let square: f64 = samples.map(|own| own.e * own.e).sum();
    Instant {
        error: (square / commands.len().max(1) as f64).sqrt(),
        command: commands
            .iter()
            .fold(0.0, |most: f64, own| most.max(own.abs())),
        commands,
    }
}

/// How often a command changes its sign, on the channel and agent where it does so most often.
fn reversals(all: &[Instant]) -> f64 {
    let channels = all.first().map_or(0, |own| own.commands.len());
    let of_channel = |channel: usize| {
        let changes = |pair: &&[Instant]| {
            let [before, after] = [&pair[0], &pair[1]].map(|own| own.commands[channel]);
            before * after < 0.0
        };
        all.windows(2).filter(changes).count()
    };
    (0..channels).map(of_channel).max().unwrap_or(0) as f64
}

/// The root mean square over instants, agents and channels of how much a command changes between two instants.
fn rate(all: &[Instant]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for pair in all.windows(2) {
        for (before, after) in pair[0].commands.iter().zip(&pair[1].commands) {
            let change = after - before;
            if change.is_finite() {
                sum += change * change;
                count += 1.0;
            }
        }
    }
    if count > 0.0 {
        f64::sqrt(sum / count)
    } else {
        0.0
    }
}
