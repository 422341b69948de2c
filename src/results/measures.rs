//! The numbers that a controller is judged by, of a run's scores and gains.

use super::paired::Measured;
use super::scores::{CommandScores, Scores, Status};
use super::team::{Layout, team_rmse};
use crate::campaign::{Campaign, EpisodeNumber, LoopNumber, Measure, MeasuredChannels};
use crate::controllers::GainSet;
use crate::random::Method;
use crate::statistics::{quantile, quantile_interval, wilson};
use crate::synthesis::Margins;

/// What is measured of a controller in all episodes, with its interval at a confidence level where chance is in it;
/// infinite where too many episodes diverged. None of no episodes, and of gains of which nothing is known.
#[must_use]
pub fn measured(
    campaign: &Campaign,
    gains: &[GainSet],
    scores: &Scores,
    controller: usize,
    measure: &Measure,
    level: f64,
) -> Option<Measured> {
    match measure {
        Measure::FailureRate => {
            let status = &scores.status[controller];
            let failed = status.iter().filter(|own| **own != Status::Ok).count() as u64;
            let n = status.len() as u64;
            let interval = campaign.allows(Method::FailureRate);
            (n > 0).then(|| Measured {
                value: failed as f64 / n as f64,
                interval: interval.then(|| wilson(failed, n, level)),
            })
        }
        Measure::Episodes {
            number,
            channels,
            share,
        } => {
            let sorted = sorted(campaign, scores, controller, *number, channels);
            let interval = campaign.allows(Method::Quantile);
            Some(Measured {
                value: quantile(&sorted, *share)?,
                interval: quantile_interval(&sorted, *share, level).filter(|_| interval),
            })
        }
        Measure::Loop { number, channels } => {
            let margins = margins(campaign, gains, controller, channels.index)?;
            let value = match number {
                LoopNumber::DelayMargin => margins.delay_margin_ms,
                LoopNumber::PhaseMargin => margins.phase_margin_deg,
                LoopNumber::SensitivityPeak => margins.sensitivity_peak,
                LoopNumber::NoisePeak => margins.noise_peak,
                LoopNumber::NoiseH2 => margins.noise_h2,
            };
            Some(Measured {
                value,
                interval: None,
            })
        }
    }
}

/// A number of each episode, smallest first; infinite where an agent diverged.
fn sorted(
    campaign: &Campaign,
    scores: &Scores,
    controller: usize,
    number: EpisodeNumber,
    channels: &MeasuredChannels,
) -> Vec<f64> {
    let all = campaign.channel_groups();
    let of = &all[channels.index];
    let layout = Layout::new(campaign, of);
    let own = layout.scores(scores);
    let of_commands = |pick: fn(&CommandScores) -> f64| {
        // Channel groups are counted within their group of agents.
        let of_agents = all.iter().filter(|other| other.group == of.group).count();
        let before = all[..channels.index]
            .iter()
            .filter(|other| other.group == of.group)
            .count();
        let commands = own.commands[controller]
            .iter()
            .skip(before)
            .step_by(of_agents);
        let finite = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        commands.map(|own| finite(pick(own))).collect::<Vec<_>>()
    };
    let mut values = match number {
        EpisodeNumber::Rmse => team_rmse(scores, controller, &layout),
        EpisodeNumber::MaxAbs => {
            let of_episode = |episode: usize| match own.status[controller][episode] {
                Status::Diverged => f64::INFINITY,
                _ => layout
                    .of(&own.max_abs[controller], episode)
                    .fold(0.0, f64::max),
            };
            (0..scores.episodes()).map(of_episode).collect()
        }
        EpisodeNumber::PeakCommand => of_commands(|own| own.peak),
        EpisodeNumber::Effort => of_commands(|own| own.effort),
        EpisodeNumber::SaturatedShare => of_commands(|own| own.saturated),
    };
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// The margins of a controller on one of the campaign's channel groups.
fn margins(
    campaign: &Campaign,
    gains: &[GainSet],
    controller: usize,
    index: usize,
) -> Option<Margins> {
    let all = campaign.channel_groups();
    let group = all[index].group;
    let before = all[..index]
        .iter()
        .filter(|other| other.group == group)
        .count();
    let own = &gains[group].controllers[controller].groups[before];
    Some(own.findings.as_ref()?.analysis.margins)
}
