//! The missions of the golden file, and others that many tests use.

use crate::common::golden;
use serde_json::Value;
use std::sync::LazyLock;
use urts_mc::mission::pages::PageLibrary;
use urts_mc::mission::parameters::*;
use urts_mc::mission::plane::{Point, Rectangle};
use urts_mc::mission::uav_leg::FlightLimits;
use urts_mc::mission::vision::Sensor;
use urts_mc::mission::world::{Raster, World, cells_inside};
use urts_mc::mission::{MissionDraws, Scenario};

/// The seed of all missions of the golden file.
pub(crate) const SEED: u64 = 2026;

/// Indices of the gaits.
pub(crate) const WALK: usize = 0;
pub(crate) const RUN: usize = 1;
pub(crate) const CLIMB: usize = 2;

/// The golden file of missions.
pub(crate) static GOLDEN: LazyLock<Value> = LazyLock::new(|| golden("mission.json"));

/// The point library of all golden missions: walk, run and climb.
pub(crate) fn points() -> PageLibrary {
    PageLibrary::of_points(&[("walk", 0.2), ("run", 0.5), ("climb", 0.1)]).unwrap()
}

/// A rectangle from corner to corner.
pub(crate) fn rectangle([x0, y0, x1, y1]: [f64; 4]) -> Rectangle {
    Rectangle {
        lower_m: [x0, y0],
        upper_m: [x1, y1],
    }
}

/// The values of a JSON array.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap().iter();
    values.map(|x| x.as_f64().unwrap()).collect()
}

/// The points of a JSON array.
pub(crate) fn points_of(value: &Value) -> Vec<Point> {
    let points = value.as_array().unwrap().iter();
    points
        .map(|point| [point[0].as_f64().unwrap(), point[1].as_f64().unwrap()])
        .collect()
}

fn raster(columns: usize, rows: usize, resolution_m: f64) -> Raster {
    Raster::new([columns, rows], resolution_m, [0.0; 2]).unwrap()
}

/// A world of one class of terrain with polygons as obstacles, from the origin to (width, height).
pub(crate) fn world(
    [width, height]: [f64; 2],
    resolution_m: f64,
    polygons: &[Vec<Point>],
) -> World {
    let cells = [width, height].map(|side| (side / resolution_m).round() as usize);
    let raster = raster(cells[0], cells[1], resolution_m);
    let mut occupied = vec![false; raster.cells()];
    for polygon in polygons {
        fill(&mut occupied, &raster, polygon, true);
    }
    World::new(raster, occupied, vec![0; raster.cells()]).unwrap()
}

/// Gives a value to all cells inside a polygon.
pub(crate) fn fill<T: Copy>(cells: &mut [T], raster: &Raster, polygon: &[Point], value: T) {
    for (cell, inside) in cells.iter_mut().zip(cells_inside(polygon, raster)) {
        if inside {
            *cell = value;
        }
    }
}

/// The corners of a rectangle.
pub(crate) fn corners(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
    vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

/// The map of the golden missions: twelve buildings, rubble and roads on 120 m x 40 m.
pub(crate) fn paper_world() -> World {
    let map = &GOLDEN["map"];
    let raster = raster(480, 160, 0.25);
    let mut occupied = vec![false; raster.cells()];
    let mut terrain = vec![0; raster.cells()];
    let polygons = |key: &str| -> Vec<Vec<Point>> {
        map[key].as_array().unwrap().iter().map(points_of).collect()
    };
    for polygon in polygons("buildings") {
        fill(&mut occupied, &raster, &polygon, true);
    }
    for (key, class) in [("rubbles", 2), ("roads", 1)] {
        for polygon in polygons(key) {
            fill(&mut terrain, &raster, &polygon, class);
        }
    }
    World::new(raster, occupied, terrain).unwrap()
}

/// The parameters of the golden missions for these areas.
pub(crate) fn parameters(areas: &[Rectangle], robots: usize) -> Parameters {
    Parameters {
        epoch_s: 1.0,
        epochs: 600,
        teams: areas
            .iter()
            .map(|&area| Team::below(area, robots))
            .collect(),
        search: Search {
            uav_lane_m: 5.0,
            robot_lane_m: 5.0,
            repeat: true,
            look_epochs: 4,
        },
        flight: Flight {
            limits: FlightLimits {
                speed_m_s: 2.0,
                acceleration_m_s2: 1.0,
            },
            altitude_m: 8.0,
            altitude_step_m: 2.0,
        },
        vision: Vision {
            uav: Sensor {
                range_m: 3.5,
                rate_per_s: 0.5,
            },
            robot: Sensor {
                range_m: 3.0,
                rate_per_s: 1.0,
            },
            sense_obstacles_m: 5.0,
        },
        targets: Targets::Random {
            count: WholeRange { least: 3, most: 3 },
            clear_m: 1.0,
        },
        rescue: Rescue {
            robots: 2,
            reach_m: 1.0,
            supply_epochs: 10,
            carry: false,
        },
        obstacles: Obstacles {
            count: WholeRange { least: 6, most: 10 },
            radius_m: Range {
                lower: 0.4,
                upper: 1.0,
            },
            keep_clear_m: 2.0,
        },
        planner: Planner {
            radius_m: 0.35,
            margin_m: 0.25,
            range_m: 2.0,
            iterations: 3000,
            shortcuts: 100,
            spacing_m: 1.0,
        },
        behaviour: Behaviour {
            library: points(),
            of_class: vec![WALK, RUN, CLIMB],
            walking: WALK,
            min_segment_m: 2.0,
        },
        heartbeat_epochs: 1,
        endurance: Endurance::default(),
        success: Success {
            found: None,
            rescued: None,
            max_collisions: 0,
            max_lost: 15,
        },
    }
}

/// Without obstacles that are not known at first.
pub(crate) fn without_obstacles(parameters: Parameters) -> Parameters {
    let none = WholeRange { least: 0, most: 0 };
    Parameters {
        obstacles: Obstacles {
            count: none,
            ..parameters.obstacles
        },
        ..parameters
    }
}

/// The paper's scenario: three teams of one UAV and four robots, areas side by side.
pub(crate) fn paper_parameters() -> Parameters {
    let map = rectangle([0.0, 0.0, 120.0, 40.0]);
    let areas: Vec<Rectangle> = (0..3).map(|team| map.part(team, 3)).collect();
    parameters(&areas, 4)
}

/// Three random targets and unknown obstacles on the paper's map.
pub(crate) static PAPER: LazyLock<Scenario> =
    LazyLock::new(|| Scenario::new(paper_world(), paper_parameters()).unwrap());

/// The paper's example: one target between the areas of two teams, no obstacles.
pub(crate) fn paper_example() -> (Scenario, MissionDraws) {
    let parameters = Parameters {
        targets: Targets::Fixed(vec![[40.5, 20.0]]),
        ..without_obstacles(paper_parameters())
    };
    let scenario = Scenario::new(paper_world(), parameters).unwrap();
    let draws = MissionDraws::of_episode(&scenario, SEED, 0).unwrap();
    (scenario, draws)
}

/// One UAV and two robots on 20 m x 20 m of free ground, one target, all thresholds one.
pub(crate) fn small() -> (Scenario, MissionDraws) {
    let base = parameters(&[rectangle([0.0, 0.0, 20.0, 20.0])], 2);
    let parameters = Parameters {
        targets: Targets::Fixed(vec![[12.5, 12.0]]),
        search: Search {
            repeat: false,
            ..base.search
        },
        ..without_obstacles(base)
    };
    let scenario = Scenario::new(world([20.0; 2], 0.25, &[]), parameters).unwrap();
    let mut draws = MissionDraws::of_episode(&scenario, SEED, 0).unwrap();
    draws
        .thresholds
        .iter_mut()
        .flatten()
        .for_each(|threshold| *threshold = 1.0);
    (scenario, draws)
}
