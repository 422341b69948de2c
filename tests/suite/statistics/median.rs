//! The BCa interval of a median: its bootstrap by complete enumeration and by brute force, and its
//! coverage by seeded simulation.

use urts_mc::statistics::{Estimate, Interval, median_bca};

use super::coverage::rank_coverage;
use super::random::SplitMix64;
use super::{holds, ranks};

/// A bootstrap's resampled medians, as (value, weight) with weights that add up to 1.
type Medians = Vec<(f64, f64)>;

/// BCa by its textbook formulas from given resampled medians; `jackknife` are the leave-one-out
/// medians. Independent of the crate, the normal distribution included.
fn textbook_bca(mut medians: Medians, observed: f64, jackknife: &[f64], z: f64) -> Interval {
    medians.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let weight_where = |keep: &dyn Fn(f64) -> bool| -> f64 {
        let kept = medians.iter().filter(|(value, _)| keep(*value));
        kept.map(|(_, weight)| weight).sum()
    };
    let below = weight_where(&|v| v < observed);
    let tied = weight_where(&|v| v <= observed) - below;
    let z0 = normal_quantile(below + tied / 2.0);

    let mean = jackknife.iter().sum::<f64>() / jackknife.len() as f64;
    let power_sum = |power| -> f64 { jackknife.iter().map(|d| (mean - d).powi(power)).sum() };
    let acceleration = power_sum(3) / (6.0 * power_sum(2).powf(1.5));

    let end = |z: f64| {
        let probability = normal(z0 + (z0 + z) / (1.0 - acceleration * (z0 + z)));
        let mut total = 0.0;
        let reached = medians.iter().find(|(_, weight)| {
            total += weight;
            total >= probability
        });
        reached.unwrap().0
    };
    Interval {
        lower: end(-z),
        upper: end(z),
    }
}

/// Normal distribution function by Simpson's rule on its density; good to 1e-12 for |z| < 6.
fn normal(z: f64) -> f64 {
    let steps = 2000;
    let h = z / f64::from(steps);
    let density = |x: f64| (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
    let inner = (1..steps).map(|i| f64::from(2 + 2 * (i % 2)) * density(f64::from(i) * h));
    0.5 + h / 3.0 * (density(0.0) + inner.sum::<f64>() + density(z))
}

fn normal_quantile(probability: f64) -> f64 {
    let (mut lower, mut upper) = (-6.0, 6.0);
    for _ in 0..60 {
        let middle = f64::midpoint(lower, upper);
        if normal(middle) < probability {
            lower = middle;
        } else {
            upper = middle;
        }
    }
    lower
}

/// The two middle values; the same one twice for odd n.
fn middle_values(values: &mut [f64]) -> (f64, f64) {
    values.sort_unstable_by(f64::total_cmp);
    (values[(values.len() - 1) / 2], values[values.len() / 2])
}

fn leave_one_out_medians(values: &[f64]) -> Vec<f64> {
    let median_without = |left_out: usize| {
        let mut rest = values.to_vec();
        rest.remove(left_out);
        let (lower, upper) = middle_values(&mut rest);
        f64::midpoint(lower, upper)
    };
    (0..values.len()).map(median_without).collect()
}

// Two-sided normal quantiles.
const Z_80: f64 = 1.281_551_565_544_600_4;
const Z_95: f64 = 1.959_963_984_540_054;

#[test]
fn val_median_bca_equals_the_enumeration_of_all_resamples() {
    // Odd and even, plain, tied at the median, and with a gap of very different widths.
    let samples: [&[f64]; 5] = [
        &[-1.0, 0.2, 0.3, 2.0, 7.0],
        &[1.0, 1.0, 1.0, 2.0, 5.0],
        &[-1.0, 0.2, 0.3, 2.0, 7.0, 9.0],
        &[0.0, 1.0, 1.0, 3.0, 4.0, 4.5],
        &[-2.0, -1.5, 0.0, 0.0, 0.5, 100.0, 101.0],
    ];
    for values in samples {
        let n = values.len();
        let resamples = n.pow(u32::try_from(n).unwrap());
        let weight = 0.5 / resamples as f64;
        let mut medians = Medians::new();
        for resample in 0..resamples {
            let mut drawn: Vec<f64> = (0..n)
                .scan(resample, |rest, _| {
                    let index = *rest % n;
                    *rest /= n;
                    Some(values[index])
                })
                .collect();
            let (lower, upper) = middle_values(&mut drawn);
            medians.extend([(lower, weight), (upper, weight)]);
        }
        let (lower, upper) = middle_values(&mut values.to_vec());
        let observed = f64::midpoint(lower, upper);
        let jackknife = leave_one_out_medians(values);
        let expected = Estimate {
            value: observed,
            interval: textbook_bca(medians, observed, &jackknife, Z_80),
        };
        assert_eq!(median_bca(values, 0.8), Some(expected), "{values:?}");
    }
}

#[test]
fn val_median_bca_equals_a_brute_force_bootstrap() {
    let mut random = SplitMix64(11);
    for n in [20, 25, 60] {
        let values: Vec<f64> = (0..n).map(|_| random.normal().exp()).collect();
        let mut sorted = values.clone();
        let (lower, upper) = middle_values(&mut sorted);
        let observed = f64::midpoint(lower, upper);

        // 200,000 resamples put the standard error of an end's probability at 0.0004; the seed's
        // ends are farther than that from the next value.
        let resamples = 200_000;
        let weight = 1.0 / f64::from(resamples);
        let (mut either_middle, mut mean_of_middles) = (Medians::new(), Medians::new());
        for _ in 0..resamples {
            let mut drawn: Vec<f64> = (0..n).map(|_| values[random.index(n)]).collect();
            let (lower, upper) = middle_values(&mut drawn);
            either_middle.extend([(lower, weight / 2.0), (upper, weight / 2.0)]);
            mean_of_middles.push((f64::midpoint(lower, upper), weight));
        }
        let jackknife = leave_one_out_medians(&sorted);
        let bca = |medians| textbook_bca(medians, observed, &jackknife, Z_95);
        let expected = bca(either_middle);
        let usual = bca(mean_of_middles);
        let actual = median_bca(&values, 0.95).unwrap().interval;
        assert_eq!(actual, expected, "n = {n}");

        // The usual mean of the two middle values moves an end of an even sample by one rank at
        // most: the two are neighbours in nearly every resample.
        let rank = |end: f64| sorted.partition_point(|&value| value < end);
        assert!(rank(usual.lower).abs_diff(rank(actual.lower)) <= 1);
        assert!(rank(usual.upper).abs_diff(rank(actual.upper)) <= 1);
    }
}

/// Share of `replicates` samples of size n whose interval holds the population's median.
fn simulated_coverage(
    draw: &dyn Fn(&mut SplitMix64) -> f64,
    median: f64,
    n: usize,
    interval: &dyn Fn(&[f64]) -> Interval,
) -> f64 {
    let mut random = SplitMix64(2026);
    let covered = (0..REPLICATES).filter(|_| {
        let values: Vec<f64> = (0..n).map(|_| draw(&mut random)).collect();
        holds(&interval(&values), median)
    });
    covered.count() as f64 / f64::from(REPLICATES)
}

const REPLICATES: u32 = 8000;
// sqrt(0.95 x 0.05 / 8000): 0.24 points.
const STANDARD_ERROR: f64 = 0.0025;

fn bca_95(values: &[f64]) -> Interval {
    median_bca(values, 0.95).unwrap().interval
}

#[test]
fn val_median_bca_covers_95_percent_whatever_the_population() {
    type Draw = fn(&mut SplitMix64) -> f64;
    let normal: Draw = SplitMix64::normal;
    let lognormal: Draw = |random| random.normal().exp();
    let cauchy: Draw = |random| random.normal() / random.normal();
    let populations = [(normal, 0.0), (lognormal, 1.0), (cauchy, 0.0)];

    for n in [200, 500] {
        // Even n and no ties: the interval is one of fixed ranks, so that its coverage is the same
        // for every continuous population and known exactly.
        let exact = rank_coverage(&bca_95(&ranks(n)), n, 0.5);
        assert!((exact - 0.95).abs() < 0.015, "{exact} at n = {n}");
        for (draw, median) in populations {
            let simulated = simulated_coverage(&draw, median, n, &bca_95);
            assert!((simulated - 0.95).abs() < 0.015, "{simulated} at n = {n}");
            // Four standard errors: one false alarm in 16,000 over the choice of the seed.
            assert!((simulated - exact).abs() < 4.0 * STANDARD_ERROR);
        }
    }

    // Negative control: the normal-theory interval of the mean is no interval of the median.
    let interval_of_mean = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let half_width = Z_95 * (variance / n).sqrt();
        Interval {
            lower: mean - half_width,
            upper: mean + half_width,
        }
    };
    assert!(simulated_coverage(&lognormal, 1.0, 200, &interval_of_mean) < 0.5);
}

#[test]
fn median_bca_covers_with_ties_and_with_diverged_episodes() {
    // Rounded to tenths, and one episode in eight diverged: the median is then the 4/7 quantile.
    let rounded = |random: &mut SplitMix64| (random.normal() * 10.0).round() / 10.0;
    let diverging = |random: &mut SplitMix64| {
        let value = random.uniform();
        if value < 0.875 { value } else { f64::INFINITY }
    };
    for n in [200, 501] {
        // Ties can only add to the coverage, by up to the probability of the median's own atom.
        assert!(simulated_coverage(&rounded, 0.0, n, &bca_95) > 0.935);
        let coverage = simulated_coverage(&diverging, 0.5, n, &bca_95);
        assert!((coverage - 0.95).abs() < 0.015, "{coverage} at n = {n}");
    }
}

#[test]
fn median_bca_coverage_of_every_even_sample_size_is_near_95_percent() {
    // The steps of a binomial (n, 1/2) distribution at the ends are 0.12 / sqrt(n) high, each.
    for n in (20..1000).step_by(2) {
        let covered = rank_coverage(&bca_95(&ranks(n)), n, 0.5);
        assert!((covered - 0.95).abs() < 0.2 / (n as f64).sqrt(), "{n}");
    }
}
