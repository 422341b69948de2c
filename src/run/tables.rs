//! The tables of a run as files.

use super::directory::OutputDir;
use super::error::OutputError;
use super::labels::Labels;
use crate::results::files::{Found, RUN_TABLES};

/// Writes the tables of a run as Parquet, and the small ones as CSV too; `csv` is whether the large ones are.
pub(super) fn write(found: Found<'_>, csv: bool, out: &OutputDir) -> Result<(), OutputError> {
    for run_table in RUN_TABLES {
        let (name, table) = (run_table.name, (run_table.make)(found));
        if table.is_empty() {
            continue;
        }
        let labels = Labels::new(found.campaign, name);
        out.write_parquet(&format!("{name}.parquet"), &table, &labels)?;
        if csv || !run_table.is_large {
            out.write_csv(&format!("{name}.csv"), &table)?;
        }
    }
    Ok(())
}
