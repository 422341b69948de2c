//! A table of a run, read back.

use super::error::OutputError;
use polars::prelude::{Column as PolarsColumn, DataType, ParquetReader, PolarsResult, SerReader};
use std::collections::HashMap;
use std::fs::File;
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
    /// Reads `<dir>/<name>.parquet`, of all columns those that are `wanted`; none if there is no such file.
    ///
    /// # Errors
    /// If the file is not a table.
    pub(crate) fn read(
        dir: &Path,
        name: &str,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Option<Self>, OutputError> {
        let path = dir.join(format!("{name}.parquet"));
        let Ok(file) = File::open(&path) else {
            return Ok(None);
        };
        // The library that reads Parquet panics at some files that are damaged.
        let parsed = catch_unwind(AssertUnwindSafe(|| Self::parse(file, wanted)));
        let reason = match parsed {
            Ok(Ok(table)) => return Ok(Some(table)),
            Ok(Err(error)) => error.to_string(),
            Err(_) => "it is no whole Parquet file".to_string(),
        };
        Err(OutputError::NoRun {
            path: dir.to_path_buf(),
            reason: format!("{name}.parquet: {reason}"),
        })
    }

    fn parse(file: File, wanted: impl Fn(&str) -> bool) -> PolarsResult<Self> {
        let mut reader = ParquetReader::new(file);
        let schema = reader.schema()?;
        let names: Vec<String> = schema
            .iter_names()
            .map(ToString::to_string)
            .filter(|name| wanted(name))
            .collect();
        let frame = reader.with_columns(Some(names.clone())).finish()?;
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
