//! Every statistic of a run, against numbers worked out by hand.

mod comparison;
mod curves;
mod dictionary;
mod effect;
mod fairness;
mod ranking;
mod requirements;

use urts_mc::campaign::Campaign;
use urts_mc::results::scores::{AgentScores, ChannelScores, Scores, Status};

/// Scores without a simulation, of a campaign of one group: how a controller, an episode and an agent fared.
pub(crate) fn scores_of_agents(
    campaign: &Campaign,
    agent: impl Fn(usize, usize, usize) -> AgentScores,
) -> Scores {
    let episodes = campaign.episodes as usize;
    let group = campaign.first_group();
    let mut scores = Scores::new(campaign);
    scores.fault_occurs = vec![vec![false; episodes]; group.faults.len()];
    for controller in 0..campaign.controllers.len() {
        for episode in 0..episodes {
            let agents = (0..group.team).map(|own| agent(controller, episode, own));
            scores.add(campaign, controller, &[agents.collect()]);
        }
    }
    scores
}

/// The same of how a channel (of any agent) fared, the status being the same for all channels.
pub(crate) fn scores_of_channels(
    campaign: &Campaign,
    outcome: impl Fn(usize, usize, usize) -> (Status, f64),
) -> Scores {
    let channels = campaign.first_group().channels().len();
    scores_of_agents(campaign, |controller, episode, _| AgentScores {
        status: outcome(controller, episode, 0).0,
        failed_step: None,
        channels: (0..channels)
            .map(|channel| with_error(outcome(controller, episode, channel).1))
            .collect(),
    })
}

/// A channel with this error, RMS and largest, that costs nothing.
pub(crate) fn with_error(error: f64) -> ChannelScores {
    ChannelScores {
        rmse: error,
        max_abs: error,
        peak: 0.0,
        effort: 0.0,
        saturated: 0.0,
        settling_s: 0.0,
        recovery_s: None,
    }
}
