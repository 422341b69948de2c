//! The tables of a run as files.

use super::directory::OutputDir;
use super::error::OutputError;
use super::file_names::piece;
use super::labels::Labels;
use super::table_file::{ROW_GROUP, TableFile};
use crate::campaign::Campaign;
use crate::results::files::{Found, RUN_TABLES, Rows};
use crate::results::table::Table;
use crate::results::tables::Tables;
use polars::prelude::DataFrame;
use std::time::{Duration, Instant};

/// Rows of a file of a large table, at most: those that have more are a folder of such files, which the readers of
/// Parquet take as one table. A file of channels is about 250 MB.
pub(super) const FILE_ROWS: usize = 32 * ROW_GROUP;

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
    /// Rows of a file of Parquet, at most.
    file_rows: usize,
    /// By the place among all tables; none as long as there is no row.
    files: Vec<Option<LargeTable>>,
    /// What writing took.
    took: Duration,
}

/// The files of a table that grows.
struct LargeTable {
    /// The one that is being written, and its rows so far.
    parquet: TableFile,
    rows: usize,
    /// Files of the table that are whole.
    whole: usize,
    csv: Option<TableFile>,
}

impl<'a> LargeTables<'a> {
    pub(super) fn new(
        campaign: &'a Campaign,
        out: &'a OutputDir,
        csv: bool,
        file_rows: usize,
    ) -> Self {
        let files = RUN_TABLES.iter().map(|_| None).collect();
        Self {
            campaign,
            out,
            csv,
            file_rows,
            files,
            took: Duration::ZERO,
        }
    }

    /// Writes what fills groups of rows, and takes it out of memory.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn take(&mut self, tables: &mut Tables) -> Result<(), OutputError> {
        self.take_from(tables, ROW_GROUP)
    }

    /// Writes what is left, and gives the files their names; how long writing took in all.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(super) fn finish(mut self, tables: &mut Tables) -> Result<Duration, OutputError> {
        self.take_from(tables, 1)?;
        let start = Instant::now();
        for (run_table, files) in RUN_TABLES.iter().zip(self.files) {
            let Some(files) = files else { continue };
            files.parquet.finish()?;
            files.csv.map_or(Ok(()), TableFile::finish)?;
            if files.whole > 0 {
                self.out
                    .sync_folder(&format!("{}.parquet", run_table.name))?;
            }
        }
        Ok(self.took + start.elapsed())
    }

    /// Writes groups of rows as long as there are so many.
    fn take_from(&mut self, tables: &mut Tables, fewest: usize) -> Result<(), OutputError> {
        for (place, run_table) in RUN_TABLES.iter().enumerate() {
            let Rows::Large(of) = run_table.rows else {
                continue;
            };
            let table = of(tables);
            while table.rows() >= fewest {
                let front = table.split_front(ROW_GROUP.min(self.file_rows));
                let start = Instant::now();
                self.write(place, run_table.name, &front)?;
                self.took += start.elapsed();
            }
        }
        Ok(())
    }

    fn write(&mut self, place: usize, name: &'static str, rows: &Table) -> Result<(), OutputError> {
        let frame = self.out.frame(name, rows)?;
        let files = match self.files[place].take() {
            Some(files) if files.rows + frame.height() > self.file_rows => {
                self.next_file(files, name, &frame)?
            }
            Some(files) => files,
            None => {
                let labels = Labels::new(self.campaign, name);
                let parquet = format!("{name}.parquet");
                let csv = self.csv.then(|| self.out.csv(&format!("{name}.csv")));
                LargeTable {
                    parquet: self.out.parquet(&parquet, &frame, &labels)?,
                    rows: 0,
                    whole: 0,
                    csv: csv.transpose()?,
                }
            }
        };
        let files = self.files[place].insert(files);
        files.rows += frame.height();
        files.parquet.write(&frame)?;
        let csv = files.csv.as_mut();
        csv.map_or(Ok(()), |csv| csv.write(&frame))
    }

    /// Ends the file of a table that takes no more rows, and begins the next.
    fn next_file(
        &self,
        files: LargeTable,
        name: &'static str,
        first: &DataFrame,
    ) -> Result<LargeTable, OutputError> {
        files.parquet.finish()?;
        let folder = format!("{name}.parquet");
        if files.whole == 0 {
            self.out.make_folder(&folder, &piece(0))?;
        }
        let whole = files.whole + 1;
        let labels = Labels::new(self.campaign, name);
        let folder = self.out.folder(&folder);
        Ok(LargeTable {
            parquet: folder.parquet(&piece(whole), first, &labels)?,
            rows: 0,
            whole,
            csv: files.csv,
        })
    }
}
