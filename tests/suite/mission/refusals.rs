//! Parameters that make no mission, and what may not be meant.

use crate::mission::scenarios::*;
use urts_mc::mission::parameters::*;
use urts_mc::mission::plane::Point;
use urts_mc::mission::world::World;
use urts_mc::mission::{MissionError, Parameters, Scenario};

fn refusal(change: impl FnOnce(&mut Parameters)) -> MissionError {
    let mut parameters = paper_parameters();
    change(&mut parameters);
    Scenario::new(paper_world(), parameters).unwrap_err()
}

/// Asserts that a number is refused by its key.
fn refuses(key: &str, value: &str, change: impl FnOnce(&mut Parameters)) {
    let message = refusal(change).to_string();
    assert!(
        message.starts_with(&format!("{key} = {value}: ")),
        "{message}"
    );
    assert!(message.contains("; "), "{message}");
}

#[test]
fn numbers_out_of_their_limits_are_refused_by_key_value_limit_and_remedy() {
    refuses("epoch_s", "11", |p| p.epoch_s = 11.0);
    refuses("epoch_s", "NaN", |p| p.epoch_s = f64::NAN);
    refuses("time.duration_s", "0", |p| p.epochs = 0);
    refuses("search.lane_m.uav", "0", |p| p.search.uav_lane_m = 0.0);
    refuses("search.lane_m.robot", "-1", |p| {
        p.search.robot_lane_m = -1.0
    });
    refuses("flight.speed_m_s", "0", |p| p.flight.limits.speed_m_s = 0.0);
    refuses("flight.acceleration_m_s2", "inf", |p| {
        p.flight.limits.acceleration_m_s2 = f64::INFINITY
    });
    refuses("flight.altitude_m", "-8", |p| p.flight.altitude_m = -8.0);
    // Four cells of 0.25 m.
    refuses("vision.uav.range_m", "0.9", |p| p.vision.uav.range_m = 0.9);
    refuses("vision.robot.range_m", "0.9", |p| {
        p.vision.robot.range_m = 0.9
    });
    refuses("planner.range_m", "0.9", |p| p.planner.range_m = 0.9);
    refuses("vision.uav.rate_per_s", "0", |p| {
        p.vision.uav.rate_per_s = 0.0
    });
    refuses("vision.sense_obstacles_m", "NaN", |p| {
        p.vision.sense_obstacles_m = f64::NAN
    });
    refuses("rescue.robots", "13", |p| p.rescue.robots = 13);
    refuses("rescue.reach_m", "-1", |p| p.rescue.reach_m = -1.0);
    refuses("planner.radius_m", "0", |p| p.planner.radius_m = 0.0);
    refuses("planner.margin_m", "-0.1", |p| p.planner.margin_m = -0.1);
    refuses("planner.spacing_m", "6", |p| p.planner.spacing_m = 6.0);
    refuses("behaviour.min_segment_m", "-2", |p| {
        p.behaviour.min_segment_m = -2.0
    });
    refuses("ground_station.heartbeat_s", "0", |p| {
        p.heartbeat_epochs = 0
    });
    refuses("obstacles.count", "65", |p| p.obstacles.count.most = 65);
    refuses("obstacles.radius_m", "0", |p| {
        p.obstacles.radius_m.lower = 0.0
    });
    refuses("obstacles.radius_m", "0.1", |p| {
        p.obstacles.radius_m.upper = 0.1
    });
    refuses("obstacles.count", "5", |p| p.obstacles.count.most = 5);
    refuses("targets.count", "65", |p| {
        p.targets = Targets::Random {
            count: WholeRange { least: 1, most: 65 },
            clear_m: 1.0,
        };
    });
    refuses("targets.points_m", "0", |p| {
        p.targets = Targets::Fixed(vec![])
    });
    refuses("endurance_s.uav", "400", |p| {
        p.endurance.uav_s = Some(Range {
            lower: 500.0,
            upper: 400.0,
        });
    });
    refuses("endurance_s.robot", "0", |p| {
        p.endurance.robot_s = Some(Range {
            lower: 0.0,
            upper: 400.0,
        });
    });
}

#[test]
fn nobody_need_be_sent_to_a_target() {
    let mut parameters = paper_parameters();
    parameters.rescue.robots = 0;
    assert!(Scenario::new(paper_world(), parameters).is_ok());
}

#[test]
fn teams_that_are_too_many_or_unlike_are_refused() {
    let map = rectangle([0.0, 0.0, 120.0, 40.0]);
    let areas: Vec<_> = (0..13).map(|team| map.part(team, 13)).collect();
    let message = refusal(|p| p.teams = parameters(&areas, 4).teams).to_string();
    assert!(
        message.contains("= 65: a mission has 1 to 64 agents"),
        "{message}"
    );
    assert!(matches!(
        refusal(|p| p.teams.clear()),
        MissionError::Number { .. }
    ));
    let message = refusal(|p| p.teams[1].starts_m.truncate(3)).to_string();
    assert!(
        message.contains("team 2 has 2 robots and the first one 4"),
        "{message}"
    );
}

#[test]
fn areas_starts_and_targets_that_do_not_lie_on_free_ground_are_refused() {
    let error = refusal(|p| p.teams[2].area.upper_m[0] = 121.0);
    assert_eq!(error, MissionError::AreaOutside { team: 3 });
    let error = refusal(|p| p.teams[0].area.upper_m[1] = -1.0);
    assert_eq!(error, MissionError::AreaOutside { team: 1 });
    // In a building.
    let message = refusal(|p| p.teams[0].starts_m[2] = [10.0, 12.0]).to_string();
    assert!(
        message.contains("agent a1,3 starts at [10.0, 12.0]") && message.contains("0.35"),
        "{message}"
    );
    for outside in [[10.0, 12.0], [-1.0, 5.0]] {
        let error = refusal(|p| p.targets = Targets::Fixed(vec![[2.0, 2.0], outside]));
        assert_eq!(
            error,
            MissionError::TargetBlocked {
                target: 2,
                place_m: outside
            }
        );
    }
}

fn walled() -> World {
    world([20.0; 2], 0.25, &[corners(0.0, 3.0, 20.0, 4.0)])
}

#[test]
fn a_start_from_which_no_goal_can_be_reached_is_refused() {
    let mut parameters = without_obstacles(parameters(&[rectangle([0.0, 6.0, 20.0, 20.0])], 2));
    parameters.teams[0].starts_m = vec![[10.0, 1.0], [5.0, 1.0], [15.0, 10.0]];
    let error = Scenario::new(walled(), parameters.clone()).unwrap_err();
    assert!(
        error.to_string().contains("start [5.0, 1.0] of agent a1,2"),
        "{error}"
    );
    parameters.teams[0].starts_m[1] = [5.0, 10.0];
    assert!(Scenario::new(walled(), parameters).is_ok());
}

#[test]
fn classes_without_behaviour_and_behaviours_without_gait_are_refused() {
    let error = refusal(|p| p.behaviour.of_class.truncate(2));
    assert_eq!(error, MissionError::ClassWithoutBehaviour { class: 2 });
    let error = refusal(|p| p.behaviour.of_class[1] = 3);
    assert_eq!(
        error,
        MissionError::UnknownBehaviour {
            behaviour: 3,
            gaits: 3
        }
    );
    let error = refusal(|p| p.behaviour.walking = 7);
    assert_eq!(
        error,
        MissionError::UnknownBehaviour {
            behaviour: 7,
            gaits: 3
        }
    );
}

#[test]
fn lanes_with_gaps_are_a_caution_with_the_probability_of_a_find() {
    assert!(PAPER.cautions().is_empty(), "{:?}", PAPER.cautions());
    let mut parameters = paper_parameters();
    parameters.search.uav_lane_m = 10.0;
    let scenario = Scenario::new(paper_world(), parameters).unwrap();
    let cautions = scenario.cautions();
    // The sweep width of 5.07 m over 10 m.
    assert_eq!(cautions.len(), 1);
    let message = cautions[0].to_string();
    assert!(
        message.contains("search.lane_m.uav = 10 m") && message.contains("probability 0.51"),
        "{message}"
    );
}

#[test]
fn goals_behind_passages_that_are_too_narrow_are_a_caution() {
    // A door of 1 m: free cells are joined, but not with 0.6 m to either side.
    let door = |width: f64| {
        let walls = [
            corners(0.0, 9.0, 10.0 - width / 2.0, 9.5),
            corners(10.0 + width / 2.0, 9.0, 20.0, 9.5),
        ];
        let parameters = without_obstacles(parameters(&[rectangle([0.0, 0.0, 20.0, 20.0])], 2));
        Scenario::new(world([20.0; 2], 0.25, &walls), parameters)
            .unwrap()
            .cautions()
    };
    let cautions = door(1.0);
    assert_eq!(cautions.len(), 2);
    assert!(
        cautions[0]
            .to_string()
            .contains("2 of 4 goals of agent a1,2"),
        "{}",
        cautions[0]
    );
    assert!(door(3.0).is_empty());
}

#[test]
fn numbers_and_names_of_agents_are_those_of_the_paper() {
    let names: Vec<String> = [0, 4, 5, 14].map(|agent| PAPER.name(agent)).to_vec();
    assert_eq!(names, ["a1,1", "a1,5", "a2,1", "a3,5"]);
    let uavs: Vec<usize> = (0..15).filter(|&agent| PAPER.is_uav(agent)).collect();
    assert_eq!(uavs, [0, 5, 10]);
    let heights: Vec<f64> = uavs.iter().map(|&uav| PAPER.altitude_m(uav)).collect();
    assert_eq!(heights, [8.0, 10.0, 12.0]);
    let starts: [Point; 2] = [PAPER.starts_m()[0], PAPER.starts_m()[4]];
    assert_eq!(starts, [[20.0, 1.0], [35.0, 1.0]]);
}
