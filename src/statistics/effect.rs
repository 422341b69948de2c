//! Which recorded parameters matter: effects on an outcome, with intervals and permutation tests.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::correlation;
use super::interval::Estimate;
use super::rank::Ranked;
use crate::random::philox::{Address, Stream};

/// What the parameters may have an effect on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// A metric, or a log-ratio of metrics, of every episode.
    Metric(Ranked),
    /// Whether every episode failed: [`Ranked::of_flags`].
    Failure(Ranked),
}

/// The effect of one parameter on an outcome, over the episodes in which it applies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Episodes in which the parameter applies.
    pub n: usize,
    /// The monotone part: [`spearman`](super::spearman) for a metric, and for failures
    /// [`somers_d`](super::somers_d); positive if a larger parameter goes with a larger metric or
    /// more failures.
    pub trend: Estimate,
    /// Permutation p-value of no monotone effect.
    pub trend_p: f64,
    /// The share of the variance of the outcome's ranks that lies between bins of the parameter:
    /// the squared correlation ratio, corrected for what chance puts there (epsilon squared, Kelley
    /// 1935, PNAS 21:554-559) and never below 0. Unlike the trend it sees an effect of |x|.
    pub shape: f64,
    /// Permutation p-value of no effect on the bins' mean ranks (of Kruskal and Wallis's
    /// statistic, of which `shape` is a function).
    pub shape_p: f64,
}

impl Effect {
    /// p-value of no effect of either kind: the smaller one, doubled. What [`holm`](super::holm) is
    /// to be given for the family of all parameters.
    pub fn p_value(&self) -> f64 {
        (2.0 * self.trend_p.min(self.shape_p)).min(1.0)
    }
}

/// The permutations of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Permutations {
    /// Seed of the campaign: the same permutations wherever and whenever the test is repeated.
    pub seed: u64,
    /// Their largest number m. The smallest p-value is 1 / (m + 1), and that of
    /// [`Effect::p_value`] twice that: 300 parameters under Holm's correction at 5 % need 11,999.
    pub most: u32,
}

/// A test ends early after this many permutations at least as extreme as the data: the p-value is
/// then known to 14 %, and is no small one unless there were many permutations.
const ENOUGH: u32 = 50;
/// Permutations between two looks at whether the tests may end.
const BATCH: u32 = 128;
/// Most bins of the correlation ratio, and the fewest rows in a bin on average.
const BINS: usize = 10;
const ROWS_PER_BIN: usize = 5;

/// The effect of each parameter on the outcome; `None` where a parameter is constant over the
/// episodes in which it applies, where the outcome is, or where rows do not match.
///
/// A p-value is (b + 1) / (m + 1) for b of m random permutations of the outcome, among the episodes
/// in which the parameter applies, that are at least as extreme as the data: a valid p-value at any
/// size, without an assumption on distributions or ties (Phipson and Smyth 2010, SAGMB 9:39).
/// Sampling ends at the 50th such permutation, which keeps it valid (Besag and Clifford 1991,
/// Biometrika 78:301-304) and makes parameters without effect cheap.
///
/// The permutations depend on the seed alone. Parameters with the same rows and the same ties have
/// the same permutation distribution and share it: 300 continuous parameters cost little more than
/// one.
pub fn effects(
    parameters: &[Ranked],
    outcome: &Outcome,
    level: f64,
    permutations: Permutations,
) -> Vec<Option<Effect>> {
    let ranked = match outcome {
        Outcome::Metric(ranked) | Outcome::Failure(ranked) => ranked,
    };
    let mut effects: Vec<Option<Effect>> = parameters
        .par_iter()
        .map(|parameter| {
            let trend = match outcome {
                Outcome::Metric(_) => correlation::spearman(parameter, ranked, level),
                Outcome::Failure(_) => correlation::somers_d(parameter, ranked, level),
            };
            Some(Effect {
                n: parameter.len(),
                trend: trend?,
                trend_p: 1.0,
                shape: 0.0,
                shape_p: 1.0,
            })
        })
        .collect();

    // Those with the same rows and ties, by the index of the parameter.
    let mut groups: BTreeMap<[Vec<usize>; 2], Vec<usize>> = BTreeMap::new();
    for (i, parameter) in parameters.iter().enumerate() {
        if effects[i].is_some() {
            let mut rows = parameter.order().to_vec();
            rows.sort_unstable();
            let ties = parameter.runs().map(|run| run.end).collect();
            groups.entry([rows, ties]).or_default().push(i);
        }
    }
    for members in groups.values() {
        let arrangement = Arrangement::of(&parameters[members[0]]);
        let outcomes_of = |i: &usize| Some(ranked.along(&parameters[*i])?.ranks_by_row());
        let observed: Vec<Association> = members
            .par_iter()
            .filter_map(|i| Some(arrangement.association(&outcomes_of(i)?)))
            .collect();
        let Some(outcomes) = outcomes_of(&members[0]) else {
            continue;
        };
        let total: f64 = outcomes.iter().map(|y| y * y).sum();
        let p_values = permutation_p(&arrangement, outcomes, &observed, permutations);
        for ((&i, observed), [trend_p, shape_p]) in members.iter().zip(&observed).zip(p_values) {
            if let Some(effect) = &mut effects[i] {
                effect.trend_p = trend_p;
                effect.shape = arrangement.shape(observed.between / total);
                effect.shape_p = shape_p;
            }
        }
    }
    effects
}

/// A parameter without its outcomes: ranks in ascending order, and its bins.
struct Arrangement {
    ranks: Vec<f64>,
    bin_ends: Vec<usize>,
}

/// How outcomes are associated with an arrangement of a parameter.
#[derive(Clone, Copy)]
struct Association {
    /// |sum of the products of the ranks|.
    trend: f64,
    /// Sum of squares of the outcome's ranks between the bins.
    between: f64,
}

impl Arrangement {
    fn of(parameter: &Ranked) -> Self {
        let bins = (parameter.len() / ROWS_PER_BIN).clamp(2, BINS);
        Self {
            ranks: parameter.ascending_ranks(),
            bin_ends: parameter.bin_ends(bins),
        }
    }

    /// The association with outcomes given by their centred ranks, in the parameter's order. Ranks
    /// are whole numbers, so that the sums are exact below some 10^5 rows, and equal arrangements
    /// have equal ones.
    fn association(&self, outcomes: &[f64]) -> Association {
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

    /// Epsilon squared from the share of the squares between bins: less what their number explains
    /// by chance.
    fn shape(&self, share: f64) -> f64 {
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
fn permutation_p(
    arrangement: &Arrangement,
    mut outcomes: Vec<f64>,
    observed: &[Association],
    permutations: Permutations,
) -> Vec<[f64; 2]> {
    // The order from which a permutation starts must not depend on the parameter at hand.
    outcomes.sort_unstable_by(f64::total_cmp);
    // Rounding of the squares of sums must not tell equal arrangements apart.
    let reaches = |value: f64, observed: f64| value >= observed * (1.0 - 1e-12);

    let mut tallies = vec![[Tally::default(); 2]; observed.len()];
    let mut begin = 0;
    while begin < permutations.most && tallies.iter().flatten().any(Tally::is_open) {
        let end = permutations.most.min(begin.saturating_add(BATCH));
        let batch: Vec<Association> = (begin..end)
            .into_par_iter()
            .map(|permutation| {
                let mut permuted = outcomes.clone();
                shuffle(&mut permuted, permutations.seed, permutation);
                arrangement.association(&permuted)
            })
            .collect();
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

/// A random word as an index below `n`, for n up to 2^32.
fn index_below(n: u64, word: u32) -> usize {
    ((n * u64::from(word)) >> 32) as usize
}
