//! The tables of a run as files.

use super::directory::OutputDir;
use super::error::{OutputError, TABLES};
use crate::campaign::Campaign;
use crate::results::sensitivity::{ranking_table, worst_table};
use crate::results::table::Table;
use crate::results::tables::Tables;
use crate::results::{Results, comparison_table, screening_table, summary_table};

/// The tables that are large: written as CSV only if that is asked for.
const LARGE: usize = 2;

/// Writes the tables of a run as Parquet, and the small ones as CSV too; `csv` is whether the large ones are.
pub(super) fn write(
    campaign: &Campaign,
    tables: &Tables,
    results: &Results,
    csv: bool,
    out: &OutputDir,
) -> Result<(), OutputError> {
    // In the order of `TABLES`, which says what they are called.
    let contents: [&Table; TABLES.len()] = [
        &tables.episodes,
        &tables.channels,
        &summary_table(&results.summary),
        &comparison_table(campaign, &results.comparisons),
        &screening_table(&results.screenings),
        &ranking_table(&results.ranking),
        &worst_table(&results.worst),
    ];
    for (k, (name, table)) in TABLES.into_iter().zip(contents).enumerate() {
        // One controller has nothing to be compared with; without strata nothing is screened; where nothing varies,
        // nothing is ranked.
        if table.is_empty() {
            continue;
        }
        out.write_parquet(&format!("{name}.parquet"), table)?;
        if csv || k >= LARGE {
            out.write_csv(&format!("{name}.csv"), table)?;
        }
    }
    Ok(())
}
