//! The scores of a run, read back from its tables.

use super::table_reader::TableReader;
use crate::campaign::{AgentGroup, Campaign};
use crate::results::scores::{AgentScores, ChannelScores, Scores, Status};

/// What the tables of a run say about its first episodes, as the run had it; of the conditions of the ranking nothing,
/// and of the recovery nothing.
///
/// # Errors
/// If the rows are not those of the campaign's episodes, in order.
pub(super) fn scores_of_run(
    campaign: &Campaign,
    [episodes, channels]: [&TableReader; 2],
    count: usize,
) -> Result<Scores, String> {
    let mut scores = Scores::new(campaign);
    scores.fault_occurs = vec![vec![false; count]; campaign.faults().count()];
    let (mut agent_row, mut channel_row) = (0, 0);
    for episode in 0..count {
        for (controller, name) in campaign.controllers.iter().enumerate() {
            let mut groups = Vec::new();
            for group in campaign.groups() {
                let rows = Rows {
                    campaign,
                    group,
                    key: (episode, name),
                    agents: agent_row,
                    channels: channel_row,
                };
                groups.push(rows.read(episodes, channels)?);
                for fault in 0..group.faults.len() {
                    let number = group.first_fault + fault;
                    let column = format!("fault{number}_occurs");
                    let mut agents = agent_row..agent_row + group.team;
                    let occurs = agents.any(|row| episodes.is_whole(row, &column, 1));
                    scores.fault_occurs[number][episode] |= occurs;
                }
                agent_row += group.team;
                channel_row += group.team * group.channels().len();
            }
            scores.add(campaign, controller, &groups);
        }
    }
    Ok(scores)
}

/// The rows of a group of agents in an episode under a controller.
struct Rows<'a> {
    campaign: &'a Campaign,
    group: &'a AgentGroup,
    /// The episode and the controller.
    key: (usize, &'a str),
    /// The first row in the table of episodes.
    agents: usize,
    /// The first row in the table of channels.
    channels: usize,
}

impl Rows<'_> {
    /// How the agents fared.
    fn read(
        &self,
        episodes: &TableReader,
        channels: &TableReader,
    ) -> Result<Vec<AgentScores>, String> {
        let (team, width) = (self.group.team, self.group.channels().len());
        let of_agent = |place: usize| {
            let row = self.agents + place;
            self.is_of(episodes, "episodes", row, place)?;
            let status = status(episodes.text(row, "status"))
                .ok_or_else(|| format!("episodes.parquet, row {row}: no status"))?;
            let failed_at_s = episodes.real(row, "failed_at_s");
            let step = || self.campaign.time.onset_step(failed_at_s);
            let of_channel = |channel: usize| {
                let row = self.channels + place * width + channel;
                self.is_of(channels, "channels", row, place)?;
                let of = |name: &str| channels.real(row, name);
                let settling_s = of("settling_s");
                Ok(ChannelScores {
                    rmse: of("rmse"),
                    max_abs: of("max_abs"),
                    peak: of("u_max"),
                    effort: of("effort"),
                    saturated: of("saturated_fraction"),
                    settling_s: if settling_s.is_nan() {
                        f64::INFINITY
                    } else {
                        settling_s
                    },
                    recovery_s: None,
                })
            };
            Ok(AgentScores {
                status,
                failed_step: failed_at_s.is_finite().then(step),
                channels: (0..width).map(of_channel).collect::<Result<_, String>>()?,
            })
        };
        (0..team).map(of_agent).collect()
    }

    /// That a row is the one that is expected there.
    fn is_of(
        &self,
        table: &TableReader,
        name: &str,
        row: usize,
        place: usize,
    ) -> Result<(), String> {
        let (episode, controller) = self.key;
        let agent = self.group.first_agent + place;
        let expected = table.is_whole(row, "episode", episode)
            && table.text(row, "controller") == controller
            && table.is_whole(row, "agent", agent);
        if expected {
            return Ok(());
        }
        Err(format!(
            "{name}.parquet, row {row}: not that of episode {episode}, {controller}, agent {agent}"
        ))
    }
}

/// The status of a word in the tables.
fn status(word: &str) -> Option<Status> {
    let all = [Status::Ok, Status::Exceeded, Status::Diverged];
    all.into_iter().find(|own| own.word() == word)
}
