//! The scores of a run, read back from its tables.

use super::table_reader::TableReader;
use crate::agent::ChannelGroup;
use crate::campaign::{AgentGroup, Campaign};
use crate::results::scores::{ChannelGroupScores, ChannelScores, GroupScores, Scores, Status};

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
    let controllers = campaign.controllers.len();
    let mut scores = Scores {
        status: vec![Vec::new(); controllers],
        groups: vec![GroupScores::new(controllers); campaign.groups().len()],
        fault_occurs: vec![vec![false; count]; campaign.faults().count()],
        conditions: Vec::new(),
    };
    let (mut agent_row, mut channel_row) = (0, 0);
    for episode in 0..count {
        for (controller, name) in campaign.controllers.iter().enumerate() {
            let mut worst = Status::Ok;
            for (index, group) in campaign.groups().iter().enumerate() {
                let rows = Rows {
                    campaign,
                    group,
                    key: (episode, name),
                    agents: agent_row,
                    channels: channel_row,
                };
                let own = &mut scores.groups[index];
                worst = worst.max(rows.read(episodes, channels, controller, own)?);
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
            scores.status[controller].push(worst);
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
    /// Adds them to the scores of the group; the worst status of its agents.
    fn read(
        &self,
        episodes: &TableReader,
        channels: &TableReader,
        controller: usize,
        scores: &mut GroupScores,
    ) -> Result<Status, String> {
        let (team, width) = (self.group.team, self.group.channels().len());
        let mut worst = Status::Ok;
        for place in 0..team {
            let row = self.agents + place;
            self.is_of(episodes, "episodes", row, place)?;
            let status = status(episodes.text(row, "status"))
                .ok_or_else(|| format!("episodes.parquet, row {row}: no status"))?;
            worst = worst.max(status);
            let failed_at_s = episodes.real(row, "failed_at_s");
            let step = || self.campaign.time.onset_step(failed_at_s);
            scores.failed_step[controller].push(failed_at_s.is_finite().then(step));
            for channel in 0..width {
                let row = self.channels + place * width + channel;
                self.is_of(channels, "channels", row, place)?;
                scores.rmse[controller].push(channels.real(row, "rmse"));
                scores.max_abs[controller].push(channels.real(row, "max_abs"));
            }
        }
        scores.status[controller].push(worst);
        for ChannelGroup { channels: own, .. } in self.group.channel_groups() {
            let rows = (0..team).flat_map(|place| {
                own.clone()
                    .map(move |channel| self.channels + place * width + channel)
            });
            let of_row = |row| {
                let of = |name: &str| channels.real(row, name);
                let settling_s = of("settling_s");
                ChannelScores {
                    peak: of("u_max"),
                    effort: of("effort"),
                    saturated: of("saturated_fraction"),
                    settling_s: if settling_s.is_nan() {
                        f64::INFINITY
                    } else {
                        settling_s
                    },
                    recovery_s: None,
                }
            };
            scores.channel_groups[controller].push(match worst {
                Status::Diverged => ChannelGroupScores::DIVERGED,
                Status::Ok | Status::Exceeded => ChannelGroupScores::of(rows.map(of_row)),
            });
        }
        Ok(worst)
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
