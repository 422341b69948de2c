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
use std::sync::mpsc::Receiver;

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
    /// Rows that fill no group yet.
    rest: Tables,
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
            rest: Tables::new(campaign),
        }
    }

    /// Writes rows as they come, in groups, and gives the files their names when there are no more.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(super) fn write(mut self, pieces: Receiver<Tables>) -> Result<(), OutputError> {
        for mut piece in pieces {
            for run_table in RUN_TABLES {
                if let Rows::Large(of) = run_table.rows {
                    of(&mut self.rest).append(std::mem::take(of(&mut piece)));
                }
            }
            self.write_groups(ROW_GROUP)?;
        }
        self.write_groups(1)?;
        for (run_table, files) in RUN_TABLES.iter().zip(self.files) {
            let Some(files) = files else { continue };
            files.parquet.finish()?;
            files.csv.map_or(Ok(()), TableFile::finish)?;
            if files.whole > 0 {
                self.out
                    .sync_folder(&format!("{}.parquet", run_table.name))?;
            }
        }
        Ok(())
    }

    /// Writes groups of rows as long as there are so many.
    fn write_groups(&mut self, fewest: usize) -> Result<(), OutputError> {
        for (place, run_table) in RUN_TABLES.iter().enumerate() {
            let Rows::Large(of) = run_table.rows else {
                continue;
            };
            while of(&mut self.rest).rows() >= fewest {
                let group = ROW_GROUP.min(self.file_rows);
                let front = of(&mut self.rest).split_front(group);
                self.write_group(place, run_table.name, &front)?;
            }
        }
        Ok(())
    }

    fn write_group(
        &mut self,
        place: usize,
        name: &'static str,
        rows: &Table,
    ) -> Result<(), OutputError> {
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
