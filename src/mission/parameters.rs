//! The numbers of a mission, as its campaign file gives them.

use crate::mission::lanes::starts_below;
use crate::mission::pages::PageLibrary;
use crate::mission::plane::{Point, Rectangle};
use crate::mission::uav_leg::FlightLimits;
use crate::mission::vision::Sensor;

/// Most agents, targets and obstacles each: members of random addresses are agent · 64 + target.
pub(crate) const MOST: usize = 64;

/// All parameters of a mission. [`Scenario::new`](crate::mission::scenario::Scenario::new) checks them against each
/// other and the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Time between decisions, s.
    pub epoch_s: f64,
    /// The mission's limit in epochs.
    pub epochs: u32,
    /// The teams and what each of them searches.
    pub teams: Vec<Team>,
    /// How areas are searched.
    pub search: Search,
    /// How UAVs fly.
    pub flight: Flight,
    /// What agents see.
    pub vision: Vision,
    /// Where targets are.
    pub targets: Targets,
    /// What becomes of a target that is found.
    pub rescue: Rescue,
    /// Obstacles that nobody knows before they are sensed.
    pub obstacles: Obstacles,
    /// How ways are planned.
    pub planner: Planner,
    /// Gaits and where robots use them.
    pub behaviour: Behaviour,
    /// Epochs until the ground station knows that an agent is lost.
    pub heartbeat_epochs: u32,
    /// How long agents last.
    pub endurance: Endurance,
    /// When the mission counts as a success.
    pub success: Success,
}

/// One UAV and some robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Team {
    /// What the UAV searches; the robots' strips are equal parts of it along x.
    pub area: Rectangle,
    /// Where the agents start, the UAV first, m.
    pub starts_m: Vec<Point>,
}

/// How areas are searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Largest spacing of the UAVs' lanes, m.
    pub uav_lane_m: f64,
    /// Largest spacing of the robots' lanes, m.
    pub robot_lane_m: f64,
    /// Whether what has been searched is searched again.
    pub repeat: bool,
    /// Epochs for which a robot turns on the spot at each goal.
    pub look_epochs: u32,
}

/// How UAVs fly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Largest speed and acceleration in the plane.
    pub limits: FlightLimits,
    /// Height of the first team's UAV, m.
    pub altitude_m: f64,
    /// How much higher each further one flies, m: they never meet (Assumption 2.4).
    pub altitude_step_m: f64,
}

/// What agents see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vision {
    /// A UAV's view of targets; it senses obstacles within the same range.
    pub uav: Sensor,
    /// A robot's view of targets, where no obstacle of the map is in between.
    pub robot: Sensor,
    /// Within which range robots sense obstacles, m.
    pub sense_obstacles_m: f64,
}

/// A whole number between two others, both included, all equally likely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WholeRange {
    /// The least.
    pub least: u32,
    /// The most.
    pub most: u32,
}

/// A number between two others, uniformly distributed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

/// Where targets are.
#[derive(Clone, Debug, PartialEq)]
pub enum Targets {
    /// Where they are said to be, m.
    Fixed(Vec<Point>),
    /// Anywhere on the map.
    Random {
        /// How many.
        count: WholeRange,
        /// How far from the map's obstacles at least, m.
        clear_m: f64,
    },
}

/// What becomes of a target that is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rescue {
    /// Robots that are sent to it; with none, finding is enough.
    pub robots: u32,
    /// How far from it a robot stands, m.
    pub reach_m: f64,
    /// Epochs for which each supplies it.
    pub supply_epochs: u32,
    /// Whether a robot on its way to it walks no faster than the walking gait.
    pub carry: bool,
}

/// Discs that nobody knows before they are sensed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacles {
    /// How many.
    pub count: WholeRange,
    /// Their radii, m.
    pub radius_m: Range,
    /// How far their borders stay from starts and targets, m.
    pub keep_clear_m: f64,
}

/// How ways are planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planner {
    /// Radius of a robot, m.
    pub radius_m: f64,
    /// What a way keeps clear beyond it, for tracking and smoothing, m.
    pub margin_m: f64,
    /// Longest extension of a search tree, m.
    pub range_m: f64,
    /// Most extensions.
    pub iterations: u32,
    /// Shortcuts that are tried.
    pub shortcuts: u32,
    /// Largest spacing of the points of a way, m.
    pub spacing_m: f64,
}

/// Gaits and where robots use them. A behaviour is an index of the library's gaits.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviour {
    /// The gaits' pages.
    pub library: PageLibrary,
    /// The behaviour on each class of terrain.
    pub of_class: Vec<usize>,
    /// The behaviour by whose speed search tasks are allocated and which supplies are carried with.
    pub walking: usize,
    /// Least length of a part of a way with a behaviour of its own, m.
    pub min_segment_m: f64,
}

/// How long agents last, s; for ever if there is no range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Endurance {
    /// UAVs.
    pub uav_s: Option<Range>,
    /// Robots.
    pub robot_s: Option<Range>,
}

/// When a mission counts as a success.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Success {
    /// Targets that must be found; all of them if it is not said.
    pub found: Option<u32>,
    /// Targets that must be rescued; all of them if it is not said.
    pub rescued: Option<u32>,
    /// Most collisions.
    pub max_collisions: u32,
    /// Most lost agents.
    pub max_lost: u32,
}

impl Planner {
    /// What a way keeps clear of obstacles, m.
    #[must_use]
    pub fn clearance_m(&self) -> f64 {
        self.radius_m + self.margin_m
    }
}

impl Team {
    /// The team that searches `area` with so many robots and starts at its lower edge.
    #[must_use]
    pub fn below(area: Rectangle, robots: usize) -> Self {
        Self {
            starts_m: starts_below(&area, robots),
            area,
        }
    }

    /// Its robots.
    #[must_use]
    pub fn robots(&self) -> usize {
        self.starts_m.len().saturating_sub(1)
    }
}
