//! The tables of a run's directory: one row each says what a table is called, and what is in it.

use super::all::Results;
use super::columns::{comparison_table, fairness_table, screening_table, summary_table};
use super::flights::Flights;
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
    /// What was filled as batches ended.
    pub tables: &'a Tables,
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
        tables: &'a Tables,
        results: &'a Results,
        flights: &'a Flights,
    ) -> Self {
        Self {
            campaign,
            tables,
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
    /// Whether it grows with the episodes, so that it is written as CSV only if that is asked for.
    pub is_large: bool,
    /// Its rows and columns.
    pub make: for<'a> fn(Found<'a>) -> Cow<'a, Table>,
}

/// All tables, in the order of the README.
pub const RUN_TABLES: &[RunTable] = &[
    RunTable {
        name: "episodes",
        is_large: true,
        make: |found| Cow::Borrowed(&found.tables.episodes),
    },
    RunTable {
        name: "channels",
        is_large: true,
        make: |found| Cow::Borrowed(&found.tables.channels),
    },
    RunTable {
        name: "faults",
        is_large: true,
        make: |found| Cow::Borrowed(&found.tables.faults),
    },
    RunTable {
        name: "conditions",
        is_large: true,
        make: |found| Cow::Borrowed(&found.tables.conditions_drawn),
    },
    RunTable {
        name: "summary",
        is_large: false,
        make: |found| Cow::Owned(summary_table(&found.results.summary)),
    },
    RunTable {
        name: "fairness",
        is_large: false,
        make: |found| Cow::Owned(fairness_table(&found.results.terms)),
    },
    // One controller has nothing to be compared with.
    RunTable {
        name: "comparison",
        is_large: false,
        make: |found| Cow::Owned(comparison_table(found.campaign, &found.results.comparisons)),
    },
    // Without strata nothing is screened.
    RunTable {
        name: "screening",
        is_large: false,
        make: |found| Cow::Owned(screening_table(&found.results.screenings)),
    },
    // Where nothing varies, nothing is ranked.
    RunTable {
        name: "ranking",
        is_large: false,
        make: |found| Cow::Owned(ranking_table(&found.results.ranking)),
    },
    RunTable {
        name: "worst",
        is_large: false,
        make: |found| Cow::Owned(worst_table(&found.results.worst)),
    },
    RunTable {
        name: "flights",
        is_large: false,
        make: |found| Cow::Borrowed(&found.flights.table),
    },
];
