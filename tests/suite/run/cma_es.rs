//! The search under `tune`, against an independent program on functions that everybody tries.

use crate::common::golden;
use urts_mc::random::philox::{Address, Stream};
use urts_mc::run::tune::{CmaEs, usual_population};

/// Runs of a function.
const SEEDS: u64 = 21;
/// More than any run should take.
const MOST: usize = 60_000;

/// A function to be made small, where its search begins, and when it is done.
struct Case {
    value: fn(&[f64]) -> f64,
    start: f64,
    sigma: f64,
    /// Relative standard deviation of what the search is told.
    noise: f64,
    /// What has to be reached: by a candidate, or with noise by the mean.
    goal: f64,
}

fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|own| own * own).sum()
}

fn ellipsoid(x: &[f64]) -> f64 {
    let last = (x.len() - 1) as f64;
    let terms = x.iter().enumerate();
    terms
        .map(|(i, own)| 1e6_f64.powf(i as f64 / last) * own * own)
        .sum()
}

fn rosenbrock(x: &[f64]) -> f64 {
    let pairs = x.windows(2);
    pairs
        .map(|pair| 100.0 * (pair[0].powi(2) - pair[1]).powi(2) + (pair[0] - 1.0).powi(2))
        .sum()
}

fn case(name: &str) -> Case {
    let plain = |value, start, sigma| Case {
        value,
        start,
        sigma,
        noise: 0.0,
        goal: 1e-9,
    };
    match name {
        "sphere" => plain(sphere, 1.0, 1.0),
        "ellipsoid" => plain(ellipsoid, 1.0, 1.0),
        "rosenbrock" => plain(rosenbrock, 0.0, 0.1),
        "noisy sphere" => Case {
            noise: 0.3,
            goal: 1e-6,
            ..plain(sphere, 1.0, 1.0)
        },
        other => panic!("{other}"),
    }
}

/// A standard normal number of the test's own: the sum of twelve uniform ones less six.
fn normal(seed: u64, number: u32) -> f64 {
    let uniform = |index| {
        let address = Address {
            episode: number,
            stream: Stream::Permutation,
            entry: 0,
            member: 0,
            index,
        };
        address.unit(seed)
    };
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// Evaluations that a search takes; none if it does not arrive.
fn evaluations(case: &Case, dimension: usize, seed: u64) -> Option<usize> {
    let population = usual_population(dimension);
    let mut search = CmaEs::new(
        &vec![case.start; dimension],
        case.sigma,
        population,
        seed,
        0,
    );
    let mut count = 0;
    while count < MOST {
        let candidates = search.candidates();
        let values: Vec<f64> = candidates.iter().map(|own| (case.value)(own)).collect();
        if case.noise == 0.0
            && let Some(place) = values.iter().position(|value| *value < case.goal)
        {
            return Some(count + place + 1);
        }
        let told = values
            .iter()
            .zip(0u32..)
            .map(|(value, place)| value * (1.0 + case.noise * normal(seed, count as u32 + place)));
        let told: Vec<f64> = told.collect();
        search = search.after(&told);
        count += values.len();
        if case.noise > 0.0 && (case.value)(search.mean()) < case.goal {
            return Some(count);
        }
    }
    None
}

#[test]
fn val_the_search_takes_as_many_evaluations_as_an_independent_program() {
    let golden = golden("cma_es.json");
    for of in golden["cases"].as_array().unwrap() {
        let name = of["function"].as_str().unwrap();
        let dimension = of["dimension"].as_u64().unwrap() as usize;
        let expected = of["median"].as_f64().unwrap();
        let case = case(name);
        let runs = (0..SEEDS).map(|seed| evaluations(&case, dimension, seed));
        let mut runs: Vec<usize> = runs.map(Option::unwrap).collect();
        runs.sort_unstable();
        let median = runs[runs.len() / 2] as f64;
        println!("{name} {dimension}: {median} against {expected}");
        assert!(
            (median / expected - 1.0).abs() < 0.15,
            "{name} in {dimension} dimensions: {median} against {expected}"
        );
    }
}

#[test]
fn the_search_goes_by_the_order_of_the_values_alone() {
    let after = |told: &dyn Fn(f64) -> f64| {
        let mut search = CmaEs::new(&[1.0, 2.0, 3.0], 0.5, 7, 5, 0);
        for _ in 0..20 {
            let candidates = search.candidates();
            let values: Vec<f64> = candidates.iter().map(|own| told(sphere(own))).collect();
            search = search.after(&values);
        }
        search.mean().to_vec()
    };
    let plain = after(&|value| value);
    assert_eq!(after(&|value| value.ln() - 3.0), plain);
    // Those that are infinitely bad are the worst, whatever else they are.
    let median = after(&|value| if value > 3.0 { f64::INFINITY } else { value });
    assert!(sphere(&median) < sphere(&[1.0, 2.0, 3.0]));
    assert_ne!(after(&|value| -value), plain);
}

#[test]
fn searches_of_other_seeds_and_numbers_have_other_candidates() {
    let first = |seed, number| CmaEs::new(&[0.0; 4], 1.0, 8, seed, number).candidates();
    assert_eq!(first(1, 0), first(1, 0));
    assert_ne!(first(1, 0), first(2, 0));
    assert_ne!(first(1, 0), first(1, 1));
    // A standard normal number in each direction, as far as 8 candidates of 4 coordinates show it.
    let mean_square = first(1, 0).iter().map(|own| sphere(own)).sum::<f64>() / 32.0;
    assert!((0.4..2.0).contains(&mean_square), "{mean_square}");
}
