//! Coverage and size by exact enumeration, each test with a wrong method that it must reject.

use urts_mc::statistics::{
    Interval, PairedFailures, clopper_pearson, clopper_pearson_upper, mcnemar_mid_p,
    paired_difference, quantile_interval, wilson,
};

use super::{count, for_each_case, holds, number, ranks, size};

/// All binomial probabilities by the recurrence from the mode, normalised; shares no code and no
/// special function with the crate.
fn binomial_distribution(n: usize, p: f64) -> Vec<f64> {
    let odds = p / (1.0 - p);
    let mode = (0..=n)
        .rfind(|&k| k as f64 <= (n + 1) as f64 * p)
        .unwrap_or(0);
    let mut weights = vec![0.0; n + 1];
    weights[mode] = 1.0;
    for k in mode..n {
        weights[k + 1] = weights[k] * (n - k) as f64 / (k + 1) as f64 * odds;
    }
    for k in (0..mode).rev() {
        weights[k] = weights[k + 1] * (k + 1) as f64 / (n - k) as f64 / odds;
    }
    let total: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / total).collect()
}

/// Exact probability that the interval of a binomial count holds the true rate.
pub(super) fn coverage(intervals: &[Interval], rate: f64) -> f64 {
    let distribution = binomial_distribution(intervals.len() - 1, rate);
    let covered = intervals.iter().zip(distribution);
    covered
        .filter(|(interval, _)| holds(interval, rate))
        .map(|(_, probability)| probability)
        .sum()
}

pub(super) fn for_all_counts(n: u64, interval: impl Fn(u64) -> Interval) -> Vec<Interval> {
    (0..=n).map(interval).collect()
}

/// Lowest exact coverage over sample sizes and rates, the rates dense at 0.
fn lowest_coverage(interval: impl Fn(u64, u64) -> Interval) -> f64 {
    let rates: Vec<f64> = (1..200)
        .map(|i| f64::from(i) / 200.0)
        .chain((1..50).map(|i| f64::from(i) / 5000.0))
        .collect();
    [1, 2, 5, 20, 100, 400]
        .map(|n| for_all_counts(n, |failures| interval(failures, n)))
        .iter()
        .flat_map(|intervals| rates.iter().map(|&rate| coverage(intervals, rate)))
        .fold(1.0, f64::min)
}

// Sums of up to 401 probabilities, each good to some 10^-14.
const ENUMERATION_TOLERANCE: f64 = 1e-11;

#[test]
fn clopper_pearson_covers_at_least_its_level_everywhere() {
    for level in [0.8, 0.95, 0.99] {
        let least = level - ENUMERATION_TOLERANCE;
        assert!(lowest_coverage(|failures, n| clopper_pearson(failures, n, level)) >= least);
        let one_sided = |failures, n| Interval {
            lower: 0.0,
            upper: clopper_pearson_upper(failures, n, level),
        };
        assert!(lowest_coverage(one_sided) >= least);
    }
}

#[test]
fn the_coverage_test_rejects_a_wald_interval() {
    let wald = |failures: u64, n: u64| {
        let rate = failures as f64 / n as f64;
        let half_width = 1.96 * (rate * (1.0 - rate) / n as f64).sqrt();
        Interval {
            lower: rate - half_width,
            upper: rate + half_width,
        }
    };
    assert!(lowest_coverage(wald) < 0.5);
    // The textbook case: about 13 % of all samples show no failure, and a zero-width interval.
    let intervals = for_all_counts(100, |failures| wald(failures, 100));
    assert!(coverage(&intervals, 0.02) < 0.90);
}

#[test]
fn val_wilson_has_the_enumerated_coverage() {
    for_each_case("wilson_coverage", |case, check| {
        let n = count(case, "n");
        let intervals = for_all_counts(n, |failures| wilson(failures, n, 0.95));
        check("coverage", coverage(&intervals, number(case, "p")));
    });
    for_each_case("wilson_mean_coverage", |case, check| {
        let n = count(case, "n");
        let intervals = for_all_counts(n, |failures| wilson(failures, n, 0.95));
        let rates = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0);
        let mean = rates.map(|rate| coverage(&intervals, rate)).sum::<f64>() / 1000.0;
        check("coverage", mean);
        // The score interval keeps its level on average: Agresti and Coull 1998.
        assert!((mean - 0.95).abs() < 0.005);
    });
}

/// Exact coverage of the q-quantile by an interval of ranks, for any continuous population.
pub(super) fn rank_coverage(interval: &Interval, n: usize, q: f64) -> f64 {
    let at_or_below = binomial_distribution(n, q);
    let counts = at_or_below.iter().enumerate();
    counts
        .filter(|&(k, _)| interval.lower <= k as f64 && (k as f64) < interval.upper)
        .map(|(_, probability)| probability)
        .sum()
}

#[test]
fn order_statistic_intervals_cover_at_least_their_level_and_no_narrower_ones_do() {
    let mut intervals = 0;
    for n in [6, 7, 20, 72, 200, 368, 1000] {
        for q in [0.05, 0.25, 0.5, 0.9, 0.95, 0.99] {
            for level in [0.8, 0.95, 0.99] {
                let Some(interval) = quantile_interval(&ranks(n), q, level) else {
                    continue;
                };
                intervals += 1;
                let covered = rank_coverage(&interval, n, q);
                assert!(covered >= level - ENUMERATION_TOLERANCE, "{n} {q} {level}");
                // Negative control: one rank less at both ends must fall short.
                let narrower = Interval {
                    lower: interval.lower + 1.0,
                    upper: interval.upper - 1.0,
                };
                assert!(rank_coverage(&narrower, n, q) < level, "{n} {q} {level}");
            }
        }
    }
    assert!(intervals > 60);
}

#[test]
fn order_statistic_intervals_cover_quantiles_of_populations_with_ties() {
    let (n, probabilities, level) = (8, [0.3, 0.45, 0.25], 0.9);
    let mut covered = 0.0;
    for sample in 0..3_usize.pow(n) {
        let digits = (0..n).map(|i| sample / 3_usize.pow(i) % 3);
        let probability: f64 = digits.clone().map(|digit| probabilities[digit]).product();
        let mut values: Vec<f64> = digits.map(|digit| digit as f64).collect();
        values.sort_by(f64::total_cmp);
        let interval = quantile_interval(&values, 0.5, level).unwrap();
        covered += probability * f64::from(u8::from(holds(&interval, 1.0)));
    }
    assert!(covered >= level);
}

#[test]
fn val_mcnemar_mid_p_has_the_enumerated_size_and_keeps_the_level() {
    let table: Vec<Vec<f64>> = (0..=100)
        .map(|n| (0..=n).map(|b| mcnemar_mid_p(b, n - b)).collect())
        .collect();
    let enumerated_size = |pairs, discordant, rejects: &dyn Fn(usize, usize) -> bool| -> f64 {
        let outer = binomial_distribution(pairs, discordant);
        let inner = |n: usize| -> f64 {
            let split = binomial_distribution(n, 0.5).into_iter().enumerate();
            let rejected = split.filter(|&(b, _)| rejects(b, n));
            rejected.map(|(_, probability)| probability).sum()
        };
        outer.iter().enumerate().map(|(n, p)| p * inner(n)).sum()
    };
    let mid_p = |b: usize, n: usize| table[n][b] <= 0.05;
    // Negative control: McNemar's uncorrected chi-squared test, known to exceed its level.
    let asymptotic = |b: usize, n: usize| {
        let difference = 2.0 * b as f64 - n as f64;
        n > 0 && difference.powi(2) / n as f64 >= 3.841_458_820_694_124
    };

    for_each_case("mcnemar_size", |case, check| {
        // Probability 1 has no odds; the next smaller double stands for it.
        let discordant = number(case, "discordant").min(1.0 - f64::EPSILON);
        check(
            "size",
            enumerated_size(size(case, "pairs"), discordant, &mid_p),
        );
    });
    let largest_size = |discordant: std::ops::Range<u32>,
                        rejects: &dyn Fn(usize, usize) -> bool| {
        let shares = discordant.map(|i| f64::from(i) / 20.0);
        shares
            .flat_map(|share| {
                [10, 20, 35, 50, 75, 100].map(|pairs| enumerated_size(pairs, share, rejects))
            })
            .fold(0.0, f64::max)
    };
    // Fagerland et al. report no violation of 5 % by mid-p in 9595 scenarios, and violations by the
    // asymptotic test. Here: up to half of the pairs discordant.
    assert!(largest_size(1..11, &mid_p) <= 0.05);
    assert!(largest_size(1..11, &asymptotic) > 0.053);
    // Beyond, mid-p exceeds the level a little: 5.03 % by enumeration in rational arithmetic.
    let beyond = largest_size(11..20, &mid_p);
    assert!(0.05 < beyond && beyond < 0.0503, "{beyond}");
}

#[test]
fn val_paired_difference_has_the_enumerated_coverage() {
    for_each_case("paired_difference_coverage", |case, check| {
        let pairs = count(case, "pairs");
        let (rate_a, rate_b) = (number(case, "only_a"), number(case, "only_b"));
        let mut covered = 0.0;
        for (only_a, p_a) in binomial_distribution(size(case, "pairs"), rate_a)
            .into_iter()
            .enumerate()
        {
            let rest = binomial_distribution(size(case, "pairs") - only_a, rate_b / (1.0 - rate_a));
            for (only_b, p_b) in rest.into_iter().enumerate() {
                let failures = PairedFailures {
                    both: 0,
                    only_a: only_a as u64,
                    only_b: only_b as u64,
                    neither: pairs - (only_a + only_b) as u64,
                };
                let difference = paired_difference(&failures, 0.95).unwrap();
                if holds(&difference.interval, rate_a - rate_b) {
                    covered += p_a * p_b;
                }
            }
        }
        check("coverage", covered);
    });
}
