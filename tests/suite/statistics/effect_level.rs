//! The methods on ranks, on 2,000 synthetic campaigns each: intervals must cover the truth and tests
//! must not reject it, as often as they say; and wrong methods must be found out.

use urts_mc::statistics::{
    Effect, Outcome, Permutations, Ranked, effects, holm, somers_d, spearman,
};

use super::holds;
use super::level::{NOISE, share};
use super::random::SplitMix64;

type Pair = fn(&mut SplitMix64) -> (f64, f64);

fn columns(random: &mut SplitMix64, n: usize, pair: Pair) -> (Ranked, Ranked) {
    let (x, y): (Vec<f64>, Vec<f64>) = (0..n).map(|_| pair(random)).unzip();
    (Ranked::of_all(&x).unwrap(), Ranked::of_all(&y).unwrap())
}

const NORMAL: Pair = |random| {
    let x = random.normal();
    (x, 0.7 * x + 0.51_f64.sqrt() * random.normal())
};
const STRONG: Pair = |random| {
    let x = random.normal();
    (x, 0.95 * x + 0.0975_f64.sqrt() * random.normal())
};
/// The scatter grows with |x|.
const FANNING: Pair = |random| {
    let x = random.normal();
    (x, x * random.normal())
};
const VALLEY: Pair = |random| {
    let x = random.normal();
    (x, x.abs() + 0.1 * random.normal())
};
const TIED: Pair = |random| {
    let x = random.normal();
    ((2.0 * x).round(), (x + random.normal()).round())
};
/// Two levels, and a tenth of the outcomes infinite.
const DIVERGING: Pair = |random| {
    let x = random.uniform();
    let y = x + 0.5 * random.normal();
    let level = if x < 0.5 { 0.0 } else { 1.0 };
    (level, if y > 1.2 { f64::INFINITY } else { y })
};

#[test]
fn the_interval_of_spearman_covers_whatever_the_joint_distribution() {
    let of_normal = |r: f64| 6.0 / std::f64::consts::PI * (r / 2.0).asin();
    // 400,000 pairs have a standard error below 0.0015, a fiftieth of the half-width at n = 200.
    let of_many = |pair| {
        let (x, y) = columns(&mut SplitMix64(99), 400_000, pair);
        spearman(&x, &y, 0.95).unwrap().value
    };
    let populations = [
        (NORMAL, of_normal(0.7)),
        (STRONG, of_normal(0.95)),
        (FANNING, 0.0),
        (VALLEY, 0.0),
        (TIED, of_many(TIED)),
        (DIVERGING, of_many(DIVERGING)),
    ];
    for (seed, (pair, rho)) in (1..).zip(populations) {
        for n in [20, 50, 200] {
            let covered = share(seed, |random| {
                let (x, y) = columns(random, n, pair);
                holds(&spearman(&x, &y, 0.95).unwrap().interval, rho)
            });
            println!("population {seed}, n = {n}: {covered}");
            assert!(covered > 0.95 - NOISE, "{covered} at {n}");
            // With few rows and a strong correlation the interval is too wide by up to 3 points.
            assert!(covered < 0.95 + NOISE || n < 200, "{covered} at {n}");
        }
    }

    // Negative control: the standard error of Bonett and Wright, for a normal population.
    let normal_theory = share(9, |random| {
        let n = 500;
        let (x, y) = columns(random, n, VALLEY);
        let rho = spearman(&x, &y, 0.95).unwrap().value;
        let error = ((1.0 + rho * rho / 2.0) / (n as f64 - 3.0)).sqrt();
        rho.atanh().abs() <= 1.96 * error
    });
    assert!(normal_theory < 0.9, "{normal_theory}");
}

/// A parameter in the given numbers of failed and survived episodes, and which of them failed.
fn groups(
    random: &mut SplitMix64,
    [failures, survivals]: [usize; 2],
    [failed, survived]: [fn(&mut SplitMix64) -> f64; 2],
) -> (Ranked, Ranked) {
    let flags: Vec<bool> = (0..failures + survivals)
        .map(|row| row < failures)
        .collect();
    let draw = |&is_failed: &bool| {
        if is_failed {
            failed(random)
        } else {
            survived(random)
        }
    };
    let values: Vec<f64> = flags.iter().map(draw).collect();
    (Ranked::of_all(&values).unwrap(), Ranked::of_flags(&flags))
}

#[test]
fn the_interval_of_somers_d_covers_with_few_failures_and_unequal_scatter() {
    type Draw = fn(&mut SplitMix64) -> f64;
    let normal: Draw = SplitMix64::normal;
    let shifted: Draw = |random| random.normal() + 1.0;
    let apart: Draw = |random| random.normal() + 3.0;
    let wider: Draw = |random| 3.0 * random.normal();
    let exponential: Draw = |random| -random.uniform().ln();
    let longer: Draw = |random| -5.0 * random.uniform().ln();
    let rarely: Draw = |random| f64::from(u8::from(random.uniform() < 0.5));
    let often: Draw = |random| f64::from(u8::from(random.uniform() < 0.8));
    // P(N < d) with variances 1 + 1 is the normal distribution function at d / sqrt(2).
    let populations = [
        ([shifted, normal], 0.520_499_877_813_046_5),
        ([apart, normal], 0.966_105_146_475_310_8),
        ([wider, normal], 0.0),
        ([longer, exponential], 2.0 / 3.0),
        ([often, rarely], 0.3),
    ];
    let sizes = [
        [2, 300],
        [5, 300],
        [20, 300],
        [50, 150],
        [150, 50],
        [300, 5],
    ];
    for (seed, (draws, truth)) in (1..).zip(populations) {
        for size in sizes {
            let covered = share(seed, |random| {
                let (x, failed) = groups(random, size, draws);
                // A sample of two levels may miss one of them; that is no interval, and no error.
                somers_d(&x, &failed, 0.95).is_none_or(|estimate| holds(&estimate.interval, truth))
            });
            println!("population {seed}, {size:?}: {covered}");
            assert!(covered > 0.95 - NOISE, "{covered} at {size:?}");
        }
    }

    // Negative control: the variance of a parameter without effect, (m + k + 1) / (3 m k).
    let null_variance = share(9, |random| {
        let (x, failed) = groups(random, [20, 300], [wider, normal]);
        let error = (321.0_f64 / (3.0 * 20.0 * 300.0)).sqrt();
        somers_d(&x, &failed, 0.95).unwrap().value.abs() <= 1.96 * error
    });
    assert!(null_variance < 0.9, "{null_variance}");
}

/// Effects of `parameters` numbers without effect, the last one in four levels, on an outcome
/// given by a latent number; all of them share a part, so that the tests depend on each other.
fn idle_family(random: &mut SplitMix64, parameters: usize, n: usize, failing: bool) -> Vec<Effect> {
    let shared: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let columns: Vec<Ranked> = (1..=parameters)
        .map(|i| {
            let values = shared.iter().map(|shared| shared + random.normal());
            let level = |value: f64| {
                if i == parameters {
                    value.round()
                } else {
                    value
                }
            };
            Ranked::of_all(&values.map(level).collect::<Vec<f64>>()).unwrap()
        })
        .collect();
    let latent: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let outcome = if failing {
        Outcome::Failure(Ranked::of_flags(
            &latent.iter().map(|&value| value > 1.0).collect::<Vec<_>>(),
        ))
    } else {
        Outcome::Metric(Ranked::of_all(&latent).unwrap())
    };
    let permutations = Permutations {
        seed: random.index(1 << 40) as u64,
        most: 399,
        shuffled: usize::MAX,
    };
    let effects = effects(&columns, &outcome, 0.95, permutations);
    effects.into_iter().flatten().collect()
}

#[test]
fn permutation_tests_keep_their_level_on_metrics_and_on_failures() {
    for (seed, failing) in (1..).zip([false, true]) {
        let mut rejected = [0, 0, 0, 0];
        let mut tests = 0;
        share(seed, |random| {
            for effect in idle_family(random, 2, 60, failing) {
                let smaller = effect.trend_p.min(effect.shape_p);
                let p_values = [effect.trend_p, effect.shape_p, effect.p_value(), smaller];
                for (count, p) in rejected.iter_mut().zip(p_values) {
                    *count += u32::from(p <= 0.05);
                }
                tests += 1;
            }
            true
        });
        let [trend, shape, either, smaller] = rejected.map(|n| f64::from(n) / f64::from(tests));
        println!("failing {failing}: {trend} {shape} {either} {smaller}");
        for level in [trend, shape, either] {
            assert!(level <= 0.05 + NOISE, "{level}");
        }
        // They use their level: tests that never reject would keep it, too.
        assert!(trend > 0.05 - NOISE && shape > 0.05 - NOISE);
        // Negative control: the smaller of two p-values is none.
        assert!(smaller > 0.05 + NOISE, "{smaller}");
    }
}

#[test]
fn holms_correction_keeps_the_level_of_a_family_of_dependent_tests() {
    let any_below = |p_values: &[f64]| p_values.iter().any(|&p| p <= 0.05);
    let (mut corrected, mut uncorrected) = (0, 0);
    let experiments = 2000;
    let mut random = SplitMix64(3);
    for _ in 0..experiments {
        let family = idle_family(&mut random, 6, 60, false);
        let p_values: Vec<f64> = family.iter().map(Effect::p_value).collect();
        corrected += u32::from(any_below(&holm(&p_values)));
        uncorrected += u32::from(any_below(&p_values));
    }
    let share = |count: u32| f64::from(count) / f64::from(experiments);
    println!(
        "family-wise {} against {}",
        share(corrected),
        share(uncorrected)
    );
    assert!(share(corrected) <= 0.05 + NOISE);
    assert!(share(corrected) > 0.01);
    assert!(share(uncorrected) > 0.1);
}

#[test]
fn a_threshold_on_a_few_parameters_is_found_among_many_idle_ones() {
    let (n, parameters) = (1000, 60);
    let mut random = SplitMix64(4);
    let columns: Vec<Vec<f64>> = (0..parameters)
        .map(|_| (0..n).map(|_| random.uniform()).collect())
        .collect();
    let failed: Vec<bool> = (0..n)
        .map(|row| columns[7][row] > 0.8 || (columns[30][row] - 0.5).abs() > 0.45)
        .collect();
    let ranked: Vec<Ranked> = columns
        .iter()
        .map(|column| Ranked::of_all(column).unwrap())
        .collect();
    let outcome = Outcome::Failure(Ranked::of_flags(&failed));
    let permutations = Permutations {
        seed: 1,
        most: 3999,
        shuffled: usize::MAX,
    };
    let effects = effects(&ranked, &outcome, 0.95, permutations);
    let p_values: Vec<f64> = effects.iter().flatten().map(Effect::p_value).collect();
    let adjusted = holm(&p_values);
    let found: Vec<usize> = (0..parameters).filter(|&i| adjusted[i] <= 0.05).collect();
    assert_eq!(found, [7, 30]);
    assert!(effects[7].unwrap().trend.interval.lower > 0.2);
    // Both ends of its range fail: no trend, and yet an effect.
    assert!(holds(&effects[30].unwrap().trend.interval, 0.0));
}
