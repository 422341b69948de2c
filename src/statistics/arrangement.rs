//! A parameter as a test of its effect sees it, and how outcomes are associated with it.

use super::rank::Ranked;
use std::ops::Range;

/// Most bins of the correlation ratio, and the fewest rows in a bin on average.
const BINS: usize = 10;
const ROWS_PER_BIN: usize = 5;

/// A parameter without its outcomes: ranks in ascending order, and its bins.
pub(super) struct Arrangement {
    pub(super) ranks: Vec<f64>,
    pub(super) bin_ends: Vec<usize>,
}

/// How outcomes are associated with an arrangement of a parameter.
#[derive(Clone, Copy)]
pub(super) struct Association {
    /// |sum of the products of the ranks|.
    pub(super) trend: f64,
    /// Sum of squares of the outcome's ranks between the bins.
    pub(super) between: f64,
}

impl Arrangement {
    pub(super) fn of(parameter: &Ranked) -> Self {
        let bins = (parameter.len() / ROWS_PER_BIN).clamp(2, BINS);
        Self {
            ranks: parameter.ascending_ranks(),
            bin_ends: parameter.bin_ends(bins),
        }
    }

    /// The association with outcomes given by their centred ranks, in the parameter's order. Ranks
    /// are whole numbers, so that the sums are exact below some 10^5 rows, and equal arrangements
    /// have equal ones.
    pub(super) fn association(&self, outcomes: &[f64]) -> Association {
        let (mut trend, mut between, mut begin) = (0.0, 0.0, 0);
        for &end in &self.bin_ends {
            let [products, sum] = sums(&self.ranks[begin..end], &outcomes[begin..end]);
            trend += products;
            between += sum * sum / (end - begin) as f64;
            begin = end;
        }
        Association {
            trend: trend.abs(),
            between,
        }
    }

    /// The places of each bin.
    pub(super) fn bins(&self) -> impl Iterator<Item = Range<usize>> {
        let ends = self.bin_ends.iter().copied();
        let begins = std::iter::once(0).chain(ends.clone());
        begins.zip(ends).map(|(begin, end)| begin..end)
    }

    /// The bin of a place.
    pub(super) fn bin_of(&self, place: usize) -> usize {
        self.bin_ends.partition_point(|end| *end <= place)
    }

    /// The bin of the most common rank.
    pub(super) fn bin_of_most(&self) -> usize {
        let mut begin = 0;
        let runs = self
            .ranks
            .chunk_by(|a, b| a.total_cmp(b).is_eq())
            .map(|run| {
                begin += run.len();
                (run.len(), begin - run.len())
            });
        let longest = runs.max_by_key(|(length, _)| *length);
        self.bin_of(longest.map_or(0, |(_, begin)| begin))
    }

    /// Epsilon squared from the share of the squares between bins: less what their number explains
    /// by chance.
    pub(super) fn shape(&self, share: f64) -> f64 {
        let (n, bins) = (self.ranks.len() as f64, self.bin_ends.len() as f64);
        if n > bins {
            (1.0 - (1.0 - share) * (n - 1.0) / (n - bins)).max(0.0)
        } else {
            0.0
        }
    }
}

/// The sums of x y and of y, in independent lanes: they cost as much as reading the numbers.
fn sums(x: &[f64], y: &[f64]) -> [f64; 2] {
    const LANES: usize = 8;
    let (x_blocks, x_rest) = x.as_chunks::<LANES>();
    let (y_blocks, y_rest) = y.as_chunks::<LANES>();
    let mut lanes = [[0.0; LANES]; 2];
    for (x, y) in x_blocks.iter().zip(y_blocks) {
        for lane in 0..LANES {
            lanes[0][lane] += x[lane] * y[lane];
            lanes[1][lane] += y[lane];
        }
    }
    let rest = x_rest.iter().zip(y_rest).map(|(x, y)| x * y);
    [
        lanes[0].iter().sum::<f64>() + rest.sum::<f64>(),
        lanes[1].iter().sum::<f64>() + y_rest.iter().sum::<f64>(),
    ]
}
