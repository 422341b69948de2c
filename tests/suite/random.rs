//! Designs: exact balance, independence of dimensions, and what they gain and may conclude.

use urts_mc::random::{Design, Method, allows, latin_hypercube, sobol};
use urts_mc::statistics::{Interval, replicate_mean, wilson};

const SEED: u64 = 2026;

/// How many of the numbers lie in each of n equal parts of (0, 1).
fn occupancy(numbers: impl Iterator<Item = f64>, n: usize) -> Vec<u32> {
    let mut counts = vec![0; n];
    for number in numbers {
        assert!(0.0 < number && number < 1.0, "{number}");
        counts[(number * n as f64) as usize] += 1;
    }
    counts
}

/// Pearson's chi-squared of counts that should be equal, as a normal deviate (Wilson and Hilferty
/// 1931, PNAS 17:684-688).
fn deviate(counts: &[u32]) -> f64 {
    let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    let squares = counts
        .iter()
        .map(|&count| (f64::from(count) - expected).powi(2));
    let freedom = counts.len() as f64 - 1.0;
    let ninth = 2.0 / (9.0 * freedom);
    let ratio = squares.sum::<f64>() / expected / freedom;
    (ratio.cbrt() - (1.0 - ninth)) / ninth.sqrt()
}

/// Correlation of two columns times the root of their length: standard normal if independent.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let products = a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5));
    products.sum::<f64>() * 12.0 / (a.len() as f64).sqrt()
}

#[test]
fn each_stratum_of_a_latin_hypercube_is_hit_exactly_once_in_each_dimension() {
    for n in [1, 2, 3, 7, 16, 100, 128, 129, 1000, 20_000] {
        for dimension in [0, 1, 2, 77, u32::MAX] {
            for replicate in [0, 1, 5] {
                let episodes = replicate * n..(replicate + 1) * n;
                let numbers = episodes.map(|i| latin_hypercube(SEED, dimension, n, i));
                assert!(
                    occupancy(numbers, n as usize)
                        .iter()
                        .all(|&count| count == 1)
                );
            }
        }
    }
    // Negative control: a hypercube of another size is none of this one.
    let other = (0..100).map(|i| latin_hypercube(SEED, 0, 128, i));
    assert!(occupancy(other, 100).iter().any(|&count| count != 1));
}

#[test]
fn a_latin_hypercube_of_any_size_stays_inside_of_0_and_1() {
    for n in [0, 1, u32::MAX - 1, u32::MAX] {
        for episode in [0, 1, u32::MAX / 2, u32::MAX - 1, u32::MAX] {
            let number = latin_hypercube(SEED, 3, n, episode);
            assert!(0.0 < number && number < 1.0);
        }
    }
}

#[test]
fn all_orders_of_the_strata_are_equally_likely_and_places_in_them_uniform() {
    for (n, factorial) in [(2, 2), (3, 6), (4, 24), (5, 120)] {
        // Over many dimensions of one seed, and over many replicates.
        for by_dimension in [true, false] {
            let mut orders = std::collections::BTreeMap::new();
            let mut places = vec![0; 20];
            for draw in 0..12_000 {
                let (dimension, replicate) = if by_dimension { (draw, 0) } else { (0, draw) };
                let number = |i| latin_hypercube(SEED, dimension, n, n * replicate + i);
                let scaled: Vec<f64> = (0..n).map(|i| f64::from(n) * number(i)).collect();
                for value in &scaled {
                    places[(value.fract() * 20.0) as usize] += 1;
                }
                let order: Vec<u32> = scaled.iter().map(|&value| value as u32).collect();
                *orders.entry(order).or_insert(0) += 1;
            }
            let orders: Vec<u32> = orders.into_values().collect();
            assert_eq!(orders.len(), factorial);
            // Four standard deviations: one false alarm in 16,000 choices of the seed.
            assert!(deviate(&orders) < 4.0, "{} of {n}", deviate(&orders));
            assert!(deviate(&places) < 4.0, "{}", deviate(&places));
        }
    }
}

#[test]
fn two_episodes_of_a_large_hypercube_lie_in_any_two_strata_alike() {
    for n in [129, 250, 256] {
        let strata = |dimension: u32| {
            [0, 1].map(|i| (f64::from(n) * latin_hypercube(SEED, dimension, n, i)) as u32)
        };
        let (mut first, mut distance) = (vec![0; n as usize], vec![0; n as usize]);
        for dimension in 0..40_000 {
            let [a, b] = strata(dimension);
            first[a as usize] += 1;
            distance[((n + b - a) % n) as usize] += 1;
        }
        assert_eq!(distance.remove(0), 0);
        assert!(deviate(&first) < 4.0 && deviate(&distance) < 4.0);
    }
}

#[test]
fn each_number_of_a_design_is_uniform_over_seeds_and_replicates() {
    let draws = 0..20_000_u32;
    let cells = 50;
    let columns: [Vec<f64>; 5] = [
        draws
            .clone()
            .map(|r| latin_hypercube(SEED, 5, 10, 10 * r + 3))
            .collect(),
        draws
            .clone()
            .map(|s| latin_hypercube(u64::from(s) << 20, 5, 10, 3))
            .collect(),
        draws.clone().map(|r| sobol(SEED, r, 6, 0)).collect(),
        draws
            .clone()
            .map(|r| sobol(SEED, r, 1, 1_000_000))
            .collect(),
        draws
            .clone()
            .map(|s| sobol(u64::from(s) << 20, 0, 3, 12))
            .collect(),
    ];
    for column in &columns {
        assert!(deviate(&occupancy(column.iter().copied(), cells)) < 4.0);
        // From one replicate to the next, nothing is carried over.
        assert!(correlation(&column[1..], &column[..19_999]).abs() < 4.0);
    }
}

/// The largest |deviate| of the correlation between any two of so many dimensions.
fn largest_correlation(dimensions: u32, n: u32, unit: impl Fn(u32, u32) -> f64) -> f64 {
    let columns: Vec<Vec<f64>> = (0..dimensions)
        .map(|dimension| (0..n).map(|i| unit(dimension, i)).collect())
        .collect();
    let pairs = (0..columns.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    let deviates = pairs.map(|(a, b)| correlation(&columns[a], &columns[b]).abs());
    deviates.fold(0.0, f64::max)
}

#[test]
fn dimensions_are_independent_of_each_other() {
    // 780 pairs: 4.8 standard deviations are passed by one in 1000 choices of the seed.
    assert!(largest_correlation(40, 1000, |d, i| latin_hypercube(SEED, d, 1000, i)) < 4.8);
    assert!(largest_correlation(40, 1024, |d, i| sobol(SEED, 0, d, i)) < 4.8);
    // Negative control: sequences that are not shuffled against each other, and not scrambled.
    let plain = |d: u32, i: u32| f64::from((i + d / 10).reverse_bits()) / 4_294_967_296.0;
    assert!(largest_correlation(40, 1024, plain) > 4.8);
}

/// Whether each box of the net with `digits[d]` binary digits in dimension `dimensions[d]` holds the
/// same number of the first 2^m points.
fn is_balanced(points: &[Vec<f64>], digits: &[u32]) -> bool {
    let boxes = 1_usize << digits.iter().sum::<u32>();
    let mut counts = vec![0; boxes];
    for i in 0..points[0].len() {
        let cell = points
            .iter()
            .zip(digits)
            .fold(0, |cell, (column, &digits)| {
                (cell << digits) | (column[i] * f64::from(1 << digits)) as usize
            });
        counts[cell] += 1;
    }
    counts.iter().all(|&count| count == points[0].len() / boxes)
}

/// All ways to share `digits` among the dimensions.
fn shares(digits: u32, dimensions: usize) -> Vec<Vec<u32>> {
    if dimensions == 1 {
        return vec![vec![digits]];
    }
    let first_and_rest = |first: u32| {
        let rest = shares(digits - first, dimensions - 1);
        rest.into_iter()
            .map(move |rest| [vec![first], rest].concat())
    };
    (0..=digits).flat_map(first_and_rest).collect()
}

fn sobol_columns(
    replicate: u32,
    dimensions: &[u32],
    points: std::ops::Range<u32>,
) -> Vec<Vec<f64>> {
    let column = |&dimension: &u32| {
        points
            .clone()
            .map(|i| sobol(SEED, replicate, dimension, i))
            .collect()
    };
    dimensions.iter().map(column).collect()
}

#[test]
fn sobol_points_are_nets_in_every_dimension_pair_and_group() {
    for group in [0, 1, 17] {
        let dimensions = [0, 1, 2, 3].map(|component| 4 * group + component);
        for m in 0..=10 {
            // The first 2^m points, and a later aligned block of as many.
            for first in [0, 5 << m] {
                let columns = sobol_columns(group, &dimensions, first..first + (1 << m));
                for column in &columns {
                    assert!(is_balanced(std::slice::from_ref(column), &[m]));
                }
                for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                    let pair = [columns[a].clone(), columns[b].clone()];
                    let t = if (a, b) == (0, 1) { 0 } else { m.min(2) };
                    assert!(
                        shares(m - t, 2)
                            .iter()
                            .all(|digits| is_balanced(&pair, digits))
                    );
                }
                let all = shares(m.saturating_sub(3), 4);
                assert!(all.iter().all(|digits| is_balanced(&columns, digits)));
            }
        }
    }
    // Negative controls: dimensions of different groups are no net, nor is a block out of step.
    let padded = sobol_columns(0, &[1, 4], 0..256);
    assert!(
        !shares(8, 2)
            .iter()
            .all(|digits| is_balanced(&padded, digits))
    );
    assert!(!is_balanced(&sobol_columns(0, &[0], 100..356), &[8]));
}

#[test]
fn replicates_and_seeds_differ_and_the_same_address_gives_the_same_number() {
    for n in [64, 1000] {
        let column = |seed, replicate: u32, dimension| -> [Vec<f64>; 2] {
            [
                (0..n)
                    .map(|i| latin_hypercube(seed, dimension, n, replicate * n + i))
                    .collect(),
                (0..n)
                    .map(|i| sobol(seed, replicate, dimension, i))
                    .collect(),
            ]
        };
        let here = column(SEED, 0, 0);
        assert_eq!(here, column(SEED, 0, 0));
        for other in [
            column(SEED + 1, 0, 0),
            column(SEED, 1, 0),
            column(SEED, 0, 1),
        ] {
            for (a, b) in here.iter().zip(&other) {
                assert!(a.iter().zip(b).all(|(a, b)| a != b));
            }
        }
    }
    // The two designs share a stream and not their numbers.
    assert_ne!(latin_hypercube(SEED, 0, 1, 0), sobol(SEED, 0, 0, 0));
}

#[test]
fn regress_the_numbers_at_fixed_addresses_never_change() {
    // A recorded campaign is replayed from its addresses: these numbers are a promise.
    assert_eq!(latin_hypercube(2026, 3, 1000, 17), 0.034_159_285_928_700_68);
    assert_eq!(
        latin_hypercube(2026, 3, 1000, 1017),
        0.437_176_531_785_945_84
    );
    assert_eq!(sobol(2026, 0, 0, 0), 0.242_968_820_414_473_2);
    assert_eq!(sobol(2026, 2, 7, 123_456), 0.775_265_749_836_289_5);
}

/// Variance over 400 replicates of the mean of `integrand` over `n` points in four dimensions.
fn variance(n: u32, unit: impl Fn(u32, u32, u32) -> f64, integrand: fn([f64; 4]) -> f64) -> f64 {
    let replicates = 400;
    let means: Vec<f64> = (0..replicates)
        .map(|replicate| {
            let points = (0..n).map(|i| integrand([0, 1, 2, 3].map(|d| unit(replicate, d, i))));
            points.sum::<f64>() / f64::from(n)
        })
        .collect();
    let mean = means.iter().sum::<f64>() / f64::from(replicates);
    means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / f64::from(replicates)
}

#[test]
fn smooth_integrands_have_a_fraction_of_the_variance_of_independent_numbers() {
    let n = 256;
    let hypercube = move |r, d, i| latin_hypercube(SEED, d, n, r * n + i);
    let scrambled = |r, d, i| sobol(SEED, r, d, i);
    // Hypercubes of one point are independent numbers.
    let independent = move |r, d, i| latin_hypercube(SEED, d, 1, r * n + i);

    let additive = |u: [f64; 4]| u.iter().map(|u| u.exp()).sum::<f64>();
    let product = |u: [f64; 4]| u.iter().map(|u| 1.0 + (u - 0.5)).product::<f64>();
    let plain = variance(n, independent, additive);
    // Variance of exp(u), four times, over n points; sqrt(2 / 400) = 7 % of noise.
    let of_exp = (1_f64.exp().powi(2) - 1.0) / 2.0 - (1_f64.exp() - 1.0).powi(2);
    assert!((plain / (4.0 * of_exp / f64::from(n)) - 1.0).abs() < 0.25);
    // Stratified, the additive part converges as n^-3: by another n^2 = 65,536 in the variance.
    assert!(variance(n, hypercube, additive) < plain / 10_000.0);
    assert!(variance(n, scrambled, additive) < plain / 10_000.0);

    let plain = variance(n, independent, product);
    // What is left to the hypercube are the interactions: (1 + 1/12)^4 - 1 - 4/12 of the variance
    // (1 + 1/12)^4 - 1, a share of 0.12.
    let hypercube = variance(n, hypercube, product) / plain;
    assert!(0.08 < hypercube && hypercube < 0.18, "{hypercube}");
    let scrambled = variance(n, scrambled, product) / plain;
    assert!(scrambled < 0.01, "{scrambled}");
}

#[test]
fn val_one_dimension_has_the_variance_of_stratified_sampling() {
    // A point in each of n strata, uniform and independent there: 1 / (12 n^3). Scrambling that
    // flipped a digit alike in all points would move them together, and leave 1 / (12 n^2).
    let n = 64;
    let first = |u: [f64; 4]| u[0];
    let expected = 1.0 / (12.0 * f64::from(n).powi(3));
    let hypercube = variance(n, |r, d, i| latin_hypercube(SEED, d, n, r * n + i), first);
    let scrambled = variance(n, |r, d, i| sobol(SEED, r, d, i), first);
    for variance in [hypercube, scrambled] {
        // Four standard errors, sqrt(2 / 400) = 7 % each.
        assert!(
            (variance / expected - 1.0).abs() < 0.28,
            "{variance} {expected}"
        );
    }
}

#[test]
fn replicates_give_an_interval_that_covers_and_is_narrower_than_independent_episodes_give() {
    // An episode fails where its two quantities add up: a rate of 0.4^2 / 2.
    let (fails, rate) = (|u: [f64; 2]| u[0] + u[1] > 1.6, 0.08);
    let (replicates, n, experiments) = (10, 128, 2000);
    let hypercube = |r, d, i| latin_hypercube(SEED, d, n, r * n + i);
    let scrambled = |r, d, i| sobol(SEED, r, d, i);
    let measure = |unit: &dyn Fn(u32, u32, u32) -> f64| {
        let (mut covered, mut wilson_covered, mut width) = (0.0, 0.0, 0.0);
        for experiment in 0..experiments {
            let failures = (0..replicates).map(|replicate| {
                let replicate = experiment * replicates + replicate;
                let point = |i: &u32| [0, 1].map(|d| unit(replicate, d, *i));
                (0..n).filter(|i| fails(point(i))).count() as u64
            });
            let failures: Vec<u64> = failures.collect();
            let rates: Vec<f64> = failures.iter().map(|&k| k as f64 / f64::from(n)).collect();
            let by_replicates = replicate_mean(&rates, 0.95).unwrap().interval;
            let episodes = u64::from(replicates * n);
            let binomial = wilson(failures.iter().sum(), episodes, 0.95);
            let holds = |interval: Interval| interval.lower <= rate && rate <= interval.upper;
            covered += f64::from(u8::from(holds(by_replicates)));
            wilson_covered += f64::from(u8::from(holds(binomial)));
            width +=
                (by_replicates.upper - by_replicates.lower) / (binomial.upper - binomial.lower);
        }
        [covered, wilson_covered, width].map(|sum| sum / f64::from(experiments))
    };
    for (unit, narrower) in [
        (&hypercube as &dyn Fn(_, _, _) -> _, 1.0),
        (&scrambled, 0.5),
    ] {
        let [covered, wilson_covered, width] = measure(unit);
        println!("covered {covered}, by Wilson's {wilson_covered}; width {width} of Wilson's");
        // Three standard errors: 1.5 points.
        assert!((covered - 0.95).abs() < 0.015);
        // Negative control: a binomial interval does not see what the design gained.
        assert!(wilson_covered > 0.965);
        assert!(width < narrower);
    }
}

#[test]
fn only_independent_episodes_allow_what_counts_on_independence() {
    let allowed = |design| Method::ALL.map(|method| allows(design, method));
    assert_eq!(allowed(Design::Independent), [true; 7]);
    for design in Design::ALL {
        for method in [
            Method::FailureRate,
            Method::Quantile,
            Method::Paired,
            Method::EffectInterval,
        ] {
            assert_eq!(allows(design, method), design == Design::Independent);
        }
    }
    assert!(allows(Design::LatinHypercube, Method::EffectTest));
    assert!(!allows(Design::Sobol, Method::EffectTest));
    for design in [Design::LatinHypercube, Design::Sobol] {
        assert!(allows(design, Method::Replicates) && allows(design, Method::Estimate));
    }
}
