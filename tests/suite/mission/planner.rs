//! Global path planning.

use crate::mission::scenarios::*;
use crate::mission::world::{random_world, unit};
use urts_mc::mission::parameters::Planner;
use urts_mc::mission::plane::{Disc, Point, distance, length};
use urts_mc::mission::planner::{PlanNumbers, Searched, Space, Way, march, points_along, polyline};
use urts_mc::mission::world::World;

/// Clearance of the golden plans, m.
const CLEARANCE_M: f64 = 0.5;
const START: Point = [5.0, 5.0];
const GOAL: Point = [15.0, 5.0];

fn planner() -> Planner {
    Planner {
        radius_m: 0.25,
        margin_m: 0.25,
        ..paper_parameters().planner
    }
}

fn numbers_of(seed: u64, episode: u32) -> PlanNumbers {
    PlanNumbers {
        seed,
        episode,
        agent: 0,
        plan: 0,
    }
}

fn plan(world: &World, [start, goal]: [Point; 2], numbers: PlanNumbers) -> Searched {
    let space = Space::new(world, &[], start, CLEARANCE_M);
    polyline(&space, start, goal, &planner(), &numbers)
}

fn wall() -> World {
    world([20.0; 2], 0.1, &[corners(9.5, 0.0, 10.5, 14.0)])
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(q * (values.len() - 1) as f64).round() as usize]
}

#[test]
fn val_ways_around_a_wall_are_as_short_as_those_of_the_golden_file() {
    let golden = &GOLDEN["planner"]["wall"];
    let shortest_m = golden["shortest_m"].as_f64().unwrap();
    let world = wall();
    let mut ratios = Vec::new();
    let mut raw_ratios = Vec::new();
    let mut iterations = Vec::new();
    for episode in 0..500 {
        let searched = plan(&world, [START, GOAL], numbers_of(SEED, episode));
        ratios.push(length(&searched.way.unwrap()) / shortest_m);
        raw_ratios.push(searched.raw_m / shortest_m);
        iterations.push(f64::from(searched.iterations));
    }
    assert!(ratios.iter().all(|ratio| (1.0..=1.20).contains(ratio)));
    let median = quantile(&mut ratios, 0.5);
    assert!((1.02..=1.045).contains(&median), "{median}");
    // The same numbers in another implementation: every plan is the same up to rounding.
    for (key, ours) in [
        ("ratio_to_shortest", &mut ratios),
        ("raw_ratio", &mut raw_ratios),
        ("iterations", &mut iterations),
    ] {
        let mean = ours.iter().sum::<f64>() / ours.len() as f64;
        for (name, value) in [
            ("min", quantile(ours, 0.0)),
            ("max", quantile(ours, 1.0)),
            ("mean", mean),
        ] {
            let golden = golden[key][name].as_f64().unwrap();
            assert!(
                (value - golden).abs() < 1e-9 * golden,
                "{key} {name}: {value} {golden}"
            );
        }
    }
}

#[test]
fn val_the_way_of_episode_0_is_that_of_the_golden_file() {
    let golden = &GOLDEN["planner"]["wall"]["episode_0"];
    let searched = plan(&wall(), [START, GOAL], numbers_of(SEED, 0));
    assert_eq!(
        u64::from(searched.iterations),
        golden["iterations"].as_u64().unwrap()
    );
    let way = searched.way.unwrap();
    let vertices = points_of(&golden["path"]);
    assert_eq!(way.len(), vertices.len());
    for (&ours, golden) in way.iter().zip(vertices) {
        // The golden coordinates have nine digits behind the point, each rounded by half of the last.
        assert!(distance(ours, golden) < 1e-9, "{ours:?} {golden:?}");
    }
    assert!((length(&way) - golden["length"].as_f64().unwrap()).abs() < 1e-9);
    // Another episode takes another way.
    let other = plan(&wall(), [START, GOAL], numbers_of(SEED, 1))
        .way
        .unwrap();
    assert!(other.len() != way.len() || distance(other[1], way[1]) > 1e-3);
}

#[test]
fn val_doors_are_found_as_often_as_in_the_golden_file() {
    for (width, golden) in GOLDEN["planner"]["door"].as_object().unwrap() {
        let half = width.parse::<f64>().unwrap() / 2.0;
        let lower = corners(9.5, 0.0, 10.5, 10.0 - half);
        let upper = corners(9.5, 10.0 + half, 10.5, 20.0);
        let world = world([20.0; 2], 0.1, &[lower, upper]);
        let iterations: Vec<Option<u32>> = (0..200)
            .map(|episode| {
                let searched = plan(&world, [START, GOAL], numbers_of(7, episode));
                searched.way.map(|_| searched.iterations)
            })
            .collect();
        for (within, share) in golden.as_object().unwrap() {
            let within: u32 = within.parse().unwrap();
            let found = iterations
                .iter()
                .flatten()
                .filter(|&&own| own <= within)
                .count();
            // The same plans: a share of 200 is exact.
            assert!(
                (found as f64 / 200.0 - share.as_f64().unwrap()).abs() < 1e-9,
                "{width} {within}"
            );
        }
        match width.as_str() {
            "1.0" => assert!(iterations.iter().all(Option::is_none)),
            "2.0" => assert!(
                iterations
                    .iter()
                    .all(|own| own.is_some_and(|own| own <= 1000))
            ),
            _ => {}
        }
    }
}

#[test]
fn a_sealed_goal_has_no_way_and_costs_no_search() {
    let ring = [
        corners(13.0, 3.0, 17.0, 3.5),
        corners(13.0, 6.5, 17.0, 7.0),
        corners(13.0, 3.0, 13.5, 7.0),
        corners(16.5, 3.0, 17.0, 7.0),
    ];
    let sealed = world([20.0; 2], 0.1, &ring);
    let searched = plan(&sealed, [START, GOAL], numbers_of(1, 0));
    assert_eq!((searched.way, searched.iterations), (None, 0));
    // With a narrow gap the components are joined: all samples are tried.
    let mut gap = ring;
    gap[2] = corners(13.0, 3.0, 13.5, 6.2);
    let searched = plan(
        &world([20.0; 2], 0.1, &gap),
        [START, GOAL],
        numbers_of(1, 0),
    );
    assert_eq!((searched.way, searched.iterations), (None, 3000));
}

#[test]
fn val_a_free_way_is_one_segment() {
    let golden = &GOLDEN["planner"]["open_map"];
    let searched = plan(
        &world([20.0; 2], 0.1, &[]),
        [[2.0, 2.0], [18.0, 11.0]],
        numbers_of(1, 0),
    );
    assert_eq!(
        u64::from(searched.iterations),
        golden["iterations"].as_u64().unwrap()
    );
    let way = searched.way.unwrap();
    assert_eq!(way.len(), 2);
    assert!((length(&way) - golden["length"].as_f64().unwrap()).abs() < 1e-12);
}

#[test]
fn val_a_start_near_a_wall_is_left() {
    let golden = &GOLDEN["planner"]["start_near_wall"];
    let world = wall();
    let [start, goal] = ["start", "goal"].map(|key| numbers(&golden[key]).try_into().unwrap());
    // Nine digits.
    let clear_m = golden["clear_of_start"].as_f64().unwrap();
    assert!((world.clear_m(start, &[]) - clear_m).abs() < 1e-9 && clear_m < CLEARANCE_M);
    let way = plan(&world, [start, goal], numbers_of(1, 0)).way.unwrap();
    assert!((length(&way) - golden["length"].as_f64().unwrap()).abs() < 1e-12);
    // It is not enough farther away than 1 m.
    let space = Space::new(&world, &[], [5.0, 5.0], CLEARANCE_M);
    assert!(!space.is_free([5.0, 5.0], start));
}

#[test]
fn every_segment_of_a_way_keeps_its_clearance_on_random_maps() {
    let mut ways = 0;
    for seed in 0..60 {
        let world = random_world(seed, 20.0, 14);
        let at = |k: u32| {
            [
                20.0 * unit(seed, 1000 + 2 * k),
                20.0 * unit(seed, 1001 + 2 * k),
            ]
        };
        let discs = [Disc {
            centre_m: at(2),
            radius_m: 1.0,
        }];
        let (start, goal) = (at(0), at(1));
        let clear = |point: Point| world.clear_m(point, &discs);
        if clear(start) < CLEARANCE_M || clear(goal) < CLEARANCE_M {
            continue;
        }
        let space = Space::new(&world, &discs, start, CLEARANCE_M);
        let Some(way) = polyline(&space, start, goal, &planner(), &numbers_of(seed, 0)).way else {
            continue;
        };
        ways += usize::from(way.len() > 2);
        assert!(distance(way[0], start) < 1e-12 && distance(way[way.len() - 1], goal) < 1e-12);
        for leg in way.windows(2) {
            for k in 0..=200 {
                let share = f64::from(k) / 200.0;
                let point = [0, 1].map(|i| leg[0][i] + share * (leg[1][i] - leg[0][i]));
                // A march does not resolve less than its least step of 0.02 m: half of it is lost between two steps.
                assert!(clear(point) >= CLEARANCE_M - 0.01, "{}", clear(point));
            }
        }
    }
    assert!(ways > 10, "{ways} ways around something");
}

#[test]
fn a_march_finds_obstacles_that_are_thin() {
    // A fence of one cell, seen from far away, and a gap in it.
    let fence = world(
        [40.0, 10.0],
        0.1,
        &[
            corners(20.0, 0.0, 20.1, 4.0),
            corners(20.0, 6.0, 20.1, 10.0),
        ],
    );
    let free = |y: f64| march([0.5, y], [39.5, y], |point| fence.clear_m(point, &[]));
    assert!(!free(2.0) && free(5.0) && !free(8.0));
    assert!(!march([0.0; 2], [1.0, 0.0], |_| f64::NAN));
}

#[test]
fn points_of_a_way_are_evenly_spaced_and_include_the_vertices() {
    let way = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.5]];
    let points = points_along(&way, 1.0);
    let expected = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.5 / 3.0],
        [2.0, 5.0 / 3.0],
        [2.0, 2.5],
    ];
    assert_eq!(points.len(), expected.len());
    assert!(
        points
            .iter()
            .zip(expected)
            .all(|(&a, b)| distance(a, b) < 1e-15)
    );
}

#[test]
fn a_curve_passes_through_the_points_of_its_way() {
    let world = world([20.0; 2], 0.25, &[]);
    let space = Space::new(&world, &[], [2.0, 2.0], 0.35);
    let way = Way::along(
        &[[2.0, 2.0], [8.0, 2.0], [8.0, 9.0], [15.0, 12.0]],
        1.0,
        &space,
    );
    assert!(way.rests.is_empty());
    let samples = way.curve.samples_m();
    for (&point, &arc_m) in way.points_m.iter().zip(&way.arcs_m) {
        let nearest = samples.iter().map(|&own| distance(own, point));
        // Samples are at most 0.05 m apart.
        assert!(nearest.fold(f64::INFINITY, f64::min) < 0.03);
        // The arcs of points are shares of the length: where the curve bends they are off by less than it is longer.
        let longer_m = way.curve.length_m() - length(&way.points_m);
        let (place, direction) = way.curve.at(arc_m);
        assert!(distance(place, point) < 0.03 + longer_m);
        assert!((direction[0].hypot(direction[1]) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_way_that_turns_on_the_spot_is_walked_with_rests_at_its_vertices() {
    let world = world([20.0; 2], 0.25, &[]);
    let space = Space::new(&world, &[], [2.0, 2.0], 0.35);
    let vertices = [[2.0, 2.0], [8.0, 2.0], [2.5, 2.3], [2.5, 9.0]];
    let way = Way::along(&vertices, 1.0, &space);
    let rests: Vec<Point> = way.rests.iter().map(|&index| way.points_m[index]).collect();
    assert_eq!(rests, vertices[1..3]);
    // The curve is the polyline itself.
    assert!((way.curve.length_m() - length(&vertices)).abs() < 1e-12);
    let end = way.curve.at(f64::INFINITY).0;
    assert!(distance(end, vertices[3]) < 1e-15);
}

#[test]
fn a_curve_that_would_leave_its_clearance_gets_closer_points() {
    // Two right angles around the end of a wall. With points 5 m apart the spline swings towards it beside them.
    let world = world([30.0; 2], 0.25, &[corners(14.0, 0.0, 16.0, 20.0)]);
    let vertices = [[12.8, 1.0], [12.8, 21.2], [17.2, 21.2], [17.2, 1.0]];
    let along = |clearance_m: f64| {
        let space = Space::new(&world, &[], vertices[0], clearance_m);
        let way = Way::along(&vertices, 5.0, &space);
        let clear = |sample: &Point| space.excess_m(*sample) >= 0.0;
        assert!(way.curve.samples_m().iter().all(clear));
        way
    };
    let points = |parts: usize| points_along(&vertices, 5.0 / parts as f64).len();
    // The polyline keeps 1.148 m. The closer the spline must come to that, the closer are its points.
    for (clearance_m, parts) in [(0.35, 1), (1.03, 1), (1.08, 2), (1.12, 4), (1.14, 8)] {
        let way = along(clearance_m);
        assert_eq!(
            (way.points_m.len(), way.rests.len()),
            (points(parts), 0),
            "{clearance_m} m"
        );
    }
    // No spline does: the robot walks along the polyline and rests at its corners.
    let exact = along(1.148);
    assert_eq!((exact.points_m.len(), exact.rests.len()), (points(1), 2));
}
