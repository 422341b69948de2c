//! All that the directory of a run holds: what a report is made of.

use super::page::document::LegendEntry;
use super::page::plot::Color;
use crate::campaign::{Campaign, CampaignError};
use crate::controllers::{GainSet, GainsError};
use crate::run::error::OutputError;
use crate::run::manifest::Manifest;
use crate::run::table_reader::TableReader;
use std::path::{Path, PathBuf};
use thiserror::Error;

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
    pub(crate) summary: TableReader,
    pub(crate) comparison: TableReader,
    /// On what terms the controllers are compared.
    pub(crate) fairness: TableReader,
    pub(crate) screening: TableReader,
    pub(crate) ranking: TableReader,
    pub(crate) worst: TableReader,
    /// Distributions, survival and bands; empty in runs of older versions.
    pub(crate) curves: TableReader,
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
        let needed = |name: &str| {
            TableReader::read(dir, name, |_| true)?.ok_or_else(|| OutputError::NoRun {
                path: dir.to_path_buf(),
                reason: format!("{name}.parquet is missing"),
            })
        };
        Ok(Self {
            summary: needed("summary")?,
            comparison: all("comparison")?,
            fairness: all("fairness")?,
            screening: all("screening")?,
            ranking: all("ranking")?,
            worst: all("worst")?,
            curves: all("curves")?,
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

    /// Whether it has curves: runs of older versions have none.
    pub(crate) fn has_curves(&self) -> bool {
        self.curves.rows() > 0
    }

    /// The points of a curve of each controller, on channels where it is of some.
    pub(crate) fn points(&self, curve: &str, group: Option<&str>) -> Vec<Vec<(f64, f64)>> {
        let point = |row: &usize| (self.curves.real(*row, "x"), self.curves.real(*row, "y"));
        let rows = self.rows_of_curve(curve, group);
        rows.iter()
            .map(|rows| rows.iter().map(point).collect())
            .collect()
    }

    /// The rows of a curve of each controller, on channels where it is of some.
    pub(crate) fn rows_of_curve(&self, curve: &str, group: Option<&str>) -> Vec<Vec<usize>> {
        let of_controller = |name: &String| {
            let wanted = [("curve", curve), ("controller", name)];
            let rows = self.curves.find(&wanted);
            let of_group =
                |row: &usize| group.is_none_or(|own| self.curves.text(*row, "group") == own);
            rows.filter(of_group).collect()
        };
        self.campaign
            .controllers
            .iter()
            .map(of_controller)
            .collect()
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
