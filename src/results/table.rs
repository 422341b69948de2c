//! A table that grows row by row.

use polars::prelude::{
    Column, DataFrame, Float64Chunked, IntoColumn, NamedFrom, NewChunkedArray, PlSmallStr,
    PolarsError, Series,
};
use std::sync::Arc;

/// A table under construction: columns are made by the first row, and every row fills them in the same order.
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: Vec<(String, Values)>,
}

/// A column under construction. A real that is not a number stands for "does not apply" and becomes a null.
#[derive(Debug, Clone)]
enum Values {
    Real(Vec<f64>),
    Count(Vec<u64>),
    Word(Vec<&'static str>),
    Name(Vec<Arc<str>>),
    Flag(Vec<bool>),
}

/// A row being added to a [`Table`].
pub struct Row<'a> {
    table: &'a mut Table,
    next: usize,
}

macro_rules! cell {
    ($(#[$doc:meta])* $method:ident, $variant:ident, $value:ty) => {
        $(#[$doc])*
        pub fn $method(&mut self, name: impl FnOnce() -> String, value: $value) -> &mut Self {
            if self.next == self.table.columns.len() {
                self.table.columns.push((name(), Values::$variant(Vec::new())));
            }
            if let Some((_, Values::$variant(values))) = self.table.columns.get_mut(self.next) {
                values.push(value);
            }
            self.next += 1;
            self
        }
    };
}

impl Row<'_> {
    cell!(/// A real number; not a number where it does not apply.
        real, Real, f64);
    cell!(/// A number of things.
        count, Count, u64);
    cell!(/// A word of a fixed list.
        word, Word, &'static str);
    cell!(/// A name.
        name, Name, Arc<str>);
    cell!(/// Yes or no.
        flag, Flag, bool);

    /// A real number where it applies.
    pub fn real_if(&mut self, name: &str, value: Option<f64>) -> &mut Self {
        self.real(|| name.to_string(), value.unwrap_or(f64::NAN))
    }
}

impl Table {
    /// Begins a row.
    pub fn row(&mut self) -> Row<'_> {
        Row {
            table: self,
            next: 0,
        }
    }

    /// Whether no row was begun.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The finished table.
    ///
    /// # Errors
    /// If the rows did not all fill the same columns.
    pub fn to_frame(&self) -> Result<DataFrame, PolarsError> {
        let columns = self.columns.iter().map(|(name, values)| {
            let name = PlSmallStr::from_str(name);
            match values {
                Values::Real(values) => {
                    let present = values
                        .iter()
                        .map(|value| (!value.is_nan()).then_some(*value));
                    Float64Chunked::from_iter_options(name, present).into_column()
                }
                Values::Count(values) => Series::new(name, values).into_column(),
                Values::Word(values) => Series::new(name, values).into_column(),
                Values::Name(values) => {
                    let names: Vec<&str> = values.iter().map(AsRef::as_ref).collect();
                    Series::new(name, names).into_column()
                }
                Values::Flag(values) => Series::new(name, values).into_column(),
            }
        });
        DataFrame::new_infer_height(columns.collect::<Vec<Column>>())
    }
}
