//! Permutation tests of effects: all rows permuted, or what that comes to in the limit of many rows.

use super::arrangement::{Arrangement, Association};
use crate::random::philox::{Address, Stream};
use rayon::prelude::*;
use statrs::function::erf::erfc;
use statrs::function::gamma::gamma_ur;
use std::collections::HashMap;

/// A test ends early after this many permutations at least as extreme as the data: the p-value is
/// then known to 14 %, and is no small one unless there were many permutations.
const ENOUGH: u32 = 50;
/// Permutations between two looks at whether the tests may end.
const BATCH: u32 = 128;
/// The permutations of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Permutations {
    /// Seed of the campaign: the same permutations wherever and whenever the test is repeated.
    pub seed: u64,
    /// Their largest number m. The smallest p-value is 1 / (m + 1), and that of
    /// [`Effect::p_value`](super::Effect::p_value) twice that: 300 parameters under Holm's correction at 5 % need
    /// 11,999.
    pub most: u32,
    /// Rows up to which all of them are permuted; of more, the limit of many rows is taken.
    pub shuffled: usize,
}

/// Progress of one permutation test.
#[derive(Clone, Copy, Default)]
struct Tally {
    permutations: u32,
    as_extreme: u32,
}

impl Tally {
    fn is_open(&self) -> bool {
        self.as_extreme < ENOUGH
    }

    fn add(&mut self, is_as_extreme: bool) {
        if self.is_open() {
            self.permutations += 1;
            self.as_extreme += u32::from(is_as_extreme);
        }
    }

    fn p_value(&self) -> f64 {
        (f64::from(self.as_extreme) + 1.0) / (f64::from(self.permutations) + 1.0)
    }
}

/// p-values of trend and shape for each observed association of an arrangement, under random
/// permutations of the outcomes that they share.
pub(super) fn permutation_p(
    arrangement: &Arrangement,
    outcomes: &[f64],
    observed: &[Association],
    permutations: Permutations,
) -> Vec<[f64; 2]> {
    // The order from which a permutation starts must not depend on the parameter at hand.
    let mut outcomes = outcomes.to_vec();
    outcomes.sort_unstable_by(f64::total_cmp);
    sampled_p(observed, permutations, &|permutation| {
        let mut permuted = outcomes.clone();
        shuffle(&mut permuted, permutations.seed, permutation);
        arrangement.association(&permuted)
    })
}

/// p-values of each observed association against those of permutations, each made from its number.
fn sampled_p(
    observed: &[Association],
    permutations: Permutations,
    permuted: &(dyn Fn(u32) -> Association + Sync),
) -> Vec<[f64; 2]> {
    // Rounding of the squares of sums must not tell equal arrangements apart.
    let reaches = |value: f64, observed: f64| value >= observed * (1.0 - 1e-12);
    let mut tallies = vec![[Tally::default(); 2]; observed.len()];
    let mut begin = 0;
    while begin < permutations.most && tallies.iter().flatten().any(Tally::is_open) {
        let end = permutations.most.min(begin.saturating_add(BATCH));
        let batch: Vec<Association> = (begin..end).into_par_iter().map(permuted).collect();
        for permuted in &batch {
            for (tally, observed) in tallies.iter_mut().zip(observed) {
                tally[0].add(reaches(permuted.trend, observed.trend));
                tally[1].add(reaches(permuted.between, observed.between));
            }
        }
        begin = end;
    }
    let p_values = tallies.iter().map(|tests| tests.map(|test| test.p_value()));
    p_values.collect()
}

/// Shuffles by the permutation with this number (Fisher and Yates; Durstenfeld 1964, CACM 7:420).
/// The bias of an index below n is n / 2^32.
fn shuffle(values: &mut [f64], seed: u64, permutation: u32) {
    let places = 1..values.len();
    let mut words = [0; 4];
    for (draw, place) in (0_u32..).zip(places.rev()) {
        let lane = draw as usize % 4;
        if lane == 0 {
            words = Address {
                episode: permutation,
                stream: Stream::Permutation,
                entry: 0,
                member: 0,
                index: draw / 4,
            }
            .words(seed);
        }
        values.swap(place, index_below(place as u64 + 1, words[lane]));
    }
}

/// Where so many rows decide, on average, an association is normal enough; below, the tail of a count is not that of a
/// normal distribution.
const DECIDING: f64 = 100.0;

/// p-values of trend and shape in the limit of many rows: of permutations, the sum of the products of ranks is normal
/// with variance sum(r^2) sum(s^2) / (n - 1) (Hoeffding 1951, Annals of Mathematical Statistics 22:558-566), and the
/// sum of squares between bins, times (n - 1) / sum(s^2), has the chi-squared distribution with as many degrees of
/// freedom as there are bins but one (Kruskal and Wallis 1952, JASA 47:583-621).
///
/// That needs a sum of many. Where most rows are alike in the parameter and in the outcome (a rare fault, rare
/// failures), few rows decide: n / (spread of r) / (spread of s) of them, with the spread max(r^2) / mean(r^2). Below
/// 100 of these the permutations are sampled: where the rows that are not alike of one of both go is all that matters.
///
/// **Level**, simulated: at 5 % and 1 %, of 500 rows, continuous, tied and rare, what it should be; of 2,000 and 3,000
/// rows what the test that permutes all of them says, within the scatter of both.
pub(super) fn large_sample_p(
    arrangement: &Arrangement,
    outcomes: &[f64],
    observed: Association,
    permutations: Permutations,
) -> [f64; 2] {
    let n = outcomes.len() as f64;
    let squares = |values: &[f64]| values.iter().map(|own| own * own).sum::<f64>();
    let largest = |values: &[f64]| {
        values
            .iter()
            .fold(0.0, |most: f64, own| most.max(own * own))
    };
    let (ranks, total) = (&arrangement.ranks, squares(outcomes));
    let spread = largest(outcomes) / (total / n);
    let of_trend = largest(ranks) / (squares(ranks) / n);
    let smallest_bin = arrangement.bins().map(|bin| bin.len()).min().unwrap_or(1);
    let of_shape = n / smallest_bin as f64;
    if n / (spread * of_trend.max(of_shape)) < DECIDING {
        let few = Few::of(arrangement, outcomes);
        let permuted = |permutation| few.permuted(permutations.seed, permutation);
        return sampled_p(&[observed], permutations, &permuted)[0];
    }
    let z = observed.trend / (squares(ranks) * total / (n - 1.0)).sqrt();
    let freedom = arrangement.bin_ends.len() as f64 - 1.0;
    let statistic = observed.between * (n - 1.0) / total;
    [
        erfc(z / std::f64::consts::SQRT_2),
        gamma_ur(freedom / 2.0, statistic / 2.0),
    ]
}

/// The side of a test of which most rows are alike, by those that are not; and the other side, of which a permutation
/// gives each of them a value.
struct Few<'a> {
    arrangement: &'a Arrangement,
    outcomes: &'a [f64],
    /// Of the outcomes or of the parameter, how far the rows that differ are from those that are alike.
    beyond: Vec<f64>,
    /// The bins of those rows, of the parameter.
    bins: Option<Vec<usize>>,
    /// What most outcomes are.
    usual: f64,
}

impl<'a> Few<'a> {
    fn of(arrangement: &'a Arrangement, outcomes: &'a [f64]) -> Self {
        let mut sorted = outcomes.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let (of_outcomes, usual) = (rest_of(&sorted), most_common(&sorted));
        let of_ranks = rest_of(&arrangement.ranks);
        let ranks = arrangement.ranks.iter().enumerate();
        if of_outcomes <= of_ranks {
            let beyond = sorted.iter().map(|own| own - usual);
            return Self {
                arrangement,
                outcomes,
                beyond: beyond.filter(|own| own.abs() > 0.0).collect(),
                bins: None,
                usual,
            };
        }
        let common = most_common(&arrangement.ranks);
        let differing = ranks.filter(|(_, rank)| (*rank - common).abs() > 0.0);
        let (places, beyond): (Vec<usize>, Vec<f64>) = differing
            .map(|(place, rank)| (place, rank - common))
            .unzip();
        let bins = places.iter().map(|place| arrangement.bin_of(*place));
        Self {
            arrangement,
            outcomes,
            beyond,
            bins: Some(bins.collect()),
            usual,
        }
    }

    /// The association of the permutation with this number.
    fn permuted(&self, seed: u64, permutation: u32) -> Association {
        let rows = drawn(self.outcomes.len(), self.beyond.len(), seed, permutation);
        let mut sums: Vec<f64>;
        let mut trend = 0.0;
        match &self.bins {
            // Each outcome that is unusual goes to a row.
            None => {
                let sizes = self
                    .arrangement
                    .bins()
                    .map(|bin| bin.len() as f64 * self.usual);
                sums = sizes.collect();
                for (row, beyond) in rows.into_iter().zip(&self.beyond) {
                    trend += beyond * self.arrangement.ranks[row];
                    sums[self.arrangement.bin_of(row)] += beyond;
                }
            }
            // Each row of which the parameter is unusual has the outcome of another.
            Some(bins) => {
                let common = self.arrangement.bin_of_most();
                sums = vec![0.0; self.arrangement.bin_ends.len()];
                for ((row, beyond), bin) in rows.into_iter().zip(&self.beyond).zip(bins) {
                    trend += beyond * self.outcomes[row];
                    sums[*bin] += self.outcomes[row];
                }
                // Centred ranks add up to nothing.
                let others = (0..sums.len()).filter(|bin| *bin != common);
                let others: f64 = others.map(|bin| sums[bin]).sum();
                sums[common] = -others;
            }
        }
        let bins = sums.iter().zip(self.arrangement.bins());
        Association {
            trend: trend.abs(),
            between: bins.map(|(sum, bin)| sum * sum / bin.len() as f64).sum(),
        }
    }
}

/// The most common of some values in ascending order.
fn most_common(ascending: &[f64]) -> f64 {
    let runs = ascending.chunk_by(|a, b| a.total_cmp(b).is_eq());
    runs.max_by_key(|run| run.len()).map_or(0.0, |run| run[0])
}

/// How many of some values in ascending order are not the most common.
fn rest_of(ascending: &[f64]) -> usize {
    let runs = ascending.chunk_by(|a, b| a.total_cmp(b).is_eq());
    ascending.len() - runs.map(<[f64]>::len).max().unwrap_or(0)
}

/// The first `count` places of the permutation with this number, of `n`: the beginning of a shuffle from the front.
fn drawn(n: usize, count: usize, seed: u64, permutation: u32) -> Vec<usize> {
    let mut moved: HashMap<usize, usize> = HashMap::with_capacity(2 * count);
    let mut words = [0; 4];
    let mut rows = Vec::with_capacity(count);
    for place in 0..count {
        let lane = place % 4;
        if lane == 0 {
            let index = u32::try_from(place / 4).unwrap_or(u32::MAX);
            words = Address {
                episode: permutation,
                stream: Stream::Permutation,
                entry: 0,
                member: 0,
                index,
            }
            .words(seed);
        }
        let other = place + index_below((n - place) as u64, words[lane]);
        let own = moved.get(&place).copied().unwrap_or(place);
        rows.push(moved.insert(other, own).unwrap_or(other));
    }
    rows
}

/// A random word as an index below `n`, for n up to 2^32.
fn index_below(n: u64, word: u32) -> usize {
    ((n * u64::from(word)) >> 32) as usize
}
