//! Statistics against printed tables and SciPy. The reference numbers, their sources and their
//! tolerances are in `golden/statistics.json` and `golden/planning_and_effects.json`. Coverage and
//! properties are in the submodules.

use serde_json::Value;
use urts_mc::statistics::{
    Interval, PairedFailures, clopper_pearson, clopper_pearson_upper, mcnemar_mid_p, median_bca,
    paired_difference, quantile, quantile_interval, wilson,
};

mod coverage;
mod difference;
mod effect;
mod effect_level;
mod large_sample;
mod level;
mod median;
mod planning;
mod properties;
mod random;
mod sequential;

fn golden(group: &str) -> Value {
    let texts = [
        include_str!("../golden/statistics.json"),
        include_str!("../golden/planning_and_effects.json"),
    ];
    let files = texts.map(|text| serde_json::from_str::<Value>(text).unwrap());
    let found = files.iter().find_map(|file| file.get(group));
    found.unwrap().clone()
}

/// Calls `compare` with each case of a group and a check of one of its numbers.
fn for_each_case(group: &str, compare: impl Fn(&Value, &dyn Fn(&str, f64))) {
    let group = golden(group);
    let cases = group["cases"].as_array().unwrap();
    assert!(!cases.is_empty());
    for case in cases {
        let tolerance = case.get("tolerance").unwrap_or(&group["tolerance"]);
        let check = |key: &str, actual: f64| {
            let expected = number(case, key);
            let scale = if group.get("relative").is_some() {
                expected.abs()
            } else {
                1.0
            };
            let allowed = tolerance.as_f64().unwrap() * scale;
            assert!(
                (actual - expected).abs() <= allowed,
                "{key}: {actual:e} is not {expected:e} within {allowed:e} in {case}"
            );
        };
        compare(case, &check);
    }
}

fn number(case: &Value, key: &str) -> f64 {
    case[key].as_f64().unwrap()
}

fn count(case: &Value, key: &str) -> u64 {
    case[key].as_u64().unwrap()
}

fn size(case: &Value, key: &str) -> usize {
    usize::try_from(count(case, key)).unwrap()
}

fn numbers(values: &Value) -> Vec<f64> {
    let values = values.as_array().unwrap();
    values.iter().map(|v| v.as_f64().unwrap()).collect()
}

/// The values 1, 2, .. n, so that an interval of values is an interval of ranks.
fn ranks(n: usize) -> Vec<f64> {
    (1..=n).map(|rank| rank as f64).collect()
}

fn holds(interval: &Interval, value: f64) -> bool {
    interval.lower <= value && value <= interval.upper
}

#[test]
fn val_wilson_matches_newcombe_and_scipy() {
    for group in ["wilson_published", "wilson"] {
        for_each_case(group, |case, check| {
            let (failures, n) = (count(case, "failures"), count(case, "n"));
            let interval = wilson(failures, n, number(case, "level"));
            check("lower", interval.lower);
            check("upper", interval.upper);
        });
    }
}

#[test]
fn val_clopper_pearson_matches_newcombe_and_scipy() {
    for group in ["clopper_pearson_published", "clopper_pearson"] {
        for_each_case(group, |case, check| {
            let (failures, n) = (count(case, "failures"), count(case, "n"));
            let interval = clopper_pearson(failures, n, number(case, "level"));
            check("lower", interval.lower);
            check("upper", interval.upper);
        });
    }
    for_each_case("clopper_pearson_upper", |case, check| {
        let (failures, n) = (count(case, "failures"), count(case, "n"));
        let bound = clopper_pearson_upper(failures, n, number(case, "level"));
        check("upper", bound);
    });
}

#[test]
fn val_zero_failures_bound_the_rate_by_the_closed_form() {
    for n in [1, 2, 10, 299, 1024, 1_000_000] {
        for level in [0.5, 0.9, 0.95, 0.999] {
            let closed_form = -((1.0_f64 - level).ln() / n as f64).exp_m1();
            let bound = clopper_pearson_upper(0, n, level);
            // The log-gamma of 10^6 is about 10^7, good to 10^-15 of that at best.
            assert!((bound / closed_form - 1.0).abs() < 1e-10, "{n} at {level}");
        }
    }
}

#[test]
fn val_a_claim_needs_as_many_runs_as_the_success_run_table_says() {
    for_each_case("runs_to_claim", |case, _| {
        let (failures, n) = (count(case, "failures"), count(case, "n"));
        let (rate, level) = (number(case, "rate"), number(case, "level"));
        assert!(clopper_pearson_upper(failures, n, level) <= rate, "{case}");
        assert!(
            clopper_pearson_upper(failures, n - 1, level) > rate,
            "{case}"
        );
    });
}

#[test]
fn val_mcnemar_mid_p_matches_published_examples_and_exact_arithmetic() {
    for group in [
        "mcnemar_mid_p_published",
        "mcnemar_mid_p",
        "mcnemar_mid_p_large",
    ] {
        for_each_case(group, |case, check| {
            check(
                "p",
                mcnemar_mid_p(count(case, "only_a"), count(case, "only_b")),
            );
        });
    }
}

#[test]
fn val_paired_difference_matches_published_examples_and_scipy() {
    for group in ["paired_difference_published", "paired_difference"] {
        for_each_case(group, |case, check| {
            let failures = PairedFailures {
                both: count(case, "both"),
                only_a: count(case, "only_a"),
                only_b: count(case, "only_b"),
                neither: count(case, "neither"),
            };
            let difference = paired_difference(&failures, number(case, "level")).unwrap();
            check("lower", difference.interval.lower);
            check("upper", difference.interval.upper);
            if case.get("value").is_some() {
                check("value", difference.value);
            }
        });
    }
}

#[test]
fn val_quantiles_are_those_of_numpy_inverted_cdf() {
    let sorted = numbers(&golden("quantile")["sorted"]);
    for_each_case("quantile", |case, check| {
        check("value", quantile(&sorted, number(case, "q")).unwrap());
    });
    // 0.07 x 100 exceeds 7 in double precision, and yet the 7 % quantile of 100 is the 7th value.
    let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
    assert_eq!(quantile(&hundred, 0.07), Some(7.0));
}

#[test]
fn val_median_intervals_have_the_ranks_of_nairs_table() {
    for_each_case("median_ranks_published", |case, _| {
        let n = size(case, "n");
        for (key, level) in [("k_95", 0.95), ("k_99", 0.99)] {
            let expected = case[key].as_f64().map(|k| Interval {
                lower: k,
                upper: n as f64 + 1.0 - k,
            });
            assert_eq!(
                quantile_interval(&ranks(n), 0.5, level),
                expected,
                "{key} {case}"
            );
        }
    });
}

#[test]
fn val_quantile_intervals_match_printed_example_and_binomial_ranks() {
    let example = golden("median_interval_published");
    let mut values = numbers(&example["values"]);
    values.sort_by(f64::total_cmp);
    let interval = quantile_interval(&values, 0.5, number(&example, "level")).unwrap();
    assert_eq!(interval.lower, number(&example, "lower"));
    assert_eq!(interval.upper, number(&example, "upper"));
    assert_eq!(quantile(&values, 0.5), example["quantile"].as_f64());

    for_each_case("quantile_ranks", |case, _| {
        let values = ranks(size(case, "n"));
        let interval = quantile_interval(&values, number(case, "q"), number(case, "level"));
        let expected = case["lower"].as_f64().map(|lower| Interval {
            lower,
            upper: number(case, "upper"),
        });
        assert_eq!(interval, expected, "{case}");
    });
}

#[test]
fn val_median_bca_matches_scipy_bootstrap() {
    for_each_case("median_bca", |case, check| {
        let estimate = median_bca(&numbers(&case["values"]), number(case, "level")).unwrap();
        check("value", estimate.value);
        check("lower", estimate.interval.lower);
        check("upper", estimate.interval.upper);
    });
}
