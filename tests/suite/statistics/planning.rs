//! How many runs a claim needs, its power, and what replicates say.

use proptest::prelude::*;
use urts_mc::statistics::{
    clopper_pearson_upper, failures_allowed, power, replicate_mean, replicate_p, runs_needed,
};

use super::random::SplitMix64;
use super::{count, for_each_case, number};

#[test]
fn val_runs_needed_are_those_of_the_success_run_table() {
    let zero_failures = [
        (0.01, 299),
        (0.0027, 1109),
        (0.001, 2995),
        (0.000_1, 29_956),
    ];
    for (rate, n) in zero_failures {
        assert_eq!(runs_needed(rate, 0.95, 0), Some(n));
    }
    for_each_case("runs_to_claim", |case, _| {
        let (rate, level) = (number(case, "rate"), number(case, "level"));
        let (failures, n) = (count(case, "failures"), count(case, "n"));
        assert_eq!(runs_needed(rate, level, failures), Some(n), "{case}");
        assert_eq!(failures_allowed(rate, level, n), Some(failures), "{case}");
    });
}

#[test]
fn val_runs_without_failure_follow_the_closed_form_down_to_rates_that_nobody_can_run() {
    for rate in [0.3_f64, 1e-3, 1e-6, 1e-9, 1e-11] {
        for level in [0.5_f64, 0.95, 0.999] {
            let closed_form = (1.0 - level).ln() / (-rate).ln_1p();
            // One run more or less would change the tail by the relative amount `rate`: 10^-11 is
            // still a hundred thousand times the rounding error of the logarithms.
            let n = runs_needed(rate, level, 0).unwrap();
            assert_eq!(n, closed_form.ceil() as u64, "{rate} {level}");
        }
    }
}

#[test]
fn val_power_and_allowed_failures_match_binomial_sums() {
    for_each_case("power", |case, check| {
        let (limit, confidence) = (number(case, "limit"), number(case, "confidence"));
        let n = count(case, "n");
        let allowed = case.get("allowed").map(|_| count(case, "allowed"));
        assert_eq!(failures_allowed(limit, confidence, n), allowed, "{case}");
        let true_rate = number(case, "true_rate");
        check("power", power(true_rate, limit, confidence, n));
    });
}

#[test]
fn power_falls_with_the_rate_and_a_false_proof_is_as_rare_as_promised() {
    for n in [299, 500, 1049, 4000] {
        let powers = [0.0, 0.001, 0.003, 0.006, 0.01].map(|rate| power(rate, 0.01, 0.95, n));
        assert_eq!(powers[0], 1.0);
        assert!(powers.windows(2).all(|pair| pair[0] > pair[1]));
        // At the limit itself: the level, exact as far as counts go.
        assert!(powers[4] <= 0.05 && powers[4] > 0.02, "{powers:?} at {n}");
    }
    assert_eq!(power(0.0, 0.01, 0.95, 298), 0.0);
}

#[test]
fn claims_that_no_run_can_prove_are_refused() {
    for rate in [0.0, 1.0, -0.1, 1.5, f64::NAN] {
        assert_eq!(runs_needed(rate, 0.95, 0), None);
        assert_eq!(runs_needed(0.01, rate, 0), None);
        assert_eq!(failures_allowed(rate, 0.95, 100), None);
        assert_eq!(failures_allowed(0.01, rate, 100), None);
    }
    assert_eq!(runs_needed(1e-300, 0.95, 0), None);
    assert_eq!(runs_needed(0.01, 0.95, u64::MAX), None);
    assert_eq!(failures_allowed(0.01, 0.95, 0), None);
    assert_eq!(failures_allowed(0.01, 0.95, u64::MAX), None);
    assert_eq!(power(f64::NAN, 0.01, 0.95, 1000), 0.0);
}

proptest! {
    #![proptest_config(super::properties::proptest_config())]

    #[test]
    fn runs_needed_are_enough_for_clopper_and_pearson_and_one_fewer_is_not(
        exponent in -5.0..-0.3_f64, level in 0.5..0.999_f64, failures in 0_u64..300,
    ) {
        let rate = 10_f64.powf(exponent);
        let n = runs_needed(rate, level, failures).unwrap();
        prop_assert!(clopper_pearson_upper(failures, n, level) <= rate);
        prop_assert!(clopper_pearson_upper(failures, n - 1, level) > rate);
        prop_assert!(runs_needed(rate, level, failures + 1).unwrap() > n);
        prop_assert_eq!(failures_allowed(rate, level, n), Some(failures));
        let before = failures_allowed(rate, level, n - 1);
        prop_assert_eq!(before, failures.checked_sub(1));
    }
}

#[test]
fn val_replicate_means_have_the_printed_t_quantiles() {
    // Two-sided 95 %, three decimals, as in any table of Student's t.
    let table = [
        (1, 12.706),
        (2, 4.303),
        (5, 2.571),
        (10, 2.228),
        (30, 2.042),
        (120, 1.980),
    ];
    for (freedom, t) in table {
        // One 1 among zeros: the mean is 1/n and its standard error 1/n as well.
        let mut values = vec![0.0; freedom + 1];
        values[0] = 1.0;
        let n = values.len() as f64;
        let estimate = replicate_mean(&values, 0.95).unwrap();
        assert!((estimate.value * n - 1.0).abs() < 1e-12);
        for end in [estimate.interval.lower, estimate.interval.upper] {
            // Half a unit of the last printed decimal.
            assert!(
                ((end * n - 1.0).abs() - t).abs() < 5e-4,
                "{end} for {freedom}"
            );
        }
        // Moved by t - 1 standard errors, the mean is t of them away from 0, where the p-value is 5 %: within 0.03
        // points, as the density at t is at most a quarter of that per printed unit. Without the move it is far from
        // that.
        let moved: Vec<f64> = values.iter().map(|value| value + (t - 1.0) / n).collect();
        let p = replicate_p(&moved).unwrap();
        assert!((p - 0.05).abs() < 3e-4, "{p} for {freedom}");
        assert!(replicate_p(&values).unwrap() > 0.3);
    }
    // Infinitely many degrees of freedom are those of the normal distribution.
    let many: Vec<f64> = (0..100_000).map(|i| f64::from(i % 2)).collect();
    let estimate = replicate_mean(&many, 0.95).unwrap();
    let half_width = 1.959_964 * 0.5 / 100_000_f64.sqrt();
    // t and z differ by the share (z^2 + 1) / (4 n) = 10^-5.
    assert!(((estimate.interval.upper - 0.5) / half_width - 1.0).abs() < 3e-5);
}

#[test]
fn one_replicate_has_no_interval_and_infinite_ones_no_mean() {
    let single = replicate_mean(&[0.25], 0.95).unwrap();
    assert_eq!(single.value, 0.25);
    assert_eq!(single.interval.lower, f64::NEG_INFINITY);
    assert_eq!(single.interval.upper, f64::INFINITY);
    assert_eq!(replicate_mean(&[], 0.95), None);
    assert_eq!(replicate_mean(&[0.0, f64::INFINITY], 0.95), None);
    assert_eq!(replicate_mean(&[0.0, f64::NAN], 0.95), None);
    let level = replicate_mean(&[0.0, 1.0], 1.0).unwrap().interval;
    assert_eq!(level.upper - level.lower, f64::INFINITY);
    // The sum of these overflows, their mean does not.
    let large = replicate_mean(&[1.5e308, 1.5e308], 0.95).unwrap();
    assert_eq!(large.value, 1.5e308);
    for nothing in [&[] as &[f64], &[0.25], &[0.5, 0.5], &[0.0, f64::NAN]] {
        assert_eq!(replicate_p(nothing), None);
    }
    // As sure as can be.
    assert!(replicate_p(&[1.0, 1.0 + 1e-12, 1.0]).unwrap() < 1e-20);
}

#[test]
fn the_test_over_replicates_keeps_its_level() {
    // Eight normal replicates, 4,000 times: rejected at 5 % in 3.6 to 6.4 % of them (four standard errors of 0.34
    // points), and far more often if the mean is one standard deviation off.
    let mut random = SplitMix64(19);
    let mut rejected = |mean: f64| {
        let mut sample = || (0..8).map(|_| mean + random.normal()).collect::<Vec<f64>>();
        let p_values = (0..4000).map(|_| replicate_p(&sample()).unwrap());
        p_values.filter(|p| *p <= 0.05).count()
    };
    let found = rejected(0.0);
    assert!((146..=254).contains(&found), "{found}");
    assert!(rejected(1.0) > 2000);
}
