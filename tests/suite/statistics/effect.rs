//! Effects of parameters: against SciPy, by brute force, and what they must not depend on.

use proptest::prelude::*;
use serde_json::Value;
use urts_mc::statistics::{
    Effect, Interval, Outcome, Permutations, Ranked, effects, holm, somers_d, spearman,
};

use super::random::SplitMix64;
use super::{for_each_case, number, numbers};

const PERMUTATIONS: Permutations = Permutations {
    seed: 2026,
    most: 999,
    shuffled: usize::MAX,
};
const SMALLEST_P: f64 = 1.0 / 1000.0;
const NOTHING_KNOWN: Interval = Interval {
    lower: -1.0,
    upper: 1.0,
};

fn ranked(values: &[f64]) -> Ranked {
    Ranked::of_all(values).unwrap()
}

fn metric(values: &[f64]) -> Outcome {
    Outcome::Metric(ranked(values))
}

fn effect(parameter: &[f64], outcome: &Outcome) -> Option<Effect> {
    effects(&[ranked(parameter)], outcome, 0.95, PERMUTATIONS)[0]
}

fn uniforms(random: &mut SplitMix64, n: usize) -> Vec<f64> {
    (0..n).map(|_| random.uniform()).collect()
}

fn floats(case: &Value, key: &str) -> Vec<f64> {
    numbers(&case[key])
}

#[test]
fn val_spearman_matches_scipy_with_ties_and_infinities() {
    for_each_case("spearman", |case, check| {
        let (x, mut y) = (floats(case, "x"), floats(case, "y"));
        for row in floats(case, "infinite") {
            y[row as usize] = f64::INFINITY;
        }
        let estimate = spearman(&ranked(&x), &ranked(&y), 0.95).unwrap();
        check("value", estimate.value);
        let reflected: Vec<f64> = y.iter().map(|y| -y).collect();
        let reflected = spearman(&ranked(&x), &ranked(&reflected), 0.95).unwrap();
        check("value", -reflected.value);
    });
}

#[test]
fn val_somers_d_matches_scipys_brunner_munzel_test() {
    for_each_case("somers_d", |case, check| {
        let (failed, survived) = (floats(case, "failed"), floats(case, "survived"));
        let values = [failed.clone(), survived.clone()].concat();
        let flags: Vec<bool> = (0..values.len()).map(|row| row < failed.len()).collect();
        let failures = Ranked::of_flags(&flags);
        let estimate = somers_d(&ranked(&values), &failures, number(case, "level")).unwrap();
        check("value", estimate.value);
        check("lower", estimate.interval.lower);
        check("upper", estimate.interval.upper);
    });
}

#[test]
fn val_the_share_between_levels_is_that_of_scipys_kruskal_wallis_test() {
    for_each_case("shape", |case, check| {
        let sizes = floats(case, "sizes");
        let levels = sizes.iter().zip(0_u32..);
        let parameter: Vec<f64> = levels
            .flat_map(|(&size, level)| vec![f64::from(level); size as usize])
            .collect();
        let outcome = metric(&floats(case, "y"));
        check("shape", effect(&parameter, &outcome).unwrap().shape);
    });
}

/// Spearman's correlation of rows with weights, by its definition: the mean distribution functions
/// at every row from all pairs of rows.
fn weighted_spearman(x: &[f64], y: &[f64], weights: &[f64]) -> f64 {
    let share_below = |values: &[f64], at: f64| -> f64 {
        let shares = values.iter().zip(weights).map(|(&value, weight)| {
            weight * (f64::from(u8::from(value < at)) + f64::from(u8::from(value <= at))) / 2.0
        });
        shares.sum()
    };
    let f: Vec<f64> = x.iter().map(|&at| share_below(x, at) - 0.5).collect();
    let g: Vec<f64> = y.iter().map(|&at| share_below(y, at) - 0.5).collect();
    let mean = |a: &[f64], b: &[f64]| -> f64 {
        let products = a.iter().zip(b).zip(weights);
        products.map(|((a, b), weight)| weight * a * b).sum()
    };
    mean(&f, &g) / (mean(&f, &f) * mean(&g, &g)).sqrt()
}

#[test]
fn val_the_error_of_spearman_is_the_scatter_of_its_numerical_derivatives() {
    // 30 degrees of freedom at 95 %.
    const T: f64 = 2.042_272_456_301_238;
    let mut random = SplitMix64(5);
    let n = 32;
    for rounding in [1e3, 1.5] {
        let round = |value: f64| (value * rounding).round();
        let x: Vec<f64> = (0..n).map(|_| round(random.normal())).collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| round(x / rounding + random.normal()))
            .collect();
        let derivative = |row: usize| {
            let at = |step: f64| {
                let mut weights = vec![(1.0 - step) / n as f64; n];
                weights[row] += step;
                weighted_spearman(&x, &y, &weights)
            };
            (at(1e-5) - at(-1e-5)) / 2e-5
        };
        let squares: f64 = (0..n).map(|row| derivative(row).powi(2)).sum();
        let error = (squares / (n * (n - 1)) as f64).sqrt();

        let estimate = spearman(&ranked(&x), &ranked(&y), 0.95).unwrap();
        let even = vec![1.0 / n as f64; n];
        assert!((estimate.value - weighted_spearman(&x, &y, &even)).abs() < 1e-13);
        let half_width = T * error / (1.0 - estimate.value.powi(2));
        for (end, sign) in [
            (estimate.interval.lower, -1.0),
            (estimate.interval.upper, 1.0),
        ] {
            let expected = (estimate.value.atanh() + sign * half_width).tanh();
            // Central differences of 10^-5: cubic terms of 10^-10, rounding of 10^-11.
            assert!((end - expected).abs() < 1e-8, "{end} {expected}");
        }
    }
}

#[test]
fn too_few_rows_and_too_few_failures_have_no_interval_and_perfect_order_has_one() {
    let rows = |n: usize| (0..n).map(|i| i as f64).collect::<Vec<f64>>();
    let few = spearman(&ranked(&rows(19)), &ranked(&rows(19)), 0.95).unwrap();
    assert_eq!((few.value, few.interval), (1.0, NOTHING_KNOWN));

    let x = rows(100);
    let falling: Vec<f64> = x.iter().map(|x| -x).collect();
    let perfect = spearman(&ranked(&x), &ranked(&falling), 0.95).unwrap();
    assert_eq!((perfect.value, perfect.interval.lower), (-1.0, -1.0));
    // 50 pairs in order: the share out of order is below 1 - 0.05^(1/50) = 0.0582.
    let bound = -1.0 + 3.0 * (1.0 - 0.05_f64.powf(0.02));
    assert!((perfect.interval.upper - bound).abs() < 1e-12);

    let flags = |failures: usize| {
        Ranked::of_flags(&x.iter().map(|&x| x < failures as f64).collect::<Vec<_>>())
    };
    let single = somers_d(&ranked(&x), &flags(1), 0.95).unwrap();
    assert_eq!((single.value, single.interval), (-1.0, NOTHING_KNOWN));
    // Two failures at the two ends scatter more than any two can on average; they count as two pairs,
    // and t = 12.706 with one degree of freedom.
    let ends: Vec<bool> = (0..100).map(|row| row % 99 == 0).collect();
    let ends = somers_d(&ranked(&x), &Ranked::of_flags(&ends), 0.95).unwrap();
    let t = 12.706_204_736_f64;
    let half_width = 2.0 * t * (0.125 + (t / 4.0).powi(2)).sqrt() / (1.0 + t * t / 2.0);
    assert_eq!(ends.value, 0.0);
    assert!((ends.interval.upper - half_width).abs() < 1e-9);
    let separated = somers_d(&ranked(&x), &flags(10), 0.95).unwrap();
    assert_eq!((separated.value, separated.interval.lower), (-1.0, -1.0));
    assert!(separated.interval.upper > -0.8 && separated.interval.upper < -0.3);
}

/// Calls `visit` with every arrangement of the values.
fn for_each_permutation(values: &mut Vec<f64>, fixed: usize, visit: &mut dyn FnMut(&[f64])) {
    if fixed == values.len() {
        visit(values);
    }
    for next in fixed..values.len() {
        values.swap(fixed, next);
        for_each_permutation(values, fixed + 1, visit);
        values.swap(fixed, next);
    }
}

#[test]
fn val_permutation_p_values_average_to_the_enumeration_of_all_permutations() {
    // Two bins of four rows each, and ties in both columns.
    let x = [1.0, 2.0, 3.0, 3.0, 5.0, 6.0, 7.0, 8.0];
    let y = [0.0, 2.0, 2.0, 1.0, 5.0, 3.0, 4.0, 2.0];
    // The tests' statistics by plain means: |covariance| of ranks, and squares between the halves.
    let rank_x = [1.0, 2.0, 3.5, 3.5, 5.0, 6.0, 7.0, 8.0];
    let rank_y = [1.0, 4.0, 4.0, 2.0, 8.0, 6.0, 7.0, 4.0];
    let statistics = |rank_y: &[f64]| {
        let products = rank_x
            .iter()
            .zip(rank_y)
            .map(|(x, y)| (x - 4.5) * (y - 4.5));
        let half: f64 = rank_y[..4].iter().map(|y| y - 4.5).sum();
        [products.sum::<f64>().abs(), half * half]
    };
    let observed = statistics(&rank_y);
    let (mut all, mut as_extreme) = (0, [0, 0]);
    for_each_permutation(&mut rank_y.to_vec(), 0, &mut |permuted| {
        all += 1;
        for ((count, value), observed) in as_extreme
            .iter_mut()
            .zip(statistics(permuted))
            .zip(observed)
        {
            // The ranks are quarters of whole numbers, and their products exact.
            *count += u32::from(value >= observed);
        }
    });
    let exact = as_extreme.map(|count| f64::from(count) / f64::from(all));

    let (seeds, most) = (2000, 40);
    let (mut sums, mut squares) = ([0.0, 0.0], [0.0, 0.0]);
    for seed in 0..seeds {
        let permutations = Permutations {
            seed,
            most,
            shuffled: usize::MAX,
        };
        let effect = effects(&[ranked(&x)], &metric(&y), 0.95, permutations)[0].unwrap();
        for (i, p) in [effect.trend_p, effect.shape_p].into_iter().enumerate() {
            let extreme = p * f64::from(most + 1) - 1.0;
            sums[i] += extreme;
            squares[i] += extreme * extreme;
        }
    }
    for ((sum, squares), exact) in sums.into_iter().zip(squares).zip(exact) {
        assert!(exact < 0.2);
        // b of (b + 1) / (m + 1) is binomial: its mean, with four standard errors of 2000 seeds, ..
        let m = f64::from(most);
        let mean = sum / seeds as f64;
        let variance = m * exact * (1.0 - exact);
        assert!(
            (mean - m * exact).abs() < 4.0 * (variance / seeds as f64).sqrt(),
            "{mean} {exact}"
        );
        // .. and its variance (4 x sqrt(2 / 2000) = 13 %), which repeated permutations would raise.
        let scatter = squares / seeds as f64 - mean * mean;
        assert!(
            (scatter / variance - 1.0).abs() < 0.13,
            "{scatter} {variance}"
        );
    }
}

#[test]
fn an_effect_of_the_distance_from_the_middle_is_found_where_no_trend_is() {
    let mut random = SplitMix64(7);
    let (x, idle) = (uniforms(&mut random, 1000), uniforms(&mut random, 1000));
    let y: Vec<f64> = x
        .iter()
        .map(|x| (x - 0.5).abs() + 0.2 * random.normal())
        .collect();
    let failed: Vec<bool> = y.iter().map(|&y| y > 0.6).collect();
    for outcome in [metric(&y), Outcome::Failure(Ranked::of_flags(&failed))] {
        let found = effect(&x, &outcome).unwrap();
        assert_eq!(found.shape_p, SMALLEST_P);
        assert!(
            found.trend_p > 0.05 && found.trend.value.abs() < 0.1,
            "{found:?}"
        );
        let nothing = effect(&idle, &outcome).unwrap();
        assert!(
            nothing.p_value() > 0.05 && nothing.shape < 0.02,
            "{nothing:?}"
        );
        assert!(found.shape > 2.0 * nothing.shape + 0.02, "{found:?}");
    }
}

#[test]
fn a_monotone_effect_is_found_with_its_sign_on_metrics_and_on_failures() {
    let mut random = SplitMix64(8);
    let x = uniforms(&mut random, 1000);
    let y: Vec<f64> = x
        .iter()
        .map(|x| 1.0 / (1.2 - x) + random.normal())
        .collect();
    let diverging: Vec<f64> = y
        .iter()
        .map(|&y| if y > 4.0 { f64::INFINITY } else { y })
        .collect();
    let failed = Ranked::of_flags(&y.iter().map(|&y| y > 4.0).collect::<Vec<_>>());
    for outcome in [metric(&y), metric(&diverging), Outcome::Failure(failed)] {
        let found = effect(&x, &outcome).unwrap();
        assert_eq!(found.trend_p, SMALLEST_P);
        assert!(found.trend.interval.lower > 0.1, "{found:?}");
        let opposite: Vec<f64> = x.iter().map(|x| -x).collect();
        let opposite = effect(&opposite, &outcome).unwrap();
        // Sums in another order.
        assert!((opposite.trend.value + found.trend.value).abs() < 1e-12);
        assert_eq!(opposite.trend_p, found.trend_p);
    }
}

#[test]
fn what_says_nothing_has_no_effect() {
    let x: Vec<f64> = (0..50).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
    assert_eq!(effect(&[3.0; 50], &metric(&y)), None);
    assert_eq!(effect(&x, &metric(&[3.0; 50])), None);
    assert_eq!(effect(&x, &metric(&y[..49])), None);
    assert_eq!(effect(&[], &metric(&[])), None);
    for flag in [true, false] {
        let failures = Outcome::Failure(Ranked::of_flags(&[flag; 50]));
        assert_eq!(effect(&x, &failures), None);
    }
    let none = Ranked::of(&[None; 50]).unwrap();
    assert!(none.is_empty());
    assert_eq!(effects(&[none], &metric(&y), 0.95, PERMUTATIONS), [None]);
    assert_eq!(Ranked::of_all(&[1.0, f64::NAN]), None);
    for level in [0.0, 1.0, f64::NAN] {
        assert_eq!(spearman(&ranked(&x), &ranked(&y), level), None);
    }
}

#[test]
fn a_parameter_is_judged_by_the_rows_where_it_applies() {
    let mut random = SplitMix64(9);
    let n = 400;
    let (x, y) = (uniforms(&mut random, n), uniforms(&mut random, n));
    let y: Vec<f64> = x.iter().zip(y).map(|(x, y)| x + 3.0 * y).collect();
    let applies = |row: usize| row.is_multiple_of(3);
    let column: Vec<Option<f64>> = (0..n).map(|row| applies(row).then_some(x[row])).collect();
    let kept = |values: &[f64]| -> Vec<f64> {
        (0..n)
            .filter(|&row| applies(row))
            .map(|row| values[row])
            .collect()
    };
    let whole = effects(
        &[Ranked::of(&column).unwrap()],
        &metric(&y),
        0.95,
        PERMUTATIONS,
    )[0];
    let part = effect(&kept(&x), &metric(&kept(&y)));
    assert_eq!(whole, part);
    assert_eq!(whole.unwrap().n, 134);
}

#[test]
fn effects_depend_on_ranks_and_seed_alone() {
    let mut random = SplitMix64(10);
    let n = 300;
    let columns: Vec<Vec<f64>> = (0..4).map(|_| uniforms(&mut random, n)).collect();
    let tied: Vec<f64> = columns[3].iter().map(|x| (4.0 * x).floor()).collect();
    let parameters = [&columns[0], &columns[1], &tied].map(|column| ranked(column));
    let y: Vec<f64> = (0..n)
        .map(|row| columns[0][row] + columns[2][row])
        .collect();
    let all = effects(&parameters, &metric(&y), 0.95, PERMUTATIONS);

    // Alone as in a family, on one thread as on two.
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            for (parameter, effect) in parameters.iter().zip(&all) {
                let alone = effects(
                    std::slice::from_ref(parameter),
                    &metric(&y),
                    0.95,
                    PERMUTATIONS,
                );
                assert_eq!(alone[0], *effect);
            }
        });
    }
    // Under a monotone function of the outcome, and in any order of the rows.
    let cubed: Vec<f64> = y.iter().map(|y| (3.0 * y).exp()).collect();
    assert_eq!(
        effects(&parameters, &metric(&cubed), 0.95, PERMUTATIONS),
        all
    );
    let backwards = |values: &[f64]| values.iter().rev().copied().collect::<Vec<f64>>();
    let reversed = effect(&backwards(&columns[1]), &metric(&backwards(&y))).unwrap();
    assert_eq!(reversed.p_value(), all[1].unwrap().p_value());
    assert!((reversed.trend.value - all[1].unwrap().trend.value).abs() < 1e-14);
    // But not whatever the seed.
    let other = Permutations {
        seed: 1,
        ..PERMUTATIONS
    };
    assert_ne!(effects(&parameters, &metric(&y), 0.95, other)[1], all[1]);
}

#[test]
fn val_holm_adjusts_the_textbook_example() {
    // 3 x 0.01 is below 4 x 0.005 = 0.02 no longer: steps and ties in one example.
    let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
    for (actual, expected) in adjusted.iter().zip([0.03, 0.06, 0.06, 0.02]) {
        assert!((actual - expected).abs() < 1e-15);
    }
    assert!(holm(&[]).is_empty());
    assert_eq!(holm(&[0.5, f64::NAN, 0.7, -1.0]), [1.0; 4]);
}

proptest! {
    #![proptest_config(super::properties::proptest_config())]

    #[test]
    fn holm_keeps_the_order_and_lies_between_no_correction_and_bonferroni(
        p_values in prop::collection::vec(0.0..1.0_f64, 1..40),
    ) {
        let adjusted = holm(&p_values);
        let family = p_values.len() as f64;
        for (p, a) in p_values.iter().zip(&adjusted) {
            prop_assert!(p <= a && *a <= (p * family).min(1.0));
            for (q, b) in p_values.iter().zip(&adjusted) {
                prop_assert!(p > q || a <= b);
            }
        }
    }

    #[test]
    fn rank_correlations_hold_their_interval_and_change_sign_with_a_column(
        rows in prop::collection::vec((-4..4_i32, -9..9_i32, any::<bool>()), 20..80),
        level in 0.5..0.99_f64,
    ) {
        let x: Vec<f64> = rows.iter().map(|row| f64::from(row.0)).collect();
        let y: Vec<f64> = rows.iter().map(|row| f64::from(row.1)).collect();
        let failed: Vec<bool> = rows.iter().map(|row| row.2).collect();
        let reflected = ranked(&x.iter().map(|x| -x).collect::<Vec<f64>>());
        let failures = Ranked::of_flags(&failed);
        let pairs = [
            (spearman(&ranked(&x), &ranked(&y), level), spearman(&reflected, &ranked(&y), level)),
            (somers_d(&ranked(&x), &failures, level), somers_d(&reflected, &failures, level)),
        ];
        for (here, there) in pairs {
            prop_assert_eq!(here.is_some(), there.is_some());
            let (Some(here), Some(there)) = (here, there) else { continue };
            let Interval { lower, upper } = here.interval;
            prop_assert!(-1.0 <= lower && lower <= here.value && here.value <= upper && upper <= 1.0);
            // Sums in another order.
            prop_assert!((here.value + there.value).abs() < 1e-12);
            prop_assert!((lower + there.interval.upper).abs() < 1e-9);
            prop_assert!((upper + there.interval.lower).abs() < 1e-9);
        }
    }
}
