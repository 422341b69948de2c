//! Whether an episode that was simulated again is the one of the run's tables.

use super::error::OutputError;
use super::table_reader::TableReader;
use crate::backend::EpisodeResult;
use crate::campaign::{AgentGroup, Campaign};
use crate::draw::draw;
use crate::model::episode::AgentOutcome;
use crate::results::tables::Tables;
use std::path::Path;

/// The first cell in which an episode, of which `outcomes[controller][agent]` are given, is not the one of a run's
/// tables; none if all cells are the same, or the run has no such tables.
///
/// # Errors
/// If a table cannot be read.
pub(super) fn difference(
    dir: &Path,
    campaign: &Campaign,
    episode: u32,
    outcomes: &[&[AgentOutcome]],
) -> Result<Option<String>, OutputError> {
    let of_group = |group: &AgentGroup| EpisodeResult {
        episode: draw(group, episode),
        outcomes: outcomes
            .iter()
            .map(|agents| agents[group.first_agent..][..group.team].to_vec())
            .collect(),
    };
    let groups: Vec<EpisodeResult> = campaign.groups().iter().map(of_group).collect();
    let mut tables = Tables::new(campaign);
    tables.add(campaign, &groups.iter().collect::<Vec<_>>());
    for (name, table) in [
        ("episodes", &tables.episodes),
        ("channels", &tables.channels),
    ] {
        let rows = table.rows();
        // Every episode has as many rows as any other.
        let first = rows.saturating_mul(episode as usize);
        let there = TableReader::read_rows(dir, name, first..first + rows, |_| true)?;
        let Some(there) = there.filter(|_| rows > 0) else {
            continue;
        };
        let own = table.to_frame().and_then(|frame| TableReader::of(&frame));
        let own = own.map_err(|source| OutputError::Table {
            path: dir.join(format!("{name}.parquet")),
            source,
        })?;
        if let Some((row, column)) = own.difference(&there) {
            let (agent, controller) = (own.shown(row, "agent"), own.text(row, "controller"));
            let [here, there] = [&own, &there].map(|table| table.shown(row, column));
            return Ok(Some(format!(
                "{name}.parquet has {column} = {there} where this has {here} (agent {agent} under {controller})"
            )));
        }
    }
    Ok(None)
}
