//! Single rules of missions: endurance, rescue, sight, losses, what is observed.

use crate::mission::scenarios::*;
use urts_mc::mission::parameters::*;
use urts_mc::mission::plane::{Disc, Point, distance};
use urts_mc::mission::{
    Activity, Event, EventKind, Mission, MissionDraws, Motion, Observed, Outcome, Parameters,
    Scenario, Subject, ideal, ideal_watched,
};

fn count(outcome: &Outcome, kind: EventKind) -> usize {
    outcome.events_of(kind, None).count()
}

fn only(outcome: &Outcome, kind: EventKind) -> &Event {
    let mut events = outcome.events_of(kind, None);
    let event = events.next().unwrap_or_else(|| panic!("no {kind:?}"));
    assert!(events.next().is_none(), "several {kind:?}");
    event
}

/// The small mission with other parameters.
fn small_with(change: impl FnOnce(&mut Parameters)) -> (Scenario, MissionDraws) {
    let (scenario, draws) = small();
    let mut parameters = scenario.parameters().clone();
    change(&mut parameters);
    (
        Scenario::new(scenario.world().clone(), parameters).unwrap(),
        draws,
    )
}

#[test]
fn names_of_events_are_all_different() {
    let names: std::collections::BTreeSet<&str> =
        EventKind::ALL.iter().map(|kind| kind.name()).collect();
    assert_eq!(names.len(), EventKind::ALL.len());
}

#[test]
fn an_agent_whose_endurance_is_over_stops_rests_and_takes_no_task() {
    let (scenario, mut draws) = small();
    draws.endurance_s = vec![30.0, f64::INFINITY, 60.5];
    let mut states = Vec::new();
    let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
        states.push((
            mission.motions().to_vec(),
            mission.activities().collect::<Vec<_>>(),
        ));
    });
    let exhausted: Vec<(f64, usize)> = outcome
        .events_of(EventKind::Exhausted, None)
        .map(|event| (event.time_s, event.agent.unwrap()))
        .collect();
    // The UAV drops its cruise and is at rest after at most two ramps of 3 s; the robot stops within two pages.
    let [(uav_s, 0), (robot_s, 2)] = exhausted[..] else {
        panic!("{exhausted:?}")
    };
    assert!((31.0..=37.0).contains(&uav_s) && (62.0..=65.0).contains(&robot_s));
    for (agent, from_s) in [(0, uav_s), (2, robot_s)] {
        let after = outcome
            .events
            .iter()
            .filter(|event| event.kind == EventKind::Assigned);
        assert!(
            !after
                .clone()
                .any(|event| event.agent == Some(agent) && event.time_s > from_s)
        );
        for (motions, activities) in &states[from_s as usize + 1..] {
            assert_eq!(activities[agent], Activity::Exhausted);
            let gone = matches!(motions[agent], Motion::Gone { .. });
            assert_eq!(gone, agent == 0, "a UAV is gone, a robot stands");
        }
    }
    // Its speed is continuous on the way to rest.
    for pair in states.windows(2) {
        if let (Motion::Flight { to, .. }, Motion::Flight { from, .. }) =
            (pair[0].0[0], pair[1].0[0])
        {
            assert_eq!(to, from);
        }
    }
    // Nobody is lost by it.
    assert_eq!(outcome.lost(), 0);
}

#[test]
fn finding_is_enough_where_nobody_is_sent() {
    let (scenario, draws) = small_with(|parameters| parameters.rescue.robots = 0);
    let outcome = ideal(&scenario, &draws, &[]);
    assert_eq!(outcome.found_s, outcome.rescued_s);
    // Found at 48.7 s, known at 49 s: over when the epoch that is flown then ends.
    assert_eq!(outcome.accomplished_s, Some(50.0));
    assert_eq!(count(&outcome, EventKind::Rescued), 0);
    assert!(outcome.succeeds(&scenario.parameters().success));
}

#[test]
fn a_target_to_which_no_way_leads_is_unreachable() {
    // A target within walls that UAVs see from above.
    let ring = [
        corners(5.0, 8.0, 11.0, 9.0),
        corners(5.0, 13.0, 11.0, 14.0),
        corners(5.0, 8.0, 6.0, 14.0),
        corners(10.0, 8.0, 11.0, 14.0),
    ];
    let (small_scenario, draws) = small();
    let mut parameters = small_scenario.parameters().clone();
    parameters.targets = Targets::Fixed(vec![[8.0, 11.0]]);
    parameters.epochs = 200;
    let scenario = Scenario::new(world([20.0; 2], 0.25, &ring), parameters).unwrap();
    let draws = MissionDraws {
        targets_m: vec![[8.0, 11.0]],
        ..draws
    };
    let outcome = ideal(&scenario, &draws, &[]);
    assert_eq!(
        only(&outcome, EventKind::Unreachable).subject,
        Some(Subject::Target(0))
    );
    assert_eq!(
        (outcome.found(), outcome.rescued(), outcome.accomplished_s),
        (1, 0, None)
    );
    assert_eq!(count(&outcome, EventKind::ReachedTarget), 0);
    assert!(!outcome.succeeds(&scenario.parameters().success));
    let found_only = Success {
        rescued: Some(0),
        ..scenario.parameters().success
    };
    assert!(outcome.succeeds(&found_only));
}

#[test]
fn a_search_goal_that_is_walled_in_is_skipped() {
    // The first goal of the first robot's strip is (2.5, 2.5): nothing within 2 m of it can be reached.
    let ring = [corners(0.0, 5.0, 5.5, 5.5), corners(5.0, 0.0, 5.5, 5.5)];
    let (small_scenario, draws) = small();
    let mut parameters = small_scenario.parameters().clone();
    parameters.teams[0].starts_m[1] = [7.5, 1.0];
    parameters.epochs = 30;
    let scenario = Scenario::new(world([20.0; 2], 0.25, &ring), parameters).unwrap();
    let outcome = ideal(&scenario, &draws, &[]);
    let skipped = only(&outcome, EventKind::GoalSkipped);
    assert_eq!(
        (skipped.agent, skipped.subject, skipped.value),
        (Some(1), Some(Subject::Search(1)), Some(0.0))
    );
    assert_eq!(count(&outcome, EventKind::NoPath), 1);
}

#[test]
fn a_robot_does_not_see_through_walls_and_a_uav_does() {
    let found = |wall: bool, uav: bool| {
        let wall = if wall {
            vec![corners(9.0, 0.0, 9.5, 19.0)]
        } else {
            vec![]
        };
        let (small_scenario, draws) = small();
        let mut parameters = small_scenario.parameters().clone();
        parameters.targets = Targets::Fixed(vec![[10.5, 1.5]]);
        parameters.teams[0].starts_m = vec![[8.0, 1.0], [8.0, 1.5], [18.0, 18.0]];
        parameters.epochs = 10;
        let scenario = Scenario::new(world([20.0; 2], 0.25, &wall), parameters).unwrap();
        let thresholds = [!uav, uav, true].map(|blind| vec![if blind { 1e9 } else { 0.3 }]);
        let draws = MissionDraws {
            targets_m: vec![[10.5, 1.5]],
            thresholds: thresholds.to_vec(),
            ..draws
        };
        ideal(&scenario, &draws, &[]).found() == 1
    };
    assert!(found(false, false) && !found(true, false));
    assert!(found(false, true) && found(true, true));
}

#[test]
fn the_ground_station_knows_of_a_loss_after_the_heartbeat() {
    for heartbeat in [1, 4] {
        let (scenario, draws) = small_with(|parameters| parameters.heartbeat_epochs = heartbeat);
        let outcome = ideal(&scenario, &draws, &[(1, 20.4)]);
        let lost = only(&outcome, EventKind::Lost);
        assert_eq!((lost.agent, lost.time_s), (Some(1), 20.4));
        // The first decision at or after 20.4 s plus the heartbeat.
        assert_eq!(lost.value, Some(f64::from(21 + heartbeat)));
        assert_eq!(outcome.lost_s, [None, Some(20.4), None]);
        assert_eq!((outcome.lost(), outcome.first_lost_s()), (1, Some(20.4)));
        // The other robot goes to the target alone, twice: it serves both slots.
        assert_eq!(count(&outcome, EventKind::ReachedTarget), 2);
        assert!(outcome.accomplished_s.is_some());
    }
}

#[test]
fn a_lost_robot_stands_where_its_reference_was_and_others_walk_around_it() {
    let (scenario, draws) = small();
    let mut stood = Vec::new();
    let outcome = ideal_watched(&scenario, &draws, &[(1, 30.0)], |mission| {
        if let Motion::Gone { at_m } = mission.motions()[1] {
            stood.push(at_m);
        }
    });
    assert!(stood.len() > 50 && stood.iter().all(|&at_m| at_m == stood[0]));
    assert_eq!(outcome.tally.collisions.total(), 0);
}

#[test]
fn places_that_are_not_finite_count_as_the_reference() {
    let (scenario, draws) = small();
    let exact = ideal(&scenario, &draws, &[]);
    let mut mission = Mission::start(&scenario, &draws);
    let places_m = vec![
        [f64::NAN, 0.0],
        [f64::INFINITY, 1.0],
        [1.0, f64::NEG_INFINITY],
    ];
    let observed = Observed {
        places_m: &places_m,
        lost_s: &[None; 3],
    };
    while !mission.is_over() {
        mission.decide(&observed);
    }
    let outcome = mission.finish(&observed);
    assert_eq!(outcome.found_s, exact.found_s);
    assert_eq!(outcome.accomplished_s, exact.accomplished_s);
}

#[test]
fn detection_sees_the_true_places_and_decisions_the_references() {
    // A UAV that is seen 10 m beside its lanes finds nothing there, though its references pass the target.
    let (scenario, mut draws) = small();
    draws.thresholds[1][0] = 1e9;
    draws.thresholds[2][0] = 1e9;
    let exact = ideal(&scenario, &draws, &[]);
    assert!(exact.found() == 1);
    let mut mission = Mission::start(&scenario, &draws);
    let mut places_m: Vec<Point> = scenario.starts_m().to_vec();
    let mut references = Vec::new();
    while !mission.is_over() {
        let motions = mission.motions().to_vec();
        references.push(motions[0].end_m());
        mission.decide(&Observed {
            places_m: &places_m,
            lost_s: &[None; 3],
        });
        places_m = motions.iter().map(Motion::end_m).collect();
        places_m[0][0] += 30.0;
    }
    let outcome = mission.finish(&Observed {
        places_m: &places_m,
        lost_s: &[None; 3],
    });
    assert_eq!(outcome.found(), 0);
    assert!(
        references
            .iter()
            .any(|&place| distance(place, [12.5, 12.0]) < 3.5)
    );
}

#[test]
fn of_two_agents_that_find_a_target_in_one_epoch_the_earlier_counts() {
    let (scenario, mut draws) = small();
    // Both move 6 m to the target. The UAV sees it from 8.5 m on, at 5/12 s, and needs 1/2 s of it; the robot from 9 m
    // on, at 1/2 s, and needs 1/10 s.
    draws.thresholds = vec![vec![0.25], vec![1e9], vec![0.1]];
    let mut mission = Mission::start(&scenario, &draws);
    for y in [6.0, 12.0] {
        mission.decide(&Observed {
            places_m: &[[12.5, y], [0.0; 2], [12.5, y]],
            lost_s: &[None; 3],
        });
    }
    let found = mission
        .events()
        .iter()
        .find(|event| event.kind == EventKind::Found);
    let found = found.unwrap();
    assert_eq!(found.agent, Some(2));
    assert!((found.time_s - 0.6).abs() < 1e-12);
}

#[test]
fn bodies_that_touch_are_counted_once_by_what_they_touch() {
    let (scenario, mut draws) = small();
    draws.obstacles = vec![Disc {
        centre_m: [5.0, 10.0],
        radius_m: 1.0,
    }];
    let mut mission = Mission::start(&scenario, &draws);
    // Both robots are seen to meet, then one of them in the obstacle, twice.
    let tracks: [[Point; 2]; 4] = [
        [[5.0, 1.0], [15.0, 1.0]],
        [[9.8, 1.0], [10.2, 1.0]],
        [[5.0, 8.5], [15.0, 1.0]],
        [[5.0, 11.5], [10.0, 1.0]],
    ];
    for robots in tracks {
        let places_m = [[10.0, 19.0], robots[0], robots[1]];
        mission.decide(&Observed {
            places_m: &places_m,
            lost_s: &[None; 3],
        });
    }
    let collisions: Vec<_> = mission
        .events()
        .iter()
        .filter(|event| event.kind == EventKind::Collision)
        .map(|event| (event.time_s, event.agent, event.other, event.subject))
        .collect();
    assert_eq!(
        collisions,
        [
            (1.0, Some(1), Some(2), None),
            (3.0, Some(1), None, Some(Subject::Obstacle(0))),
        ]
    );
}

#[test]
fn an_obstacle_that_is_sensed_makes_robots_go_around_it() {
    let (scenario, mut draws) = small();
    // On the first robot's first lane, from (2.5, 2.5) to (2.5, 17.5); the UAV does not come near before 50 s.
    draws.obstacles = vec![Disc {
        centre_m: [2.5, 12.0],
        radius_m: 0.8,
    }];
    draws
        .thresholds
        .iter_mut()
        .flatten()
        .for_each(|threshold| *threshold = 1e9);
    let mut nearest_m = f64::INFINITY;
    let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
        nearest_m = nearest_m.min(distance(mission.motions()[1].end_m(), [2.5, 12.0]));
    });
    assert_eq!(count(&outcome, EventKind::ObstacleSensed), 1);
    assert!(count(&outcome, EventKind::Replan) <= 1);
    assert!(nearest_m >= 0.8 + 0.35, "{nearest_m}");
    assert_eq!(outcome.tally.collisions.total(), 0);
}

#[test]
fn tables_have_what_an_outcome_says() {
    let (scenario, draws) = small();
    let outcome = ideal(&scenario, &draws, &[]);
    assert_eq!(outcome.first_found_s(), outcome.found_s[0]);
    assert_eq!(outcome.all_found_s(), outcome.found_s[0]);
    assert_eq!(outcome.all_rescued_s(), Some(115.0));
    assert_eq!(
        (outcome.found(), outcome.rescued(), outcome.first_lost_s()),
        (1, 1, None)
    );
    let ratio = outcome.tally.path_ratio().unwrap();
    // Straight ways on free ground.
    assert!((ratio - 1.0).abs() < 1e-12);
    let walked_m: f64 = outcome.tally.walked_m.iter().sum();
    assert!(walked_m > 30.0 && outcome.tally.walked_m[RUN] == 0.0);
    assert!(outcome.tally.flown_m > 80.0);
    assert!(
        outcome
            .tally
            .coverage
            .windows(2)
            .all(|pair| pair[0] <= pair[1])
    );
    let none_lost = Success {
        max_lost: 0,
        ..scenario.parameters().success
    };
    assert!(outcome.succeeds(&none_lost));
    let lost = ideal(&scenario, &draws, &[(0, 100.0)]);
    assert!(!lost.succeeds(&none_lost) && lost.succeeds(&scenario.parameters().success));
}
