//! Optimal assignment of agents to tasks (Kuhn 1955, Munkres 1957).

use pathfinding::matrix::Matrix;
use pathfinding::prelude::kuhn_munkres_min;

/// The cost of a pair that is not possible, ms: more than all possible pairs together.
pub const INFEASIBLE_MS: i64 = 1_000_000_000_000;

/// Costs of all pairs (row, column), ms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Costs {
    rows: usize,
    columns: usize,
    costs_ms: Vec<i64>,
}

/// A row and the column that it is assigned to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The row.
    pub row: usize,
    /// The column.
    pub column: usize,
    /// The cost of the pair, ms.
    pub cost_ms: i64,
}

impl Costs {
    /// The costs of all pairs of so many rows and columns, at most [`INFEASIBLE_MS`].
    #[must_use]
    pub fn new([rows, columns]: [usize; 2], mut cost_ms: impl FnMut(usize, usize) -> i64) -> Self {
        let pairs = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let bounded = pairs.map(|(row, column)| cost_ms(row, column).clamp(0, INFEASIBLE_MS));
        Self {
            rows,
            columns,
            costs_ms: bounded.collect(),
        }
    }

    /// The pairs with the least sum of costs, by rows. As many rows as possible get a column of their own; pairs that
    /// are not possible are then left out.
    #[must_use]
    pub fn optimum(&self) -> Vec<Pair> {
        let cost_ms = |row: usize, column: usize| self.costs_ms[row * self.columns + column];
        let pair = |(row, column): (usize, usize)| Pair {
            row,
            column,
            cost_ms: cost_ms(row, column),
        };
        if self.costs_ms.is_empty() {
            return Vec::new();
        }
        let Ok(matrix) = Matrix::from_vec(self.rows, self.columns, self.costs_ms.clone()) else {
            return Vec::new();
        };
        // The solver needs at least as many columns as rows.
        let mut pairs: Vec<Pair> = if self.rows > self.columns {
            let rows = kuhn_munkres_min(&matrix.transposed()).1;
            let pairs = rows.into_iter().enumerate();
            pairs.map(|(column, row)| pair((row, column))).collect()
        } else {
            let columns = kuhn_munkres_min(&matrix).1;
            columns.into_iter().enumerate().map(pair).collect()
        };
        pairs.retain(|pair| pair.cost_ms < INFEASIBLE_MS);
        pairs.sort_by_key(|pair| pair.row);
        pairs
    }
}
