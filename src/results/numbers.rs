//! Numbers of episodes: one of each episode, of all agents on some channels.

use super::scores::{ChannelGroupScores, Scores};
use super::team::TeamNumbers;
use crate::campaign::{Campaign, ChannelsOfCampaign, EpisodeNumber};

/// A number of each episode under a controller: infinite where an agent diverged, not a number where it does not apply.
pub(super) fn of_episodes(
    campaign: &Campaign,
    scores: &Scores,
    controller: usize,
    number: EpisodeNumber,
    of: &ChannelsOfCampaign,
) -> Vec<f64> {
    let pick: fn(&ChannelGroupScores) -> f64 = match number {
        EpisodeNumber::Rmse => |own| own.rmse,
        EpisodeNumber::MaxAbs => |own| own.max_abs,
        EpisodeNumber::PeakCommand => |own| own.peak,
        EpisodeNumber::Effort => |own| own.effort,
        EpisodeNumber::SaturatedShare => |own| own.saturated,
        EpisodeNumber::Settling => |own| own.settling_s,
        EpisodeNumber::Recovery => |own| own.recovery_s,
    };
    TeamNumbers::on(campaign, of).of_channel_group(scores, controller, pick)
}

/// Those of some episodes to which it applies, smallest first.
pub(super) fn sorted(values: &[f64], episodes: impl IntoIterator<Item = usize>) -> Vec<f64> {
    let applies = |value: &f64| !value.is_nan();
    let own = episodes.into_iter();
    let own = own.filter_map(|episode| values.get(episode).copied());
    let mut sorted: Vec<f64> = own.filter(applies).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}
