//! Every statistic of a run, against numbers worked out by hand.

mod comparison;
mod dictionary;
mod effect;
mod fairness;
mod ranking;
mod requirements;

use urts_mc::campaign::Campaign;
use urts_mc::results::scores::{GroupScores, Scores, Status};

/// Scores without a simulation, of a campaign of one group: how a controller, an episode and a channel (of any agent)
/// fared, the status being the same for all channels.
pub(crate) fn scores_of_channels(
    campaign: &Campaign,
    outcome: impl Fn(usize, usize, usize) -> (Status, f64),
) -> Scores {
    let episodes = campaign.episodes as usize;
    let group = campaign.first_group();
    let width = group.channels().len();
    let rows = episodes * group.team * width;
    let controllers = 0..campaign.controllers.len();
    let errors = |controller: usize| -> Vec<f64> {
        let of = |row: usize| outcome(controller, row / (group.team * width), row % width).1;
        (0..rows).map(of).collect()
    };
    let status = |controller: usize| -> Vec<Status> {
        let of = |episode: usize| outcome(controller, episode, 0).0;
        (0..episodes).map(of).collect()
    };
    let status: Vec<Vec<Status>> = controllers.clone().map(status).collect();
    let rmse: Vec<Vec<f64>> = controllers.map(errors).collect();
    Scores {
        status: status.clone(),
        groups: vec![GroupScores {
            failed_step: vec![vec![None; episodes * group.team]; rmse.len()],
            channel_groups: vec![Vec::new(); rmse.len()],
            max_abs: rmse.clone(),
            status,
            rmse,
        }],
        fault_occurs: vec![vec![false; episodes]; group.faults.len()],
        conditions: Vec::new(),
    }
}
