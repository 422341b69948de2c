//! All that the directory of a run holds: what a report is made of.

use super::page::document::LegendEntry;
use super::page::plot::Color;
use crate::campaign::{AgentGroup, Campaign, CampaignError};
use crate::controllers::{GainSet, GainsError};
use crate::run::error::OutputError;
use crate::run::manifest::Manifest;
use crate::run::table_reader::TableReader;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What a report reads of the table of channels.
const RMSE_COLUMNS: [&str; 6] = ["episode", "controller", "group", "agent", "channel", "rmse"];

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The directory holds no run, or cannot be written.
    #[error(transparent)]
    Run(#[from] OutputError),
    /// The run's campaign cannot be read any more.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The run's gains cannot be read any more.
    #[error(transparent)]
    Gains(#[from] GainsError),
}

/// A run, read back from its directory.
pub(crate) struct RunData {
    pub(crate) dir: PathBuf,
    pub(crate) manifest: Manifest,
    pub(crate) campaign: Campaign,
    /// Of each group of agents.
    pub(crate) gains: Vec<GainSet>,
    /// Outcomes and draws, by episode, controller and agent.
    pub(crate) episodes: TableReader,
    /// RMS errors, by episode, controller, agent and channel.
    pub(crate) channels: TableReader,
    pub(crate) summary: TableReader,
    pub(crate) comparison: TableReader,
    /// On what terms the controllers are compared.
    pub(crate) fairness: TableReader,
    pub(crate) screening: TableReader,
    pub(crate) ranking: TableReader,
    pub(crate) worst: TableReader,
    /// Error and command over time in two flights.
    pub(crate) flights: TableReader,
}

impl RunData {
    /// Reads a directory. Tables that a campaign does not have are empty.
    ///
    /// # Errors
    /// If there is no run, or a file of it is not what it should be.
    pub(crate) fn read(dir: &Path) -> Result<Self, ReportError> {
        let manifest = Manifest::read_verified(dir)?;
        let campaign = manifest.campaign()?;
        let gains = GainSet::read(&campaign, &dir.join("gains.json"))?;
        let all =
            |name: &str| TableReader::read(dir, name, |_| true).map(Option::unwrap_or_default);
        let needed = |name: &str, wanted: fn(&str) -> bool| {
            TableReader::read(dir, name, wanted)?.ok_or_else(|| OutputError::NoRun {
                path: dir.to_path_buf(),
                reason: format!("{name}.parquet is missing"),
            })
        };
        Ok(Self {
            episodes: needed("episodes", |_| true)?,
            channels: needed("channels", |name| RMSE_COLUMNS.contains(&name))?,
            summary: needed("summary", |_| true)?,
            comparison: all("comparison")?,
            fairness: all("fairness")?,
            screening: all("screening")?,
            ranking: all("ranking")?,
            worst: all("worst")?,
            flights: all("flights")?,
            dir: dir.to_path_buf(),
            manifest,
            campaign,
            gains,
        })
    }

    /// The controllers with their colours.
    pub(crate) fn legend(&self) -> Vec<LegendEntry> {
        let names = self.campaign.controllers.iter().enumerate();
        names
            .map(|(index, name)| LegendEntry::line(Color::Series(index), name))
            .collect()
    }

    /// The RMS over a group of agents of a column for each episode under each controller, `[controller][episode]`:
    /// infinite where an agent diverged. Rows that `wanted` refuses are left out.
    pub(crate) fn of_teams(
        &self,
        sheet: &TableReader,
        group: &AgentGroup,
        column: &str,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<Vec<f64>> {
        let episodes = self.manifest.episodes as usize;
        let team = group.team as f64;
        let mut squares = vec![vec![0.0; episodes]; self.campaign.controllers.len()];
        let of_group = |row: &usize| sheet.text(*row, "group") == &*group.name && wanted(*row);
        for row in (0..sheet.rows()).filter(of_group) {
            let controller = self.controller(sheet.text(row, "controller"));
            let Some(of_controller) = controller.and_then(|index| squares.get_mut(index)) else {
                continue;
            };
            let value = sheet.real(row, column);
            // An empty cell is a diverged agent.
            let value = if value.is_nan() { f64::INFINITY } else { value };
            if let Some(sum) = of_controller.get_mut(whole(sheet.real(row, "episode"))) {
                *sum += value * value / team;
            }
        }
        for values in &mut squares {
            values.iter_mut().for_each(|value| *value = value.sqrt());
        }
        squares
    }

    /// The place of a controller in the campaign.
    pub(crate) fn controller(&self, name: &str) -> Option<usize> {
        let mut names = self.campaign.controllers.iter();
        names.position(|own| **own == *name)
    }
}

/// A count that was read as a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "what is not a count becomes the largest one, which no table has"
)]
pub(crate) fn whole(value: f64) -> usize {
    if value >= 0.0 {
        value as usize
    } else {
        usize::MAX
    }
}
