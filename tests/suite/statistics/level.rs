//! Every method on synthetic campaigns whose truth is known: 2,000 or more each, with fixed seeds.
//! Intervals must cover it, and tests must not reject it, as often as they say.
//!
//! Where coverage can be enumerated (`coverage`, `median`, `sequential`), that is the sharper test,
//! and this is its check against chance itself. The methods on ranks are in `effect_level`.

use urts_mc::statistics::{
    Interval, PairedFailures, clopper_pearson, clopper_pearson_upper, mcnemar_mid_p,
    paired_difference, quantile_interval, wilson, win_rate,
};

use super::coverage::{coverage, for_all_counts, rank_coverage};
use super::random::SplitMix64;
use super::{holds, ranks};

const EXPERIMENTS: u32 = 2000;
/// Three standard errors of a share near 95 % or 5 %: 1.5 points.
pub(super) const NOISE: f64 = 0.0147;

/// Share of the experiments in which `happens`.
pub(super) fn share(seed: u64, mut happens: impl FnMut(&mut SplitMix64) -> bool) -> f64 {
    let mut random = SplitMix64(seed);
    let count = (0..EXPERIMENTS).filter(|_| happens(&mut random)).count();
    count as f64 / f64::from(EXPERIMENTS)
}

fn failures_of(random: &mut SplitMix64, n: u64, rate: f64) -> u64 {
    (0..n).filter(|_| random.uniform() < rate).count() as u64
}

#[test]
fn intervals_of_a_failure_rate_cover_as_enumerated_and_exact_ones_their_level() {
    let upper = |failures, n, level| Interval {
        lower: 0.0,
        upper: clopper_pearson_upper(failures, n, level),
    };
    let mut seed = 0;
    for n in [20, 200, 1000] {
        for rate in [0.01, 0.1, 0.5] {
            for (interval, is_exact) in [
                (wilson as fn(_, _, _) -> _, false),
                (clopper_pearson, true),
                (upper, true),
            ] {
                seed += 1;
                let intervals = for_all_counts(n, |failures| interval(failures, n, 0.95));
                let enumerated = coverage(&intervals, rate);
                let simulated = share(seed, |random| {
                    let failures = failures_of(random, n, rate);
                    holds(&intervals[usize::try_from(failures).unwrap()], rate)
                });
                assert!(
                    (simulated - enumerated).abs() < NOISE,
                    "{simulated} {enumerated}"
                );
                assert!(
                    !is_exact || simulated >= 0.95 - NOISE,
                    "{simulated} {n} {rate}"
                );
            }
        }
    }
}

#[test]
fn order_statistic_intervals_cover_at_least_their_level_and_say_where_there_are_none() {
    for (seed, (n, q)) in (1..).zip([(20, 0.5), (100, 0.5), (100, 0.95), (400, 0.99)]) {
        let truth = -(1.0_f64 - q).ln();
        let simulated = share(seed, |random| {
            let mut values: Vec<f64> = (0..n).map(|_| -random.uniform().ln()).collect();
            values.sort_by(f64::total_cmp);
            holds(&quantile_interval(&values, q, 0.95).unwrap(), truth)
        });
        let enumerated = rank_coverage(&quantile_interval(&ranks(n), q, 0.95).unwrap(), n, q);
        assert!(
            (simulated - enumerated).abs() < NOISE,
            "{simulated} {enumerated}"
        );
        assert!(simulated >= 0.95 - NOISE);
    }
    for (n, q) in [(5, 0.5), (71, 0.95), (367, 0.99)] {
        assert_eq!(quantile_interval(&ranks(n), q, 0.95), None);
        assert!(quantile_interval(&ranks(n + 1), q, 0.95).is_some());
    }
}

#[test]
fn paired_statistics_keep_their_level_on_correlated_failures() {
    // Pairs with a failure of A alone, of B alone, or of both.
    let draw = |random: &mut SplitMix64, n: u32, rates: [f64; 3]| {
        let mut pairs = PairedFailures {
            both: 0,
            only_a: 0,
            only_b: 0,
            neither: 0,
        };
        for _ in 0..n {
            let u = random.uniform();
            let [only_a, only_b, both] = rates;
            if u < only_a {
                pairs.only_a += 1;
            } else if u < only_a + only_b {
                pairs.only_b += 1;
            } else if u < only_a + only_b + both {
                pairs.both += 1;
            } else {
                pairs.neither += 1;
            }
        }
        pairs
    };
    for (seed, n) in (1..).zip([50, 200, 1000]) {
        let rejected = share(seed, |random| {
            let pairs = draw(random, n, [0.1, 0.1, 0.2]);
            mcnemar_mid_p(pairs.only_a, pairs.only_b) <= 0.05
        });
        assert!(rejected <= 0.05 + NOISE, "{rejected} at {n}");

        let rates = [0.15, 0.05, 0.2];
        let difference = share(100 + seed, |random| {
            let estimate = paired_difference(&draw(random, n, rates), 0.95).unwrap();
            holds(&estimate.interval, 0.1)
        });
        let wins = share(200 + seed, |random| {
            let pairs = draw(random, n, rates);
            let ties = pairs.both + pairs.neither;
            let estimate = win_rate(pairs.only_a, pairs.only_b, ties, 0.95).unwrap();
            holds(&estimate.interval, 0.55)
        });
        assert!((difference - 0.95).abs() < NOISE, "{difference} at {n}");
        assert!((wins - 0.95).abs() < NOISE, "{wins} at {n}");
    }
}
