//! What holds in every mission, on random maps and seeds.

use crate::mission::scenarios::*;
use crate::mission::world::random_world;
use proptest::prelude::*;
use rayon::prelude::*;
use urts_mc::mission::parameters::{Targets, WholeRange};
use urts_mc::mission::plane::{Point, distance};
use urts_mc::mission::{
    Activity, EventKind, Mission, MissionDraws, Motion, Outcome, Parameters, Scenario, Subject,
    ideal, ideal_watched,
};

/// A mission with agents and when they are lost, s.
type WithLosses = (Scenario, MissionDraws, Vec<(usize, f64)>);

/// A mission of two teams of three robots on a random map, if its starts are free; with losses.
fn random_mission(seed: u64) -> Option<WithLosses> {
    let map = rectangle([0.0, 0.0, 30.0, 30.0]);
    let base = parameters(&[map.part(0, 2), map.part(1, 2)], 3);
    let parameters = Parameters {
        epochs: 250,
        targets: Targets::Random {
            count: WholeRange { least: 1, most: 4 },
            clear_m: 0.5,
        },
        ..base
    };
    let scenario = Scenario::new(random_world(seed, 30.0, 14), parameters).ok()?;
    let draws = MissionDraws::of_episode(&scenario, seed, 0).ok()?;
    let unit = |k: u32| crate::mission::world::unit(seed, 10_000 + k);
    let losses = (0..8).filter(|&agent| unit(agent) < 0.25);
    let losses = losses.map(|agent| (agent as usize, 200.0 * unit(100 + agent)));
    Some((scenario, draws, losses.collect()))
}

/// A task has at most one holder, a rescue as many as it has slots, and nobody who is known to be lost holds one.
fn check_holders(mission: &Mission<'_>, scenario: &Scenario) {
    let lost = mission
        .events()
        .iter()
        .filter(|event| event.kind == EventKind::Lost);
    let lost: Vec<usize> = lost.filter_map(|event| event.agent).collect();
    let tasks: Vec<Option<Subject>> = mission.tasks().collect();
    for (agent, task) in tasks.iter().enumerate() {
        let Some(task) = task else { continue };
        assert!(!lost.contains(&agent), "a lost agent holds {task:?}");
        let for_uav = matches!(task, Subject::Search(task) if scenario.is_uav(*task));
        assert_eq!(scenario.is_uav(agent), for_uav);
        let holders = tasks.iter().flatten().filter(|own| *own == task).count();
        let most = match task {
            Subject::Rescue(_) => scenario.parameters().rescue.robots as usize,
            _ => 1,
        };
        assert!(holders <= most, "{holders} hold {task:?}");
    }
}

/// Runs a mission and checks every epoch of it.
fn check_epochs(scenario: &Scenario, draws: &MissionDraws, losses: &[(usize, f64)]) -> Outcome {
    let radius_m = scenario.parameters().planner.radius_m;
    let mut before: Vec<Motion> = Vec::new();
    ideal_watched(scenario, draws, losses, |mission| {
        check_holders(mission, scenario);
        let motions = mission.motions();
        assert_eq!(motions.len(), scenario.agents());
        assert_eq!(mission.activities().count(), scenario.agents());
        for (agent, (motion, activity)) in motions.iter().zip(mission.activities()).enumerate() {
            let is_uav = scenario.is_uav(agent);
            let fits = match motion {
                Motion::Flight { .. } => {
                    is_uav && matches!(activity, Activity::Fly | Activity::Hover)
                }
                Motion::Walk { .. } => {
                    !is_uav && !matches!(activity, Activity::Fly | Activity::Hover | Activity::Lost)
                }
                Motion::Gone { .. } => matches!(activity, Activity::Lost | Activity::Exhausted),
            };
            assert!(fits, "{motion:?} {activity:?}");
            check_continuity(before.get(agent), motion);
        }
        let robots = (0..scenario.agents()).filter(|&agent| !scenario.is_uav(agent));
        let robots: Vec<Point> = robots.map(|agent| motions[agent].end_m()).collect();
        for (index, &a) in robots.iter().enumerate() {
            for &b in &robots[index + 1..] {
                assert!(
                    distance(a, b) >= 2.0 * radius_m,
                    "references of robots touch: {a:?} {b:?}"
                );
            }
        }
        before = motions.to_vec();
    })
}

/// r, r' and r'' pass from epoch to epoch as they are.
fn check_continuity(before: Option<&Motion>, now: &Motion) {
    match (before, now) {
        (Some(Motion::Flight { to, .. }), Motion::Flight { from, .. }) => assert_eq!(to, from),
        (Some(before), Motion::Walk { from_m, .. }) => assert_eq!(before.end_m(), *from_m),
        _ => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn random_missions_keep_their_invariants(seed in 0_u64..100_000) {
        if let Some((scenario, draws, losses)) = random_mission(seed) {
            let outcome = check_epochs(&scenario, &draws, &losses);
            prop_assert_eq!(outcome.tally.collisions.robots, 0);
        }
    }
}

#[test]
fn enough_random_missions_are_possible_and_things_happen_in_them() {
    let outcomes: Vec<Outcome> = (0..60)
        .filter_map(random_mission)
        .map(|(scenario, draws, losses)| check_epochs(&scenario, &draws, &losses))
        .collect();
    assert!(outcomes.len() > 15, "{}", outcomes.len());
    let count = |kind: EventKind| {
        outcomes
            .iter()
            .map(|own| own.events_of(kind, None).count())
            .sum::<usize>()
    };
    for kind in [
        EventKind::Found,
        EventKind::Lost,
        EventKind::Rescued,
        EventKind::Replan,
        EventKind::Waits,
        EventKind::TaskDone,
    ] {
        assert!(count(kind) > 0, "{kind:?}");
    }
}

#[test]
fn without_stops_and_losses_programs_of_robots_keep_their_separation() {
    let parameters = Parameters {
        epochs: 300,
        ..without_obstacles(paper_parameters())
    };
    let scenario = Scenario::new(paper_world(), parameters).unwrap();
    let (mut waits, mut nearest_m) = (0, f64::INFINITY);
    for episode in 0..20 {
        let mut draws = MissionDraws::of_episode(&scenario, SEED, episode).unwrap();
        // Nobody finds anything: who is sent to a rescue stops, and stops are not reserved.
        draws
            .thresholds
            .iter_mut()
            .flatten()
            .for_each(|threshold| *threshold = 1e9);
        let outcome = ideal_watched(&scenario, &draws, &[], |mission| {
            let robots = (0..15).filter(|&agent| !scenario.is_uav(agent));
            let ends: Vec<Point> = robots
                .map(|agent| mission.motions()[agent].end_m())
                .collect();
            for (index, &a) in ends.iter().enumerate() {
                for &b in &ends[index + 1..] {
                    nearest_m = nearest_m.min(distance(a, b));
                }
            }
        });
        assert_eq!(outcome.tally.replans, 0);
        waits += outcome.tally.waits;
    }
    // Distances that differ by less than 1e-6 m are the same.
    assert!(nearest_m >= scenario.separation_m() - 1e-6, "{nearest_m}");
    // Robots did meet, and somebody waited.
    assert!(
        waits > 0 && nearest_m < scenario.separation_m() + 0.2,
        "{waits} {nearest_m}"
    );
}

#[test]
fn a_mission_does_not_depend_on_threads_or_order() {
    let mission = |episode: u32| {
        let draws = MissionDraws::of_episode(&PAPER, SEED, episode).unwrap();
        ideal(&PAPER, &draws, &[(1, 40.0)])
    };
    let forwards: Vec<Outcome> = (0..8).map(mission).collect();
    let mut backwards: Vec<Outcome> = (0..8).rev().map(mission).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let parallel: Vec<Outcome> = pool.install(|| (0..8).into_par_iter().map(mission).collect());
        assert_eq!(forwards, parallel);
    }
    // Episodes differ.
    assert!(forwards.windows(2).all(|pair| pair[0] != pair[1]));
}
