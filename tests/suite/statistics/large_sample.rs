//! p-values of many rows: what the test that permutes all of them says, at a cost that does not grow with them.

use super::random::SplitMix64;
use urts_mc::statistics::{Effect, Outcome, Permutations, Ranked, effects};

/// A parameter and an outcome.
type Draw = fn(&mut SplitMix64) -> (f64, f64);

/// What a run may meet: effects of a size that a permutation test tells with some doubt.
const CASES: [(&str, usize, Draw); 9] = [
    ("no effect", 2000, |r| (r.uniform(), r.normal())),
    ("a weak trend", 2000, |r| {
        let x = r.normal();
        (x, 0.045 * x + r.normal())
    }),
    ("an effect of the size", 2000, |r| {
        let x = r.normal();
        (x, (1.0 + 0.08 * x.abs()) * r.normal().abs())
    }),
    ("a parameter of five values", 2000, |r| {
        let x = (5.0 * r.uniform()).floor();
        (x, 0.03 * x + r.normal())
    }),
    ("outcomes of which a third diverges", 2000, |r| {
        let x = r.normal();
        let y = 0.05 * x + r.normal();
        (x, if y > 0.43 { f64::INFINITY } else { y })
    }),
    ("a tenth fails", 2000, |r| {
        let x = r.normal();
        (x, f64::from(0.1 * x + r.normal() > 1.28))
    }),
    // Few rows decide from here on.
    ("one in two hundred fails", 3000, |r| {
        let x = r.normal();
        (x, f64::from(0.2 * x + r.normal() > 2.6))
    }),
    ("a fault in one of a hundred", 3000, |r| {
        let x = f64::from(r.uniform() < 0.01);
        (x, 0.3 * x + r.normal())
    }),
    ("a rare fault and rare failures", 3000, |r| {
        let x = f64::from(r.uniform() < 0.02);
        (x, f64::from(r.uniform() < 0.01 + 0.03 * x))
    }),
];

fn drawn(random: &mut SplitMix64, rows: usize, draw: Draw) -> (Ranked, Outcome) {
    let (x, y): (Vec<f64>, Vec<f64>) = (0..rows).map(|_| draw(random)).unzip();
    let is_flag = y.iter().all(|own| [0.0, 1.0].contains(own));
    let outcome = match is_flag {
        true => Outcome::Failure(Ranked::of_flags(
            &y.iter().map(|own| *own > 0.5).collect::<Vec<_>>(),
        )),
        false => Outcome::Metric(Ranked::of_all(&y).unwrap()),
    };
    (Ranked::of_all(&x).unwrap(), outcome)
}

fn tested(x: &Ranked, y: &Outcome, most: u32, shuffled: usize) -> Option<Effect> {
    with_seed(11, x, y, most, shuffled)
}

fn with_seed(seed: u64, x: &Ranked, y: &Outcome, most: u32, shuffled: usize) -> Option<Effect> {
    let permutations = Permutations {
        seed,
        most,
        shuffled,
    };
    effects(std::slice::from_ref(x), y, 0.95, permutations)[0]
}

#[test]
fn p_values_of_many_rows_are_those_of_all_permutations() {
    let mut random = SplitMix64(8);
    let (mut compared, mut small) = (0, 0);
    for (name, rows, draw) in CASES {
        for _ in 0..4 {
            let (x, y) = drawn(&mut random, rows, draw);
            let full = tested(&x, &y, 20_000, usize::MAX).unwrap();
            let limit = tested(&x, &y, 20_000, 0).unwrap();
            assert_eq!(
                (full.trend, full.shape.to_bits()),
                (limit.trend, limit.shape.to_bits())
            );
            for (full, limit) in [(full.trend_p, limit.trend_p), (full.shape_p, limit.shape_p)] {
                // Sampling ends at the 50th permutation that is as extreme: each p is known to 14 %, and one
                // twentieth of it is allowed to the limit; below that to the last permutations.
                let scatter =
                    full.max(limit) / 50.0_f64.sqrt() + (full / 20_000.0).sqrt() + 1.0 / 20_000.0;
                let allowed = 4.0 * scatter + 0.05 * full;
                assert!(
                    (full - limit).abs() <= allowed,
                    "{name}: {full} and {limit}"
                );
                compared += 1;
                small += usize::from(full < 0.05);
            }
        }
    }
    // Both sides of what is called significant were met.
    assert!(small > 10 && compared - small > 10, "{small} of {compared}");
}

#[test]
fn p_values_of_many_rows_have_their_level_where_there_is_no_effect() {
    let without: [(usize, Draw); 5] = [
        (500, |r| (r.uniform(), r.normal())),
        (500, |r| {
            ((3.0 * r.uniform()).floor(), f64::from(r.uniform() < 0.2))
        }),
        (500, |r| (r.normal(), f64::from(r.uniform() < 0.02))),
        (500, |r| (f64::from(r.uniform() < 0.02), r.normal())),
        (500, |r| {
            (f64::from(r.uniform() < 0.03), f64::from(r.uniform() < 0.05))
        }),
    ];
    let mut random = SplitMix64(21);
    for (case, (rows, draw)) in without.into_iter().enumerate() {
        let count = 1500_u32;
        let mut below = [[0_u32; 2]; 2];
        for seed in 0..u64::from(count) {
            let (x, y) = drawn(&mut random, rows, draw);
            // Permutations of their own: those of one seed would move the level of all together.
            let Some(effect) = with_seed(seed, &x, &y, 400, 0) else {
                continue;
            };
            for (of_test, p) in below.iter_mut().zip([effect.trend_p, effect.shape_p]) {
                for (below, level) in of_test.iter_mut().zip([0.05, 0.01]) {
                    *below += u32::from(p <= level);
                }
            }
        }
        for of_test in below {
            for (below, level) in of_test.into_iter().zip([0.05, 0.01]) {
                let share = f64::from(below) / f64::from(count);
                // Four standard errors of the count.
                let allowed = level + 4.0 * (level / f64::from(count)).sqrt();
                assert!(share <= allowed, "case {case}: {share} at {level}");
            }
        }
        // Counts have few values, and tests of them are cautious; continuous ones are not.
        if case == 0 {
            let share = f64::from(below[0][0]) / f64::from(count);
            assert!(share > 0.03, "{share}");
        }
    }
}

#[test]
fn the_tests_of_many_rows_would_notice_an_effect() {
    let mut random = SplitMix64(3);
    let (x, y) = drawn(&mut random, 20_000, |r| {
        let x = r.normal();
        (x, 0.05 * x + r.normal())
    });
    let effect = tested(&x, &y, 4000, 1 << 14).unwrap();
    assert!(effect.trend_p < 1e-6 && effect.shape_p < 1e-3, "{effect:?}");
    let (x, y) = drawn(&mut random, 20_000, |r| {
        let x = f64::from(r.uniform() < 0.002);
        (x, f64::from(r.uniform() < 0.001 + 0.3 * x))
    });
    let effect = tested(&x, &y, 4000, 1 << 14).unwrap();
    assert!(effect.trend_p < 1e-3 && effect.shape_p < 1e-3, "{effect:?}");
}
