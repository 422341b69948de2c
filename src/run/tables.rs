//! The tables of a run as files.

use super::directory::OutputDir;
use super::error::OutputError;
use super::labels::Labels;
use super::table_file::{ROW_GROUP, TableFile};
use crate::campaign::Campaign;
use crate::results::files::{Found, RUN_TABLES, Rows};
use crate::results::table::Table;
use crate::results::tables::Tables;

/// Writes the tables that are made when all is known, as Parquet and as CSV.
pub(super) fn write_small(found: Found<'_>, out: &OutputDir) -> Result<(), OutputError> {
    for run_table in RUN_TABLES {
        let Rows::Small(make) = run_table.rows else {
            continue;
        };
        let (name, table) = (run_table.name, make(found));
        if table.is_empty() {
            continue;
        }
        let labels = Labels::new(found.campaign, name);
        out.write_parquet(&format!("{name}.parquet"), &table, &labels)?;
        out.write_csv(&format!("{name}.csv"), &table)?;
    }
    Ok(())
}

/// The files of the tables that grow with the episodes, while they grow.
pub(super) struct LargeTables<'a> {
    campaign: &'a Campaign,
    out: &'a OutputDir,
    /// Whether they are written as CSV too.
    csv: bool,
    /// Parquet, and CSV where that is asked for, by the place among all tables; none as long as there is no row.
    files: Vec<Option<(TableFile, Option<TableFile>)>>,
}

impl<'a> LargeTables<'a> {
    pub(super) fn new(campaign: &'a Campaign, out: &'a OutputDir, csv: bool) -> Self {
        let files = RUN_TABLES.iter().map(|_| None).collect();
        Self {
            campaign,
            out,
            csv,
            files,
        }
    }

    /// Writes what fills groups of rows, and takes it out of memory.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn take(&mut self, tables: &mut Tables) -> Result<(), OutputError> {
        self.take_from(tables, ROW_GROUP)
    }

    /// Writes what is left, and gives the files their names.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(super) fn finish(mut self, tables: &mut Tables) -> Result<(), OutputError> {
        self.take_from(tables, 1)?;
        for (parquet, csv) in self.files.into_iter().flatten() {
            parquet.finish()?;
            csv.map_or(Ok(()), TableFile::finish)?;
        }
        Ok(())
    }

    /// Writes groups of rows as long as there are so many.
    fn take_from(&mut self, tables: &mut Tables, fewest: usize) -> Result<(), OutputError> {
        for (place, run_table) in RUN_TABLES.iter().enumerate() {
            let Rows::Large(of) = run_table.rows else {
                continue;
            };
            let table = of(tables);
            while table.rows() >= fewest {
                let front = table.split_front(ROW_GROUP);
                self.write(place, run_table.name, &front)?;
            }
        }
        Ok(())
    }

    fn write(&mut self, place: usize, name: &'static str, rows: &Table) -> Result<(), OutputError> {
        let frame = self.out.frame(name, rows)?;
        let (parquet, csv) = match &mut self.files[place] {
            Some(files) => files,
            none => {
                let labels = Labels::new(self.campaign, name);
                let parquet = self
                    .out
                    .parquet(&format!("{name}.parquet"), &frame, &labels)?;
                let csv = self.csv.then(|| self.out.csv(&format!("{name}.csv")));
                none.insert((parquet, csv.transpose()?))
            }
        };
        parquet.write(&frame)?;
        csv.as_mut().map_or(Ok(()), |csv| csv.write(&frame))
    }
}
