//! Columns of numbers by rank.

/// A column of a table, ranked: everything that rank statistics need of it, for any number of
/// comparisons. Rows may be without a value, as the onset of a fault that did not occur; infinite
/// values rank at the ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ranked {
    /// Rows of the table, with and without a value.
    rows: usize,
    /// The rows with a value, by ascending value: in 32 bits, since each condition has a column of all episodes.
    order: Vec<u32>,
    /// Where each run of equal values begins in `order`, and after them the length of `order`.
    runs: Vec<u32>,
}

impl Ranked {
    /// Ranks a column of which some rows may have no value. `None` if a value is NaN, or of more than 2^32 - 1 rows.
    pub fn of(values: &[Option<f64>]) -> Option<Self> {
        u32::try_from(values.len()).ok()?;
        let mut present: Vec<(f64, u32)> = (0..)
            .zip(values)
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

    /// Ranks a column with a value in every row. `None` as [`Self::of`].
    pub fn of_all(values: &[f64]) -> Option<Self> {
        let values: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
        Self::of(&values)
    }

    /// Ranks what is false below what is true.
    pub fn of_flags(flags: &[bool]) -> Self {
        let rows = || (0..).zip(flags);
        let rows_where =
            |wanted| rows().filter_map(move |(row, &own)| (own == wanted).then_some(row));
        let order: Vec<u32> = rows_where(false).chain(rows_where(true)).collect();
        let low = flags.iter().filter(|flag| !**flag).count();
        let runs = starts_of_runs(order.len(), |i| i == low);
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
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The ranges of `order` that hold equal values.
    pub(super) fn runs(&self) -> impl DoubleEndedIterator<Item = std::ops::Range<usize>> {
        self.runs
            .windows(2)
            .map(|ends| ends[0] as usize..ends[1] as usize)
    }

    /// This column on the rows of another one, in that one's order: row i of the result is the row
    /// of the i-th smallest value of `other`. `None` where a row of `other` has no value here.
    pub(super) fn along(&self, other: &Ranked) -> Option<Ranked> {
        if self.rows != other.rows {
            return None;
        }
        let mut position = vec![None; self.rows];
        for (i, &row) in (0..).zip(&other.order) {
            position[row as usize] = Some(i);
        }
        let mut order: Vec<u32> = Vec::with_capacity(other.len());
        let mut runs = vec![0];
        for run in self.runs() {
            let before = order.len();
            let own = self.order[run].iter();
            order.extend(own.filter_map(|&row| position[row as usize]));
            if order.len() > before {
                runs.push(u32::try_from(order.len()).ok()?);
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
            ranks[row as usize] = rank;
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
fn starts_of_runs(n: usize, begins: impl Fn(usize) -> bool) -> Vec<u32> {
    let starts = (1..n).filter(|&i| begins(i)).chain((n > 0).then_some(n));
    let starts = starts.map(|i| u32::try_from(i).unwrap_or(u32::MAX));
    std::iter::once(0).chain(starts).collect()
}
