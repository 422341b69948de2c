//! Detection: closed forms, and that epochs do not matter.

use crate::mission::scenarios::*;
use crate::mission::world::unit;
use urts_mc::mission::collisions::Sweep;
use urts_mc::mission::parameters::Targets;
use urts_mc::mission::plane::{Point, Rectangle};
use urts_mc::mission::uav_leg::UavLeg;
use urts_mc::mission::vision::{
    Sensor, chord, lanes_probability, lateral_probability, sweep_width_m,
};
use urts_mc::mission::{Mission, MissionDraws, Observed, Parameters, Scenario, lanes};

const TARGETS: u32 = 20_000;
const SENSOR: Sensor = Sensor {
    range_m: 3.5,
    rate_per_s: 0.5,
};

#[test]
fn val_closed_forms_are_those_of_the_golden_file() {
    let golden = &GOLDEN["detection"];
    // The golden quadrature over lanes of 7 m is off by 1.7e-7, as one to 1e-13 with the kinks at its ends shows.
    let near = |ours: f64, golden: f64| (ours - golden).abs() < 2e-7;
    for (case, width_m) in golden["sweep_width"].as_object().unwrap() {
        let values: Vec<f64> = case
            .split([',', '='])
            .filter_map(|word| word.parse().ok())
            .collect();
        let sensor = Sensor {
            range_m: values[0],
            rate_per_s: values[1],
        };
        let ours = sweep_width_m(&sensor, values[2]);
        assert!(near(ours, width_m.as_f64().unwrap()), "{case}: {ours}");
    }
    for (distance, probability) in golden["lateral"].as_object().unwrap() {
        let ours = lateral_probability(&SENSOR, 2.0, distance.parse().unwrap());
        assert!(near(ours, probability.as_f64().unwrap()));
    }
    for row in golden["parallel"].as_array().unwrap() {
        let number = |key: &str| row[key].as_f64().unwrap();
        let ours = lanes_probability(&SENSOR, number("cruise"), number("spacing"));
        assert!(near(ours, number("analytic")), "{ours} {row}");
    }
}

/// Whether sweeps with one sensor find a target at which exposure of `threshold` is needed.
fn finds(track: &[Point], target: Point, threshold: f64) -> bool {
    let exposure = |leg: &[Point]| {
        let [u, v] = chord(leg[0], leg[1], target, SENSOR.range_m).unwrap_or([0.0; 2]);
        SENSOR.rate_per_s * (v - u)
    };
    track.windows(2).map(exposure).sum::<f64>() >= threshold
}

fn standard_error(share: f64, of: u32) -> f64 {
    (share * (1.0 - share) / f64::from(of)).sqrt()
}

#[test]
fn a_sweep_in_parallel_lanes_finds_as_many_as_the_closed_form_says() {
    for lane_m in [5.0, 7.0, 10.0] {
        let area = rectangle([0.0, 0.0, 60.0, 60.0]);
        let limits = paper_parameters().flight.limits;
        let goals = lanes(&area, lane_m);
        let mut track = vec![goals[0]];
        let mut cruise_m_s = 0.0;
        for pair in goals.windows(2) {
            let leg = UavLeg::between(pair[0], pair[1], &limits, 1.0).unwrap();
            let knots = leg.knots(pair[0]);
            track.extend(knots.iter().map(|knot| knot.place_m));
            cruise_m_s = f64::max(cruise_m_s, if leg.cruise > 5 { leg.speed_m_s } else { 0.0 });
        }
        let spacing_m = 60.0 / (goals.len() / 2) as f64;
        let found = (0..TARGETS).filter(|&k| {
            // Away from the borders, where lanes on one side are missing and the ramps are.
            let x = 1.5 * spacing_m + unit(3, 3 * k) * (60.0 - 3.0 * spacing_m);
            let y = 15.0 + 30.0 * unit(3, 3 * k + 1);
            finds(&track, [x, y], -unit(3, 3 * k + 2).ln())
        });
        let share = found.count() as f64 / f64::from(TARGETS);
        let exact = lanes_probability(&SENSOR, cruise_m_s, spacing_m);
        let error = standard_error(share, TARGETS);
        assert!(
            (share - exact).abs() < 3.0 * error,
            "{lane_m}: {share} {exact} {error}"
        );
        // A speed that is off by a tenth would be noticed.
        let wrong = lanes_probability(&SENSOR, 0.9 * cruise_m_s, spacing_m);
        assert!((share - wrong).abs() > 3.0 * error);
    }
}

#[test]
fn a_random_search_finds_as_many_as_koopman_says() {
    // Straight tracks through a disc about the target, their number Poisson with mean c 2 B / W: the expected swept
    // area is c times that of the disc.
    let (disc_m, width_m) = (20.0, sweep_width_m(&SENSOR, 2.0));
    let trials = 4000;
    for (case, c) in [0.25, 0.5, 1.0, 2.0].into_iter().enumerate() {
        let mut index = 0;
        let mut next = || {
            index += 1;
            unit(100 + case as u64, index)
        };
        let mean = c * 2.0 * disc_m / width_m;
        let mut found = 0;
        for _ in 0..trials {
            let mut tracks = 0;
            let mut product = next();
            while product > (-mean).exp() {
                tracks += 1;
                product *= next();
            }
            let mut exposure = 0.0;
            for _ in 0..tracks {
                let offset = disc_m * (2.0 * next() - 1.0);
                let (sine, cosine) = (std::f64::consts::TAU * next()).sin_cos();
                let at = |along: f64| {
                    [
                        along * cosine - offset * sine,
                        along * sine + offset * cosine,
                    ]
                };
                let within = chord(at(-disc_m), at(disc_m), [0.0; 2], SENSOR.range_m);
                let [u, v] = within.unwrap_or([0.0; 2]);
                exposure += SENSOR.rate_per_s * (v - u) * 2.0 * disc_m / 2.0;
            }
            found += u32::from(exposure >= -next().ln());
        }
        let share = f64::from(found) / f64::from(trials);
        let exact = 1.0 - (-c).exp();
        assert!(
            (share - exact).abs() < 3.0 * standard_error(share, trials),
            "{c}: {share} {exact}"
        );
    }
}

/// When a UAV that is seen to fly past a target at 2 m/s finds it, with decisions every `epoch_s`.
fn found_on_a_pass(epoch_s: f64, threshold: f64) -> Option<f64> {
    let area: Rectangle = rectangle([0.0, 0.0, 40.0, 40.0]);
    let mut parameters = Parameters {
        epoch_s,
        targets: Targets::Fixed(vec![[20.3, 21.0]]),
        ..without_obstacles(parameters(&[area], 0))
    };
    parameters.rescue.robots = 0;
    let scenario = Scenario::new(world([40.0; 2], 0.25, &[]), parameters).unwrap();
    let mut draws = MissionDraws::of_episode(&scenario, 1, 0).unwrap();
    draws.thresholds = vec![vec![threshold]];
    let mut mission = Mission::start(&scenario, &draws);
    let mut k = 0;
    loop {
        let places_m = [[2.0 * f64::from(k) * epoch_s, 20.0]];
        let observed = Observed {
            places_m: &places_m,
            lost_s: &[None],
        };
        if places_m[0][0] >= 40.0 || mission.is_over() {
            return mission.finish(&observed).found_s[0];
        }
        mission.decide(&observed);
        k += 1;
    }
}

#[test]
fn when_a_target_is_found_does_not_depend_on_the_epoch() {
    for threshold in [0.1, 0.5, 1.0, 1.6] {
        let times = [0.5, 1.0, 2.0].map(|epoch_s| found_on_a_pass(epoch_s, threshold).unwrap());
        let half_m = (SENSOR.range_m * SENSOR.range_m - 1.0).sqrt();
        let exact_s = (20.3 - half_m) / 2.0 + threshold / SENSOR.rate_per_s;
        for time_s in times {
            // Sums of twenty exposures of order one.
            assert!((time_s - exact_s).abs() < 1e-12, "{time_s} {exact_s}");
        }
    }
    // The whole pass gives an exposure of 1.68.
    assert_eq!(found_on_a_pass(1.0, 1.69), None);
}

#[test]
fn chords_of_motions_that_miss_touch_or_stand_are_what_they_are() {
    let within = |from: Point, to: Point| chord(from, to, [0.0; 2], 1.0);
    assert_eq!(within([-2.0, 0.0], [2.0, 0.0]), Some([0.25, 0.75]));
    assert_eq!(within([-0.5, 0.0], [0.5, 0.0]), Some([0.0, 1.0]));
    assert_eq!(within([-2.0, 1.5], [2.0, 1.5]), None);
    assert_eq!(within([2.0, 0.0], [3.0, 0.0]), None);
    assert_eq!(within([0.5, 0.5], [0.5, 0.5]), Some([0.0, 1.0]));
    assert_eq!(within([1.5, 0.5], [1.5, 0.5]), None);
    assert_eq!(within([f64::NAN, 0.0], [1.0, 0.0]), None);
}

#[test]
fn the_closest_approach_of_two_motions_is_at_the_same_time() {
    let sweep = |from_m: Point, to_m: Point| Sweep { from_m, to_m };
    let crossing = sweep([0.0, 0.0], [2.0, 0.0]).closest_m(&sweep([1.0, -1.0], [1.0, 1.0]));
    assert!(
        crossing < 1e-15,
        "both are in the middle at half of the time"
    );
    let later = sweep([0.0, 0.0], [2.0, 0.0]).closest_m(&sweep([1.0, -2.0], [1.0, 0.0]));
    // Paths that touch, at different times.
    assert!(
        (later - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12,
        "{later}"
    );
    let still = sweep([-1.0, 0.5], [1.0, 0.5]).closest_m(&Sweep::still([0.0, 0.0]));
    assert!((still - 0.5).abs() < 1e-15);
}
