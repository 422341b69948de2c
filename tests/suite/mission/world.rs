//! Occupancy, distances, terrain, components, lanes.

use crate::mission::scenarios::*;
use urts_mc::mission::lanes;
use urts_mc::mission::plane::{Disc, Point, distance};
use urts_mc::mission::world::{Raster, World, WorldError, cells_inside};
use urts_mc::random::philox::{Address, Stream};

/// Numbers in (0, 1) for tests, by index.
pub(crate) fn unit(seed: u64, index: u32) -> f64 {
    let address = Address {
        episode: 0,
        stream: Stream::Search,
        entry: 0,
        member: 0,
        index,
    };
    address.unit(seed)
}

/// A world of random discs and rectangles as obstacles.
pub(crate) fn random_world(seed: u64, side_m: f64, obstacles: u32) -> World {
    let polygons = (0..obstacles).map(|k| {
        let [x, y] = [0, 1].map(|i| side_m * unit(seed, 4 * k + i));
        let [w, h] = [2, 3].map(|i| 0.5 + 0.12 * side_m * unit(seed, 4 * k + i));
        corners(x, y, x + w, y + h)
    });
    world([side_m; 2], 0.25, &polygons.collect::<Vec<_>>())
}

#[test]
fn val_lanes_are_those_of_the_golden_file() {
    let cases = GOLDEN["lanes"].as_object().unwrap();
    for (name, golden) in cases {
        // "area x0 y0 x1 y1, lane w .."
        let words: Vec<f64> = name
            .split([' ', ','])
            .filter_map(|word| word.parse().ok())
            .take(5)
            .collect();
        let area = rectangle([words[0], words[1], words[2], words[3]]);
        let ours = lanes(&area, words[4]);
        let golden = points_of(golden);
        assert_eq!(ours.len(), golden.len(), "{name}");
        // Sums of numbers below 64 with few digits.
        let near = |(&a, &b): (&Point, &Point)| distance(a, b) < 1e-12;
        assert!(ours.iter().zip(&golden).all(near), "{name}: {ours:?}");
    }
    assert_eq!(cases.len(), 4);
}

#[test]
fn lanes_leave_nothing_out_and_never_exceed_their_spacing() {
    for k in 0..200 {
        let width = 1.0 + 60.0 * unit(1, 2 * k);
        let lane = 0.5 + 12.0 * unit(1, 2 * k + 1);
        let goals = lanes(&rectangle([0.0, 0.0, width, 80.0]), lane);
        let xs: Vec<f64> = goals.iter().step_by(2).map(|goal| goal[0]).collect();
        let spacing = width / xs.len() as f64;
        assert!(spacing <= lane * (1.0 + 1e-9));
        // Rounding of products of a dozen lanes.
        assert!((xs[0] - spacing / 2.0).abs() < 1e-9);
        assert!((width - xs[xs.len() - 1] - spacing / 2.0).abs() < 1e-9);
        assert!(
            xs.windows(2)
                .all(|pair| (pair[1] - pair[0] - spacing).abs() < 1e-9)
        );
    }
}

#[test]
fn val_the_paper_map_has_the_golden_cells_and_clearances() {
    let world = paper_world();
    let map = &GOLDEN["map"];
    let cells = 0..world.raster().cells();
    let occupied = cells.filter(|&cell| world.is_occupied(cell)).count();
    assert_eq!(occupied as u64, map["occupied"].as_u64().unwrap());
    for (key, class) in [("rubble", 2), ("road", 1)] {
        let count = world.terrain().iter().filter(|&&own| own == class).count();
        assert_eq!(count as u64, map[key].as_u64().unwrap(), "{key}");
    }
    for case in map["clear"].as_array().unwrap() {
        let case = numbers(case);
        let clear_m = world.clear_m([case[0], case[1]], &[]);
        // The golden numbers have nine digits.
        assert!((clear_m - case[2]).abs() < 1e-6, "{case:?}: {clear_m}");
    }
}

#[test]
fn distances_are_those_to_the_nearest_occupied_centre() {
    for seed in 0..5 {
        let world = random_world(seed, 12.0, 6);
        let raster = *world.raster();
        let centres = |occupied: bool| {
            let cells = (0..raster.cells()).filter(|&cell| world.is_occupied(cell) == occupied);
            cells.map(|cell| raster.centre_m(cell)).collect::<Vec<_>>()
        };
        let (occupied, free) = (centres(true), centres(false));
        assert!(!occupied.is_empty() && !free.is_empty());
        for centre in free.into_iter().step_by(7) {
            let nearest = occupied.iter().map(|&other| distance(centre, other));
            let exact_m =
                nearest.fold(f64::INFINITY, f64::min) - 0.25 * std::f64::consts::FRAC_1_SQRT_2;
            // Squares of whole numbers are exact; a root and a product round.
            assert!((world.clear_m(centre, &[]) - exact_m).abs() < 1e-12);
        }
    }
}

#[test]
fn clearance_is_hardly_above_the_distance_to_an_occupied_cell() {
    for seed in 0..5 {
        let world = random_world(seed, 12.0, 6);
        let raster = *world.raster();
        let occupied: Vec<Point> = (0..raster.cells())
            .filter(|&cell| world.is_occupied(cell))
            .map(|cell| raster.centre_m(cell))
            .collect();
        let mut compared = 0;
        for k in 0..400 {
            let point = [
                12.0 * unit(seed + 50, 2 * k),
                12.0 * unit(seed + 50, 2 * k + 1),
            ];
            let to_square = |&centre: &Point| {
                let beyond = [0, 1].map(|i| ((point[i] - centre[i]).abs() - 0.125).max(0.0));
                beyond[0].hypot(beyond[1])
            };
            let exact_m = occupied.iter().map(to_square).fold(f64::INFINITY, f64::min);
            let clear_m = world.clear_m(point, &[]);
            // At the corner of a cell: (0 + 1 + 1 + √2) / 4 - 1/√2 = 0.1465 of its side.
            assert!(
                clear_m <= exact_m + 0.1465 * 0.25,
                "{point:?}: {clear_m} > {exact_m}"
            );
            // Nor much below it: by the diagonal of a cell and what interpolation loses.
            assert!(clear_m >= exact_m - 2.0 * 0.25 * std::f64::consts::SQRT_2);
            compared += usize::from(exact_m > 0.0);
        }
        assert!(compared > 100);
    }
}

#[test]
fn discs_count_with_their_exact_distance_and_outside_is_negative() {
    let world = world([10.0, 10.0], 0.25, &[]);
    let disc = Disc {
        centre_m: [5.0, 5.0],
        radius_m: 1.0,
    };
    assert!((world.clear_m([8.0, 9.0], &[disc]) - 4.0).abs() < 1e-15);
    assert!((world.clear_m([5.0, 5.0], &[disc]) + 1.0).abs() < 1e-15);
    for outside in [[-0.1, 5.0], [10.1, 5.0], [5.0, -1e-9], [f64::NAN, 1.0]] {
        assert!(world.clear_m(outside, &[disc]) < 0.0);
    }
}

#[test]
fn components_are_separated_by_walls_and_joined_by_doors() {
    let wall = |door: f64| {
        let lower = corners(4.0, 0.0, 5.0, 5.0 - door / 2.0);
        let upper = corners(4.0, 5.0 + door / 2.0, 5.0, 10.0);
        world([10.0, 10.0], 0.25, &[lower, upper])
    };
    let (left, right) = ([1.0, 1.0], [9.0, 9.0]);
    assert!(!wall(0.0).joined(left, right));
    assert!(wall(1.0).joined(left, right));
    assert!(
        !wall(1.0).joined(left, [4.5, 0.5]),
        "an occupied cell joins nothing"
    );
    // With 0.6 m to either side the door of 1 m is closed and that of 2 m open.
    let connects = |door: f64| {
        let world = wall(door);
        let [a, b] = [left, right].map(|point| world.raster().cell(point));
        world.components(0.6).connect(a, b)
    };
    assert!(!connects(1.0) && connects(2.0));
    assert_eq!(wall(0.0).components(0.0).count(), 2);
}

#[test]
fn a_polygon_and_its_neighbour_share_no_cell_and_leave_none_out() {
    let raster = Raster::new([40, 40], 0.25, [0.0; 2]).unwrap();
    // The common border runs through centres of cells.
    let left = cells_inside(&corners(0.0, 0.0, 4.125, 4.125), &raster);
    let right = cells_inside(&corners(4.125, 0.0, 10.0, 4.125), &raster);
    let above = cells_inside(&corners(0.0, 4.125, 10.0, 10.0), &raster);
    for cell in 0..raster.cells() {
        let times = [&left, &right, &above]
            .iter()
            .filter(|cells| cells[cell])
            .count();
        assert_eq!(times, 1, "{:?}", raster.centre_m(cell));
    }
}

#[test]
fn rasters_that_no_map_can_have_are_refused() {
    let message = |cells, resolution, origin| {
        Raster::new(cells, resolution, origin)
            .unwrap_err()
            .to_string()
    };
    assert!(message([1, 9], 0.25, [0.0; 2]).contains("1 columns and 9 rows"));
    assert!(message([5000, 4000], 0.25, [0.0; 2]).contains("may have 16000000"));
    assert!(message([usize::MAX; 2], 0.25, [0.0; 2]).contains("may have 16000000"));
    for resolution in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(message([9, 9], resolution, [0.0; 2]).contains("resolution_m"));
    }
    assert!(message([9, 9], 0.25, [f64::NAN, 0.0]).contains("origin_m"));
    let raster = Raster::new([9, 9], 0.25, [0.0; 2]).unwrap();
    let error = World::new(raster, vec![false; 81], vec![0; 80]).unwrap_err();
    assert!(matches!(
        error,
        WorldError::OtherSize {
            what: "terrain",
            cells: 80,
            ..
        }
    ));
}
