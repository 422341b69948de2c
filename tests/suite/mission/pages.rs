//! Gaits as pages, and robots that walk and stop with them.

use crate::mission::scenarios::*;
use urts_mc::mission::pages::{Gait, Page, PageLibrary, PagesError};
use urts_mc::mission::parameters::{Behaviour, Targets};
use urts_mc::mission::plane::distance;
use urts_mc::mission::world::{Raster, World};
use urts_mc::mission::{
    Activity, MissionDraws, Motion, Outcome, Parameters, Scenario, ideal_watched,
};

fn page(number: u32, advance_m: f64) -> Page {
    Page { number, advance_m }
}

/// A gait of two pages per cycle that stops differently after the first and the second of them.
fn paired() -> Gait {
    let start = vec![page(1, 0.0), page(2, 0.05)];
    let cycle = vec![page(3, 0.2), page(4, 0.3)];
    let stops = vec![
        Some(vec![page(5, 0.1), page(6, 0.0)]),
        Some(vec![page(7, 0.15), page(8, 0.0)]),
    ];
    Gait::new("paired", start, cycle, stops).unwrap()
}

#[test]
fn pages_that_make_no_gait_are_refused() {
    let stop = || vec![Some(vec![page(3, 0.1)])];
    let gait = |start: f64, cycle: Vec<Page>, stop| {
        Gait::new("odd", vec![page(1, start)], cycle, stop).unwrap_err()
    };
    for start in [-0.1, f64::NAN, f64::INFINITY] {
        let error = gait(start, vec![page(2, 0.2)], stop());
        assert!(matches!(error, PagesError::Advance { page: 1, .. }));
    }
    for cycle in [vec![], vec![page(2, 0.0)]] {
        assert!(matches!(
            gait(0.0, cycle, stop()),
            PagesError::Nowhere { .. }
        ));
    }
    let cycle = || vec![page(2, 0.2)];
    for stop in [
        vec![],
        vec![None],
        vec![Some(vec![])],
        [stop(), stop()].concat(),
    ] {
        assert!(matches!(
            gait(0.0, cycle(), stop),
            PagesError::Stops { pages: 1, .. }
        ));
    }
    assert!(PageLibrary::of_points(&[("still", 0.0)]).is_err());
}

/// A robot alone, whose first search goal is `length` ahead on free ground; and the epochs of its first way.
fn first_way(library: PageLibrary, length: f64) -> (Vec<Motion>, f64) {
    let base = parameters(&[rectangle([0.0, 0.0, 4.0, 60.0])], 1);
    let mut parameters = Parameters {
        behaviour: Behaviour {
            library,
            of_class: vec![0],
            walking: 0,
            min_segment_m: 2.0,
        },
        targets: Targets::Fixed(vec![[3.0, 59.0]]),
        epochs: 400,
        ..without_obstacles(base)
    };
    parameters.rescue.robots = 1;
    // The first goal is at (2, 2).
    parameters.teams[0].starts_m[1] = [2.0, 2.0 + length];
    let scenario = Scenario::new(world([4.0, 60.0], 0.25, &[]), parameters).unwrap();
    let mut draws = MissionDraws::of_episode(&scenario, 1, 0).unwrap();
    // Nobody finds the target, so that nothing interrupts the robot.
    draws.thresholds = vec![vec![1e9]; 2];
    let mut motions = Vec::new();
    let mut ended = false;
    let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
        let walks = matches!(mission.activities().nth(1), Some(Activity::Walk(_)));
        ended |= !motions.is_empty() && !walks;
        if walks && !ended {
            motions.push(mission.motions()[1]);
        }
    });
    assert!(ended && outcome.tally.replans == 0);
    let end_m = motions.last().unwrap().end_m();
    (motions, distance(end_m, [2.0, 2.0]))
}

fn numbers_of(motions: &[Motion]) -> Vec<u32> {
    let number = |motion: &Motion| match motion {
        Motion::Walk { page, .. } => *page,
        _ => panic!("a robot walks"),
    };
    motions.iter().map(number).collect()
}

#[test]
fn a_way_takes_the_fewest_pages_that_reach_and_ends_at_its_goal() {
    let library = || PageLibrary {
        stand: 0,
        gaits: vec![paired()],
    };
    // Start 0.05, cycle 0.2 and 0.3, stop 0.1 after whole cycles and 0.15 after the first page of one.
    for (length, pages) in [
        (0.1, vec![1, 2, 5, 6]),
        (0.15, vec![1, 2, 5, 6]),
        (0.16, vec![1, 2, 3, 7, 8]),
        (0.4, vec![1, 2, 3, 7, 8]),
        (0.41, vec![1, 2, 3, 4, 5, 6]),
        (0.65, vec![1, 2, 3, 4, 5, 6]),
        (0.66, vec![1, 2, 3, 4, 3, 7, 8]),
        (1.15, vec![1, 2, 3, 4, 3, 4, 5, 6]),
    ] {
        let (motions, missed_m) = first_way(library(), length);
        assert_eq!(numbers_of(&motions), pages, "{length} m");
        // Rounding of an arc length.
        assert!(missed_m < 1e-12);
        for motion in &motions {
            let Motion::Walk { from_m, to_m, .. } = motion else {
                panic!("a robot walks")
            };
            assert!(
                distance(*from_m, *to_m) <= 0.3 + 1e-12,
                "advances are only reduced"
            );
        }
    }
}

#[test]
fn a_straight_way_of_35_m_takes_178_pages_of_the_point_library() {
    let (motions, missed_m) = first_way(points(), 35.0);
    // 35 m = S + 174 d + E with d = 0.2 m: two pages to start and two to stop beside 174 of the cycle.
    assert_eq!(motions.len(), 178);
    assert!(missed_m < 1e-12);
}

/// The epochs of a robot that walks, climbs and runs 26 m to its target.
fn corridor_way(carry: bool) -> (Vec<Activity>, Vec<Motion>, Outcome) {
    let raster = Raster::new([120, 16], 0.25, [0.0; 2]).unwrap();
    let class = |cell: usize| match raster.centre_m(cell)[0] {
        x if x < 5.0 => 0,
        x if x < 15.0 => 2,
        _ => 1,
    };
    let terrain = (0..raster.cells()).map(class).collect();
    let world = World::new(raster, vec![false; raster.cells()], terrain).unwrap();
    let base = parameters(&[rectangle([0.0, 0.0, 30.0, 4.0])], 1);
    let mut parameters = Parameters {
        targets: Targets::Fixed(vec![[27.0, 2.0]]),
        ..without_obstacles(base)
    };
    parameters.rescue.robots = 1;
    parameters.rescue.carry = carry;
    parameters.teams[0].starts_m = vec![[26.0, 2.0], [0.0, 2.0]];
    let scenario = Scenario::new(world, parameters).unwrap();
    let mut draws = MissionDraws::of_episode(&scenario, 1, 0).unwrap();
    // The UAV finds the target in the first epoch; the robot has not begun to walk then.
    draws.thresholds = vec![vec![1e-9], vec![1e9]];
    let (mut activities, mut motions) = (Vec::new(), Vec::new());
    let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
        activities.extend(mission.activities().nth(1));
        motions.push(mission.motions()[1]);
    });
    (activities, motions, outcome)
}

#[test]
fn val_the_papers_way_takes_the_golden_number_of_epochs() {
    let (activities, motions, outcome) = corridor_way(false);
    assert!(outcome.accomplished_s.is_some());
    let golden = &GOLDEN["behaviour"];
    let epochs = usize::try_from(golden["epochs"].as_u64().unwrap()).unwrap();
    let walks = |own: &Activity| matches!(own, Activity::Walk(_));
    let last = activities.iter().rposition(walks).unwrap();
    let way = last + 1 - epochs..=last;
    // Before it the robot has stopped on its way to a search goal; it begins with the first page of walking.
    let around = numbers_of(&motions[last - epochs..=last + 1 - epochs]);
    assert!(around[0].is_multiple_of(5) && around[1] == 1, "{around:?}");
    let kinds = numbers_of(&motions[way.clone()]);
    let count = |pages: [u32; 3]| kinds.iter().filter(|page| pages.contains(page)).count() as u64;
    let of_kind = |kind: &str| golden["epochs_by_kind"][kind].as_u64().unwrap();
    // Pages of the point library: 5 g + 1 and + 2 to start, + 3 to repeat, + 4 and + 5 to stop.
    assert_eq!(count([1, 6, 11]) + count([2, 7, 12]), of_kind("start"));
    assert_eq!(count([3, 8, 13]), of_kind("cycle"));
    assert_eq!(count([4, 9, 14]) + count([5, 10, 15]), of_kind("stop"));
    let end_m = motions[last].end_m();
    assert!(distance(end_m, [26.0, 2.0]) < 1e-9, "{end_m:?}");
}

#[test]
fn a_robot_on_its_way_to_a_target_does_not_run_if_it_carries_supplies() {
    let runs = |carry: bool| {
        let (activities, _, outcome) = corridor_way(carry);
        assert!(outcome.accomplished_s.is_some());
        activities.contains(&Activity::Walk(RUN))
    };
    assert!(runs(false) && !runs(true));
}

#[test]
fn a_robot_that_is_told_to_stop_ends_its_step_on_its_way() {
    // The first example sends robots to a target in the middle of their search.
    let (scenario, draws) = small();
    let mut pages = Vec::new();
    let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
        if let Motion::Walk { page, to_m, .. } = mission.motions()[2] {
            pages.push((mission.epoch(), page, to_m));
        }
    });
    assert!(outcome.accomplished_s.is_some());
    // Found at 48.7 s, decided at 49 s: the stop begins with epoch 50, after a page of the cycle (3).
    let at = |epoch: usize| pages[epoch].1;
    assert_eq!([at(48), at(49), at(50), at(51), at(52)], [3, 3, 4, 5, 1]);
    let [before, stop, still] = [49, 50, 51].map(|epoch: usize| pages[epoch].2);
    // Half a page's advance, slightly reduced so that the way would end at its goal.
    assert!((distance(before, stop) - 0.1).abs() < 0.002);
    assert!(distance(stop, still) < 1e-12);
}
