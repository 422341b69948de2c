//! Numbers of episodes: one of each episode, of all agents on some channels.

use super::scores::{ChannelGroupScores, Scores, Status};
use super::team::{Layout, team_rmse};
use crate::campaign::{Campaign, ChannelsOfCampaign, EpisodeNumber};

/// A number of each episode under a controller: infinite where an agent diverged, not a number where it does not apply.
pub(super) fn of_episodes(
    campaign: &Campaign,
    scores: &Scores,
    controller: usize,
    number: EpisodeNumber,
    of: &ChannelsOfCampaign,
) -> Vec<f64> {
    let layout = Layout::new(campaign, of);
    let own = layout.scores(scores);
    let other = |pick: fn(&ChannelGroupScores) -> f64| {
        let of_agents = campaign.groups()[of.group].channel_groups().len();
        let all = own.channel_groups[controller].iter();
        all.skip(of.place).step_by(of_agents).map(pick).collect()
    };
    match number {
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
        EpisodeNumber::PeakCommand => other(|own| own.peak),
        EpisodeNumber::Effort => other(|own| own.effort),
        EpisodeNumber::SaturatedShare => {
            // It has no share where an agent diverged, which is worse than any.
            let finite = |own: &ChannelGroupScores| match own.saturated.is_nan() {
                true => f64::INFINITY,
                false => own.saturated,
            };
            other(finite)
        }
        EpisodeNumber::Settling => other(|own| own.settling_s),
        EpisodeNumber::Recovery => other(|own| own.recovery_s),
    }
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
