//! A table that grows row by row.

use polars::prelude::{
    Column, DataFrame, Float64Chunked, Int64Chunked, IntoColumn, NamedFrom, NewChunkedArray,
    PlSmallStr, PolarsError, Series,
};
use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;

/// A table under construction. The first row of a kind says which columns its cells fill; all others of that kind fill
/// the same in the same order. Most tables have rows of one kind; columns that a row's kind lacks are empty there.
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: Vec<(String, Values)>,
    /// Of each kind of rows, the columns of its cells.
    kinds: Vec<Vec<usize>>,
    rows: usize,
}

/// A column under construction. A real that is not a number and an empty name stand for "does not apply" and become a
/// null.
#[derive(Debug, Clone)]
enum Values {
    Real(Vec<f64>),
    Count(Vec<Option<u64>>),
    Word(Vec<Option<&'static str>>),
    Name(Vec<Option<Arc<str>>>),
    Flag(Vec<Option<bool>>),
}

impl Values {
    /// Takes away the first cells.
    fn split_front(&mut self, count: usize) -> Self {
        fn split<T>(values: &mut Vec<T>, count: usize) -> Vec<T> {
            let rest = values.split_off(count.min(values.len()));
            std::mem::replace(values, rest)
        }
        match self {
            Self::Real(values) => Self::Real(split(values, count)),
            Self::Count(values) => Self::Count(split(values, count)),
            Self::Word(values) => Self::Word(split(values, count)),
            Self::Name(values) => Self::Name(split(values, count)),
            Self::Flag(values) => Self::Flag(split(values, count)),
        }
    }

    /// Adds the cells of a column of the same type.
    fn append(&mut self, next: &mut Self) {
        match (self, next) {
            (Self::Real(own), Self::Real(next)) => own.append(next),
            (Self::Count(own), Self::Count(next)) => own.append(next),
            (Self::Word(own), Self::Word(next)) => own.append(next),
            (Self::Name(own), Self::Name(next)) => own.append(next),
            (Self::Flag(own), Self::Flag(next)) => own.append(next),
            // One column has one type wherever it is filled.
            _ => {}
        }
    }

    /// Adds empty cells up to a number of rows.
    fn fill(&mut self, rows: usize) {
        match self {
            Self::Real(values) => values.resize(rows, f64::NAN),
            Self::Count(values) => values.resize(rows, None),
            Self::Word(values) => values.resize(rows, None),
            Self::Name(values) => values.resize(rows, None),
            Self::Flag(values) => values.resize(rows, None),
        }
    }
}

/// A row being added to a [`Table`].
pub struct Row<'a> {
    table: &'a mut Table,
    kind: usize,
    next: usize,
}

macro_rules! cell {
    ($(#[$doc:meta])* $method:ident, $variant:ident, $value:ty, $cell:expr) => {
        $(#[$doc])*
        pub fn $method(&mut self, name: impl FnOnce() -> String, value: $value) -> &mut Self {
            let column = self.column(name, || Values::$variant(Vec::new()));
            if let Values::$variant(values) = column {
                values.push($cell(value));
            }
            self
        }
    };
}

impl Row<'_> {
    cell!(/// A real number; not a number where it does not apply.
        real, Real, f64, |value| value);
    cell!(/// A number of things.
        count, Count, u64, Some);
    cell!(/// A word of a fixed list.
        word, Word, &'static str, Some);
    cell!(/// A name; an empty one where none applies.
        name, Name, Arc<str>, Some);
    cell!(/// Yes or no.
        flag, Flag, bool, Some);

    /// The column of the next cell.
    fn column(
        &mut self,
        name: impl FnOnce() -> String,
        empty: impl FnOnce() -> Values,
    ) -> &mut Values {
        let Table {
            columns,
            kinds,
            rows,
        } = &mut *self.table;
        let of_kind = &mut kinds[self.kind];
        if self.next == of_kind.len() {
            let name = name();
            let known = columns.iter().position(|(own, _)| *own == name);
            of_kind.push(known.unwrap_or(columns.len()));
            if known.is_none() {
                let mut values = empty();
                values.fill(*rows - 1);
                columns.push((name, values));
            }
        }
        self.next += 1;
        &mut columns[of_kind[self.next - 1]].1
    }

    /// A real number where it applies.
    pub fn real_if(&mut self, name: &str, value: Option<f64>) -> &mut Self {
        self.real(|| name.to_string(), value.unwrap_or(f64::NAN))
    }
}

impl Table {
    /// Begins a row.
    pub fn row(&mut self) -> Row<'_> {
        self.row_of(0)
    }

    /// Begins a row of one of several kinds.
    pub fn row_of(&mut self, kind: usize) -> Row<'_> {
        let kinds = self.kinds.len().max(kind + 1);
        self.kinds.resize(kinds, Vec::new());
        if kinds > 1 {
            let rows = self.rows;
            self.columns.iter_mut().for_each(|(_, own)| own.fill(rows));
        }
        self.rows += 1;
        Row {
            table: self,
            kind,
            next: 0,
        }
    }

    /// Whether no row was begun.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Rows so far.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// How many real numbers there are in all columns, each counted once in a column.
    #[must_use]
    pub(super) fn different_numbers(&self) -> usize {
        let of_column = |(_, values): &(String, Values)| match values {
            Values::Real(values) => {
                let given = values.iter().filter(|own| !own.is_nan());
                given
                    .map(|own| own.to_bits())
                    .collect::<HashSet<u64>>()
                    .len()
            }
            Values::Count(_) | Values::Word(_) | Values::Name(_) | Values::Flag(_) => 0,
        };
        self.columns.iter().map(of_column).sum()
    }

    /// Adds the rows of another table, whose kinds of rows fill the same columns in the same order.
    pub fn append(&mut self, mut next: Self) {
        if next.is_empty() {
            return;
        }
        if self.columns.is_empty() {
            *self = next;
            return;
        }
        let rows = [self.rows, next.rows];
        for ((_, own), (_, more)) in self.columns.iter_mut().zip(&mut next.columns) {
            // The last row may lack cells of the last columns.
            own.fill(rows[0]);
            more.fill(rows[1]);
            own.append(more);
        }
        self.rows += next.rows;
    }

    /// Takes away the first rows, as a table of their own; all if there are no more.
    #[must_use]
    pub fn split_front(&mut self, rows: usize) -> Self {
        let rows = rows.min(self.rows);
        if self.kinds.len() > 1 {
            // The last row may lack cells of the last columns.
            let all = self.rows;
            self.columns.iter_mut().for_each(|(_, own)| own.fill(all));
        }
        let columns = self.columns.iter_mut();
        let front = columns.map(|(name, values)| (name.clone(), values.split_front(rows)));
        let front = Self {
            columns: front.collect(),
            kinds: self.kinds.clone(),
            rows,
        };
        self.rows -= rows;
        front
    }

    /// The finished table.
    ///
    /// # Errors
    /// If the rows did not all fill the same columns.
    pub fn to_frame(&self) -> Result<DataFrame, PolarsError> {
        let columns = self.columns.iter().map(|(name, values)| {
            let name = PlSmallStr::from_str(name);
            // The last row may lack cells of the last columns.
            let mut filled = Cow::Borrowed(values);
            if self.kinds.len() > 1 {
                filled.to_mut().fill(self.rows);
            }
            match &*filled {
                Values::Real(values) => {
                    let present = values
                        .iter()
                        .map(|value| (!value.is_nan()).then_some(*value));
                    Float64Chunked::from_iter_options(name, present).into_column()
                }
                // Signed, so that one count less another is a number in every program that reads the table.
                Values::Count(values) => {
                    let counts = values.iter().copied();
                    let signed =
                        counts.map(|count| count.and_then(|count| i64::try_from(count).ok()));
                    Int64Chunked::from_iter_options(name, signed).into_column()
                }
                Values::Word(values) => Series::new(name, values).into_column(),
                Values::Name(values) => {
                    let names = values.iter().map(Option::as_deref);
                    let names: Vec<Option<&str>> = names
                        .map(|name| name.filter(|name| !name.is_empty()))
                        .collect();
                    Series::new(name, names).into_column()
                }
                Values::Flag(values) => Series::new(name, values).into_column(),
            }
        });
        DataFrame::new_infer_height(columns.collect::<Vec<Column>>())
    }
}
