//! The numbers that a controller is judged by, of a run's scores and gains.

use super::numbers::{of_episodes, sorted};
use super::paired::Measured;
use super::scores::{Scores, Status};
use crate::campaign::{Campaign, LoopNumber, Measure, MeasuredChannels};
use crate::controllers::GainSet;
use crate::random::Method;
use crate::statistics::{quantile, quantile_interval, wilson};

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
            rate(campaign, failed, status.len() as u64, level)
        }
        Measure::Survival { at_s } => {
            let failed = failed_by(campaign, scores, controller, *at_s);
            let survived = failed.iter().filter(|failed| !**failed).count() as u64;
            rate(campaign, survived, failed.len() as u64, level)
        }
        Measure::Episodes {
            number,
            channels,
            share,
        } => {
            let of = campaign.channel_groups().swap_remove(channels.index);
            let values = of_episodes(campaign, scores, controller, *number, &of);
            let sorted = sorted(&values, 0..values.len());
            let interval = campaign.allows(Method::Quantile);
            Some(Measured {
                value: quantile(&sorted, *share)?,
                interval: quantile_interval(&sorted, *share, level).filter(|_| interval),
            })
        }
        Measure::Loop { number, channels } => Some(Measured {
            value: of_loop(campaign, gains, controller, *number, channels)?,
            interval: None,
        }),
    }
}

/// A number of a controller's loop on one of the campaign's channel groups; none of gains of which it is not known.
#[must_use]
pub fn of_loop(
    campaign: &Campaign,
    gains: &[GainSet],
    controller: usize,
    number: LoopNumber,
    channels: &MeasuredChannels,
) -> Option<f64> {
    let of = campaign.channel_groups().swap_remove(channels.index);
    let own = &gains[of.group].controllers[controller].groups[of.place];
    let found = own.findings.as_ref()?;
    let margins = &found.analysis.margins;
    Some(match number {
        LoopNumber::DelayMargin => margins.delay_margin_ms,
        LoopNumber::PhaseMargin => margins.phase_margin_deg,
        LoopNumber::SensitivityPeak => margins.sensitivity_peak,
        LoopNumber::NoisePeak => margins.noise_peak,
        LoopNumber::NoiseH2 => margins.noise_h2,
        LoopNumber::CertifiedRho => found.certificate.as_ref()?.rho,
    })
}

/// Failed episodes among all.
fn rate(campaign: &Campaign, failed: u64, n: u64, level: f64) -> Option<Measured> {
    let interval = campaign.allows(Method::FailureRate);
    (n > 0).then(|| Measured {
        value: failed as f64 / n as f64,
        interval: interval.then(|| wilson(failed, n, level)),
    })
}

/// Whether an episode has failed by a time under a controller, `[episode]`. What breaks a limit of the RMS error
/// fails at the end.
pub(super) fn failed_by(
    campaign: &Campaign,
    scores: &Scores,
    controller: usize,
    at_s: f64,
) -> Vec<bool> {
    let time = campaign.time;
    let of_episode = |episode: usize| {
        let failure = scores.failure(time, controller, episode);
        failure.is_some_and(|step| time.shown_s(step) <= at_s)
    };
    (0..scores.episodes()).map(of_episode).collect()
}
