//! Bounds that hold at every look: exactly, by simulation, and against a bound that does not.

use proptest::prelude::*;
use urts_mc::statistics::{
    Proof, clopper_pearson, failures_allowed, runs_needed, sequential_interval, sequential_lower,
    sequential_proof, sequential_runs_needed, sequential_upper,
};

use super::random::SplitMix64;
use super::{count, for_each_case, holds, number};

#[test]
fn val_the_upper_bound_matches_numerical_integration() {
    for_each_case("sequential_upper", |case, check| {
        let (failures, n) = (count(case, "failures"), count(case, "n"));
        let level = number(case, "level");
        check("upper", sequential_upper(failures, n, level));
        let mirrored = 1.0 - sequential_lower(n - failures, n, level);
        check("upper", mirrored);
    });
}

#[test]
fn val_the_price_of_looking_is_about_half_as_many_runs_again() {
    // Runs without failure until the proof, and for a fixed number of runs.
    for (limit, runs, fixed) in [(0.05, 88, 59), (0.01, 449, 299), (0.001, 4512, 2995)] {
        assert_eq!(sequential_proof(0, runs, limit, 0.95), Proof::Below);
        assert_eq!(sequential_proof(0, runs - 1, limit, 0.95), Proof::Undecided);
        assert_eq!(failures_allowed(limit, 0.95, fixed), Some(0));
        assert_eq!(failures_allowed(limit, 0.95, fixed - 1), None);
    }
    // A mixture over all rates of [0, 1] would wait for (n + 1) 0.99^n <= 0.05.
    let by_all_rates = (1..).find(|&n| f64::from(n + 1) * 0.99_f64.powi(n) <= 0.05);
    assert_eq!(by_all_rates, Some(984));
}

/// After each of 1..=most episodes: the largest number of failures that proves the rate below the
/// limit (-1 for none), and the smallest that proves it above (n + 1 for none).
fn decided(most: u64, proof: impl Fn(u64, u64) -> Proof) -> Vec<(i64, i64)> {
    let (mut below, mut above) = (-1, 1);
    let mut boundaries = Vec::new();
    for n in 1..=most {
        let proves = |failures: i64, wanted| {
            let failures = u64::try_from(failures).unwrap();
            failures <= n && proof(failures, n) == wanted
        };
        while proves(below + 1, Proof::Below) {
            below += 1;
        }
        // One episode more may move the upper boundary by one, not more.
        while above <= i64::try_from(n).unwrap() && !proves(above, Proof::Above) {
            above += 1;
        }
        boundaries.push((below, above));
    }
    boundaries
}

/// Exact probabilities of ever crossing below and above, by the distribution of the failures of
/// those campaigns that go on.
fn crossing(boundaries: &[(i64, i64)], rate: f64) -> (f64, f64) {
    let mut going_on = vec![0.0; boundaries.len() + 2];
    going_on[0] = 1.0;
    let (mut below, mut above) = (0.0, 0.0);
    for (n, &(last_below, first_above)) in (1..).zip(boundaries) {
        let most = first_above.min(n);
        for failures in (0..=most).rev() {
            let k = usize::try_from(failures).unwrap();
            let before = if k > 0 { going_on[k - 1] } else { 0.0 };
            going_on[k] = going_on[k] * (1.0 - rate) + before * rate;
            if failures <= last_below {
                below += std::mem::take(&mut going_on[k]);
            } else if failures >= first_above {
                above += std::mem::take(&mut going_on[k]);
            }
        }
    }
    (below, above)
}

const EPISODES: u64 = 10_000;
const RATES: [f64; 5] = [0.001, 0.01, 0.05, 0.3, 0.9];

#[test]
fn a_look_after_every_episode_errs_no_more_often_than_the_level_says() {
    let experiments = 2000;
    // Three standard errors of a share of 5 %; exact enumeration has none.
    let noise = 3.0 * (0.05 * 0.95 / f64::from(experiments)).sqrt();
    for (seed, rate) in (1..).zip(RATES) {
        let boundaries = decided(EPISODES, |k, n| sequential_proof(k, n, rate, 0.95));
        let exact = crossing(&boundaries, rate);

        let mut random = SplitMix64(seed);
        let mut errors = [0, 0];
        for _ in 0..experiments {
            let mut failures = 0;
            let first = boundaries.iter().find_map(|&(last_below, first_above)| {
                failures += i64::from(random.uniform() < rate);
                let is_below = failures <= last_below;
                (is_below || failures >= first_above).then_some(is_below)
            });
            match first {
                Some(true) => errors[0] += 1,
                Some(false) => errors[1] += 1,
                None => {}
            }
        }
        let simulated = errors.map(|count| f64::from(count) / f64::from(experiments));
        println!("{rate}: exact {exact:?}, simulated {simulated:?}");
        for (exact, simulated) in [exact.0, exact.1].into_iter().zip(simulated) {
            assert!(exact <= 0.05, "{exact} at {rate}");
            assert!((simulated - exact).abs() < noise, "{simulated} at {rate}");
        }
        // Not by never deciding: what is not used up belongs to later episodes.
        assert!(exact.0.max(exact.1) > 0.01, "{exact:?} at {rate}");
    }
}

#[test]
fn a_fixed_size_bound_that_is_looked_at_after_every_episode_loses_its_level() {
    let rate = 0.05;
    let boundaries = decided(EPISODES, |k, n| {
        match failures_allowed(rate, 0.95, n).is_some_and(|allowed| k <= allowed) {
            true => Proof::Below,
            false => Proof::Undecided,
        }
    });
    let (below, _) = crossing(&boundaries, rate);
    println!("repeated Clopper-Pearson proofs of a false claim: {below}");
    assert!(below > 0.2);
}

#[test]
fn the_two_sided_sequence_holds_the_rate_at_all_looks_together() {
    let (rate, most) = (0.1, 400);
    let boundaries = decided(most, |k, n| {
        let interval = sequential_interval(k, n, 0.95);
        if interval.upper < rate {
            Proof::Below
        } else if interval.lower > rate {
            Proof::Above
        } else {
            Proof::Undecided
        }
    });
    let (below, above) = crossing(&boundaries, rate);
    assert!(
        below + above <= 0.05 && below + above > 0.01,
        "{below} {above}"
    );
}

#[test]
fn a_rate_off_the_limit_is_decided_the_right_way() {
    let boundaries = decided(EPISODES, |k, n| sequential_proof(k, n, 0.01, 0.95));
    let (below, above) = crossing(&boundaries, 0.002);
    assert!(below > 0.99 && above < 0.005, "{below} {above}");
    let (below, above) = crossing(&boundaries, 0.03);
    assert!(above > 0.99 && below < 0.005, "{below} {above}");
}

#[test]
fn nothing_is_proved_by_nothing() {
    assert_eq!(sequential_proof(0, 0, 0.5, 0.95), Proof::Undecided);
    assert_eq!(sequential_upper(0, 0, 0.95), 1.0);
    assert_eq!(sequential_lower(0, 0, 0.95), 0.0);
    for level in [0.0, 1.0, f64::NAN, 95.0] {
        assert_eq!(sequential_proof(0, 1000, 0.5, level), Proof::Undecided);
        assert_eq!(sequential_upper(0, 1000, level), 1.0);
        assert_eq!(sequential_lower(1000, 1000, level), 0.0);
    }
    assert_eq!(sequential_proof(5, 10, f64::NAN, 0.95), Proof::Undecided);
    assert_eq!(
        sequential_proof(9, 3, 0.5, 0.95),
        sequential_proof(3, 3, 0.5, 0.95)
    );
    for failures in [0, u64::MAX / 2, u64::MAX] {
        let interval = sequential_interval(failures, u64::MAX, 0.95);
        assert!(0.0 <= interval.lower && interval.lower <= interval.upper && interval.upper <= 1.0);
    }
}

proptest! {
    #![proptest_config(super::properties::proptest_config())]

    #[test]
    fn proofs_and_bounds_agree_and_the_fixed_size_interval_lies_inside(
        (n, failures) in (1_u64..5000).prop_flat_map(|n| (Just(n), 0..=n)),
        limit in 0.001..0.999_f64, level in 0.6..0.999_f64,
    ) {
        let proof = sequential_proof(failures, n, limit, level);
        let (lower, upper) = (
            sequential_lower(failures, n, level),
            sequential_upper(failures, n, level),
        );
        prop_assert_eq!(proof == Proof::Below, upper <= limit);
        prop_assert_eq!(proof == Proof::Above, lower > limit);
        let interval = sequential_interval(failures, n, level);
        prop_assert!(holds(&interval, failures as f64 / n as f64));
        let fixed = clopper_pearson(failures, n, level);
        prop_assert!(interval.lower <= fixed.lower && fixed.upper <= interval.upper);
        let mirrored = sequential_interval(n - failures, n, level);
        // Rounding of 1 - x and of binomial probabilities with exchanged arguments.
        prop_assert!((interval.lower + mirrored.upper - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_fewest_episodes_of_a_sequential_claim_are_the_first_whose_bound_is_low_enough() {
    // Without a failure: solved by hand in src/statistics/sequential.rs.
    for (rate, episodes) in [(0.01, 449), (0.05, 88)] {
        assert_eq!(sequential_runs_needed(rate, 0.95, 0), Some(episodes));
    }
    for failures in [0, 1, 4, 30] {
        let n = sequential_runs_needed(0.1, 0.95, failures).unwrap();
        assert!(sequential_upper(failures, n, 0.95) <= 0.1);
        assert!(sequential_upper(failures, n - 1, 0.95) > 0.1);
        // Looking again and again has its price.
        assert!(n > runs_needed(0.1, 0.95, failures).unwrap());
    }
    assert_eq!(sequential_runs_needed(0.0, 0.95, 0), None);
    assert_eq!(sequential_runs_needed(0.1, 1.0, 0), None);
}
