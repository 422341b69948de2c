//! The tables of a run's directory: one row each says what a table is called, and what is in it.

use super::all::Results;
use super::columns::{comparison_table, fairness_table, screening_table, summary_table};
use super::curves::curves_table;
use super::flights::Flights;
use super::scores::Scores;
use super::sensitivity::{ranking_table, worst_table};
use super::table::Table;
use super::tables::Tables;
use crate::campaign::Campaign;
use std::borrow::Cow;

/// What tables are made of.
#[derive(Debug, Clone, Copy)]
pub struct Found<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// How its episodes ended.
    pub scores: &'a Scores,
    /// Every statistic on it.
    pub results: &'a Results,
    /// Flights that were simulated again.
    pub flights: &'a Flights,
}

impl<'a> Found<'a> {
    /// What a campaign's run has found.
    #[must_use]
    pub fn new(
        campaign: &'a Campaign,
        scores: &'a Scores,
        results: &'a Results,
        flights: &'a Flights,
    ) -> Self {
        Self {
            campaign,
            scores,
            results,
            flights,
        }
    }
}

/// A table of a run. Not every run has all of them: a table without rows is left out.
#[derive(Debug, Clone, Copy)]
pub struct RunTable {
    /// Its file's name without the extension.
    pub name: &'static str,
    /// Its rows and columns.
    pub rows: Rows,
}

/// Where the rows of a table are from.
#[derive(Debug, Clone, Copy)]
pub enum Rows {
    /// Filled episode by episode: it grows with them, so it is written piece by piece, as CSV only if that is asked
    /// for, and not at all if `[output] detail` leaves it out.
    Large(fn(&mut Tables) -> &mut Table),
    /// Made when all is known.
    Small(for<'a> fn(Found<'a>) -> Cow<'a, Table>),
}

/// All tables, in the order of the README.
pub const RUN_TABLES: &[RunTable] = &[
    RunTable {
        name: "episodes",
        rows: Rows::Large(|tables| &mut tables.episodes),
    },
    RunTable {
        name: "channels",
        rows: Rows::Large(|tables| &mut tables.channels),
    },
    RunTable {
        name: "faults",
        rows: Rows::Large(|tables| &mut tables.faults),
    },
    RunTable {
        name: "conditions",
        rows: Rows::Large(|tables| &mut tables.conditions_drawn),
    },
    RunTable {
        name: "summary",
        rows: Rows::Small(|found| Cow::Owned(summary_table(&found.results.summary))),
    },
    RunTable {
        name: "fairness",
        rows: Rows::Small(|found| Cow::Owned(fairness_table(&found.results.terms))),
    },
    // One controller has nothing to be compared with.
    RunTable {
        name: "comparison",
        rows: Rows::Small(|found| {
            Cow::Owned(comparison_table(found.campaign, &found.results.comparisons))
        }),
    },
    // Without strata nothing is screened.
    RunTable {
        name: "screening",
        rows: Rows::Small(|found| Cow::Owned(screening_table(&found.results.screenings))),
    },
    // Where nothing varies, nothing is ranked.
    RunTable {
        name: "ranking",
        rows: Rows::Small(|found| Cow::Owned(ranking_table(&found.results.ranking))),
    },
    RunTable {
        name: "worst",
        rows: Rows::Small(|found| Cow::Owned(worst_table(&found.results.worst))),
    },
    RunTable {
        name: "curves",
        rows: Rows::Small(|found| {
            let ranking = &found.results.ranking;
            Cow::Owned(curves_table(found.campaign, found.scores, ranking))
        }),
    },
    RunTable {
        name: "flights",
        rows: Rows::Small(|found| Cow::Borrowed(&found.flights.table)),
    },
];
