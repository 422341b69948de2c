//! Columns of numbers by rank.

/// A column of a table, ranked: everything that rank statistics need of it, for any number of
/// comparisons. Rows may be without a value, as the onset of a fault that did not occur; infinite
/// values rank at the ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ranked {
    /// Rows of the table, with and without a value.
    rows: usize,
    /// The rows with a value, by ascending value.
    order: Vec<usize>,
    /// Where each run of equal values begins in `order`, and after them the length of `order`.
    runs: Vec<usize>,
}

impl Ranked {
    /// Ranks a column of which some rows may have no value. `None` if a value is NaN.
    pub fn of(values: &[Option<f64>]) -> Option<Self> {
        let mut present: Vec<(f64, usize)> = values
            .iter()
            .enumerate()
            .filter_map(|(row, value)| value.map(|value| (value, row)))
            .collect();
        if present.iter().any(|(value, _)| value.is_nan()) {
            return None;
        }
        present.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let runs = starts_of_runs(present.len(), |i| present[i - 1].0 < present[i].0);
        Some(Self {
            rows: values.len(),
            order: present.into_iter().map(|(_, row)| row).collect(),
            runs,
        })
    }

    /// Ranks a column with a value in every row. `None` if a value is NaN.
    pub fn of_all(values: &[f64]) -> Option<Self> {
        let values: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
        Self::of(&values)
    }

    /// Ranks what is false below what is true.
    pub fn of_flags(flags: &[bool]) -> Self {
        let rows_where = |wanted| (0..flags.len()).filter(move |&row| flags[row] == wanted);
        let order: Vec<usize> = rows_where(false).chain(rows_where(true)).collect();
        let runs = starts_of_runs(order.len(), |i| flags[order[i - 1]] != flags[order[i]]);
        Self {
            rows: flags.len(),
            order,
            runs,
        }
    }

    /// Rows of the table, with and without a value.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Rows with a value.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether no row has a value.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Number of different values.
    pub fn distinct(&self) -> usize {
        self.runs.len() - 1
    }

    /// The rows with a value, by ascending value.
    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    /// The ranges of `order` that hold equal values.
    pub(super) fn runs(&self) -> impl DoubleEndedIterator<Item = std::ops::Range<usize>> {
        self.runs.windows(2).map(|ends| ends[0]..ends[1])
    }

    /// This column on the rows of another one, in that one's order: row i of the result is the row
    /// of the i-th smallest value of `other`. `None` where a row of `other` has no value here.
    pub(super) fn along(&self, other: &Ranked) -> Option<Ranked> {
        if self.rows != other.rows {
            return None;
        }
        let mut position = vec![None; self.rows];
        for (i, &row) in other.order.iter().enumerate() {
            position[row] = Some(i);
        }
        let mut order = Vec::with_capacity(other.len());
        let mut runs = vec![0];
        for run in self.runs() {
            order.extend(self.order[run].iter().filter_map(|&row| position[row]));
            if runs.last() != Some(&order.len()) {
                runs.push(order.len());
            }
        }
        (order.len() == other.len()).then_some(Ranked {
            rows: other.len(),
            order,
            runs,
        })
    }

    /// The mean ranks in the order of the values, centred and doubled so that they are whole
    /// numbers: from 1 - n to n - 1, with sum 0.
    pub(super) fn ascending_ranks(&self) -> Vec<f64> {
        let n = self.len() as f64;
        let mut ranks = Vec::with_capacity(self.len());
        for run in self.runs() {
            let rank = (run.start + run.end) as f64 - n;
            ranks.resize(run.end, rank);
        }
        ranks
    }

    /// The ranks of [`Self::ascending_ranks`] row by row; 0, the middle, for rows without a value.
    pub(super) fn ranks_by_row(&self) -> Vec<f64> {
        let mut ranks = vec![0.0; self.rows];
        for (&row, rank) in self.order.iter().zip(self.ascending_ranks()) {
            ranks[row] = rank;
        }
        ranks
    }

    /// Ends of at most `most` bins of neighbouring values in `order`, as equally filled as whole
    /// runs allow: equal values share a bin, and few different values have a bin each.
    pub(super) fn bin_ends(&self, most: usize) -> Vec<usize> {
        let mut ends = Vec::with_capacity(most);
        for (earlier, run) in self.runs().enumerate() {
            // A run closes a bin that has its share of what is left for the bins that are left, or
            // if there are bins enough for all runs after it.
            let begun = ends.last().copied().unwrap_or(0);
            let open = most.saturating_sub(ends.len()).max(1);
            let fair_share = (self.len() - begun).div_ceil(open);
            let later = self.distinct() - earlier - 1;
            if run.end - begun >= fair_share || later < open {
                ends.push(run.end);
            }
        }
        ends
    }
}

/// The starts of runs in 0..n, where `begins(i)` says whether a new one begins at i > 0; and n.
fn starts_of_runs(n: usize, begins: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut starts = vec![0];
    starts.extend((1..n).filter(|&i| begins(i)));
    if n > 0 {
        starts.push(n);
    }
    starts
}
