//! A table of a run, read back.

use super::error::OutputError;
use super::integrity::files_of;
use polars::prelude::{
    Column as PolarsColumn, DataFrame, DataType, ParquetReader, PolarsResult, SerReader,
};
use std::collections::HashMap;
use std::fs::File;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// A table by columns. A column that the table does not have is empty cells: tables of other versions are read as far
/// as they go.
#[derive(Debug, Default)]
pub(crate) struct TableReader {
    names: Vec<String>,
    columns: HashMap<String, Column>,
    rows: usize,
}

#[derive(Debug)]
enum Column {
    /// Numbers and flags; not a number where the cell is empty.
    Reals(Vec<f64>),
    /// Few different texts, and which of them each row has.
    Texts(Vec<String>, Vec<u32>),
}

impl TableReader {
    /// Reads `<dir>/<name>.parquet`, a file or a folder of files, of all columns those that are `wanted`; none if there
    /// is none.
    ///
    /// # Errors
    /// If a file is not a table.
    pub(crate) fn read(
        dir: &Path,
        name: &str,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Option<Self>, OutputError> {
        Self::read_rows(dir, name, 0..usize::MAX, wanted)
    }

    /// The same of some of its rows.
    ///
    /// # Errors
    /// As [`TableReader::read`].
    pub(crate) fn read_rows(
        dir: &Path,
        name: &str,
        rows: Range<usize>,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Option<Self>, OutputError> {
        let no_run = |reason: String| OutputError::NoRun {
            path: dir.to_path_buf(),
            reason: format!("{name}.parquet: {reason}"),
        };
        let names = files_of(dir, &format!("{name}.parquet"));
        let opened = names.and_then(|names| {
            let files = names.iter().map(|name| File::open(dir.join(name)));
            files.collect::<std::io::Result<Vec<File>>>()
        });
        let files = opened.map_err(|error| no_run(error.to_string()))?;
        if files.is_empty() {
            return Ok(None);
        }
        // The library that reads Parquet panics at some files that are damaged.
        let parsed = catch_unwind(AssertUnwindSafe(|| Self::parse(files, rows, wanted)));
        let reason = match parsed {
            Ok(Ok(table)) => return Ok(Some(table)),
            Ok(Err(error)) => error.to_string(),
            Err(_) => "it is no whole Parquet file".to_string(),
        };
        Err(no_run(reason))
    }

    fn parse(
        files: Vec<File>,
        rows: Range<usize>,
        wanted: impl Fn(&str) -> bool,
    ) -> PolarsResult<Self> {
        let (mut first, mut all) = (0, DataFrame::empty());
        for (number, file) in files.into_iter().enumerate() {
            let mut reader = ParquetReader::new(file);
            let schema = reader.schema()?;
            let names = schema.iter_names().map(ToString::to_string);
            let names: Vec<String> = names.filter(|name| wanted(name)).collect();
            let end = first + reader.num_rows()?;
            let own = rows.start.clamp(first, end)..rows.end.clamp(first, end);
            let slice = Some((own.start - first, own.len()));
            // The first file says which columns there are, whether or not its rows are wanted.
            if number == 0 || !own.is_empty() {
                let reader = reader.with_columns(Some(names)).with_slice(slice);
                let frame = reader.finish()?;
                match number {
                    0 => all = frame,
                    _ => {
                        all.vstack_mut_owned(frame)?;
                    }
                }
            }
            first = end;
        }
        Self::of(&all)
    }

    /// A table at hand.
    ///
    /// # Errors
    /// If a column holds neither numbers nor flags nor texts.
    pub(crate) fn of(frame: &DataFrame) -> PolarsResult<Self> {
        let names = frame.get_column_names().into_iter();
        let names: Vec<String> = names.map(ToString::to_string).collect();
        let mut columns = HashMap::new();
        for name in &names {
            columns.insert(name.clone(), column(frame.column(name)?)?);
        }
        Ok(Self {
            names,
            columns,
            rows: frame.height(),
        })
    }

    /// The rows, counted.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// The names of the columns, in order.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// A number of a row; not a number where the cell is empty.
    pub(crate) fn real(&self, row: usize, name: &str) -> f64 {
        match self.columns.get(name) {
            Some(Column::Reals(values)) => values.get(row).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        }
    }

    /// Whether a number of a row is this whole one.
    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    #[expect(clippy::float_cmp, reason = "whole numbers are exact")]
    pub(crate) fn is_whole(&self, row: usize, name: &str, value: usize) -> bool {
        self.real(row, name) == value as f64
    }

    /// A cell as a text.
    pub(crate) fn shown(&self, row: usize, name: &str) -> String {
        match self.columns.get(name) {
            Some(Column::Texts(..)) => format!("{:?}", self.text(row, name)),
            _ => self.real(row, name).to_string(),
        }
    }

    /// The row and the column of the first cell that is not the same in another table, among the columns that both
    /// have; empty cells are alike.
    pub(crate) fn difference<'a>(&'a self, other: &Self) -> Option<(usize, &'a str)> {
        let common = self.names.iter().filter(|name| other.names.contains(name));
        let mut cells = common.flat_map(|name| (0..self.rows).map(move |row| (row, name.as_str())));
        cells.find(|&(row, name)| {
            let [own, there] = [self, other].map(|table| table.real(row, name));
            let are_alike = own.to_bits() == there.to_bits() || own.is_nan() && there.is_nan();
            let is_there = row < other.rows;
            !is_there || !are_alike || self.text(row, name) != other.text(row, name)
        })
    }

    /// A text of a row.
    pub(crate) fn text(&self, row: usize, name: &str) -> &str {
        match self.columns.get(name) {
            Some(Column::Texts(texts, rows)) => {
                let text = rows.get(row).and_then(|place| texts.get(*place as usize));
                text.map_or("", String::as_str)
            }
            _ => "",
        }
    }

    /// The rows whose text columns have these values.
    pub(crate) fn find<'a>(
        &'a self,
        wanted: &'a [(&'a str, &'a str)],
    ) -> impl Iterator<Item = usize> + 'a {
        (0..self.rows).filter(move |&row| {
            wanted
                .iter()
                .all(|(name, value)| self.text(row, name) == *value)
        })
    }
}

fn column(column: &PolarsColumn) -> PolarsResult<Column> {
    if column.dtype() == &DataType::String {
        let (mut texts, mut known) = (Vec::new(), HashMap::new());
        let place = |text: Option<&str>| {
            let text = text.unwrap_or_default();
            if let Some(place) = known.get(text) {
                return *place;
            }
            let place = u32::try_from(texts.len()).unwrap_or(u32::MAX);
            texts.push(text.to_string());
            known.insert(text.to_string(), place);
            place
        };
        let rows = column.str()?.iter().map(place).collect();
        return Ok(Column::Texts(texts, rows));
    }
    let reals = column.cast(&DataType::Float64)?;
    let reals = reals.f64()?.iter();
    Ok(Column::Reals(
        reals.map(|value| value.unwrap_or(f64::NAN)).collect(),
    ))
}
