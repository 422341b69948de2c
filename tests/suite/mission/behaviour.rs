//! Which gait on which part of a way.

use crate::mission::scenarios::*;
use urts_mc::mission::behaviour::{merge, of_legs};
use urts_mc::mission::plane::Point;
use urts_mc::mission::world::{Raster, World};

fn advance_m(behaviour: usize) -> f64 {
    points().advance_m(behaviour)
}

fn index(name: &str) -> usize {
    ["walk", "run", "climb"]
        .iter()
        .position(|own| own.starts_with(name))
        .unwrap()
}

#[test]
fn val_merging_gives_the_golden_behaviours() {
    let cases = GOLDEN["behaviour"]["merge"].as_array().unwrap();
    for case in cases {
        let letters = case["beta"]
            .as_str()
            .unwrap()
            .split("")
            .filter(|letter| !letter.is_empty());
        let beta: Vec<usize> = letters.map(index).collect();
        let lengths = numbers(&case["length"]);
        let golden = case["result"].as_array().unwrap().iter();
        let golden: Vec<usize> = golden.map(|name| index(name.as_str().unwrap())).collect();
        let ours = merge(&beta, &lengths, case["least"].as_f64().unwrap(), advance_m);
        assert_eq!(ours, golden, "{case}");
    }
    assert_eq!(cases.len(), 6);
}

/// The paper's example: floor up to 5 m, rubble up to 15 m, road beyond.
fn corridor() -> World {
    let raster = Raster::new([120, 4], 0.25, [0.0; 2]).unwrap();
    let class = |cell: usize| match raster.centre_m(cell)[0] {
        x if x < 5.0 => 0,
        x if x < 15.0 => 2,
        _ => 1,
    };
    let terrain = (0..raster.cells()).map(class).collect();
    World::new(raster, vec![false; raster.cells()], terrain).unwrap()
}

#[test]
fn val_the_papers_way_is_walked_climbed_and_run() {
    let way: Vec<Point> = (0..27).map(|k| [f64::from(k), 0.5]).collect();
    let behaviour = paper_parameters().behaviour;
    let mut ours = of_legs(&way, &corridor(), &behaviour, false);
    // The last point begins no leg and has the behaviour of the one before it.
    ours.extend(ours.last().copied());
    let golden = GOLDEN["behaviour"]["beta_of_points"].as_array().unwrap();
    let golden: Vec<usize> = golden
        .iter()
        .map(|name| index(name.as_str().unwrap()))
        .collect();
    assert_eq!(ours, golden);
    assert_eq!(golden.len(), 27);
}

#[test]
fn who_carries_supplies_does_not_run() {
    let way: Vec<Point> = (0..27).map(|k| [f64::from(k), 0.5]).collect();
    let behaviour = paper_parameters().behaviour;
    let ours = of_legs(&way, &corridor(), &behaviour, true);
    let expected = [vec![WALK; 5], vec![CLIMB; 10], vec![WALK; 11]].concat();
    assert_eq!(ours, expected);
    assert!(of_legs(&way, &corridor(), &behaviour, false).contains(&RUN));
}

#[test]
fn a_border_under_the_middle_of_a_leg_counts_for_its_beginning_whatever_the_rounding() {
    let behaviour = paper_parameters().behaviour;
    for rounding in [-1e-15, 0.0, 1e-15] {
        let way: Vec<Point> = (0..6)
            .map(|k| [2.0 * f64::from(k) + rounding, 0.5])
            .collect();
        // The border at 5 m lies under the middle of the leg from 4 m to 6 m.
        let ours = of_legs(&way, &corridor(), &behaviour, false);
        assert_eq!(ours, [WALK, WALK, WALK, CLIMB, CLIMB]);
    }
}

#[test]
fn merging_never_makes_a_leg_faster_and_ends() {
    for seed in 0..200 {
        let unit = |k: u32| crate::mission::world::unit(seed, k);
        let beta: Vec<usize> = (0..30).map(|k| (3.0 * unit(k)) as usize).collect();
        let lengths: Vec<f64> = (30..60).map(|k| 0.2 + 2.0 * unit(k)).collect();
        let merged = merge(&beta, &lengths, 2.0, advance_m);
        let slower = |(&before, &after): (&usize, &usize)| advance_m(after) <= advance_m(before);
        assert!(beta.iter().zip(&merged).all(slower));
        // Merging again changes nothing.
        assert_eq!(merge(&merged, &lengths, 2.0, advance_m), merged);
    }
}
