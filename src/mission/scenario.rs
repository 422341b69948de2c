//! A world and a mission's parameters that fit together.

use crate::mission::check::check;
use crate::mission::error::{MissionCaution, MissionError};
use crate::mission::lanes::lanes;
use crate::mission::parameters::{Parameters, Targets};
use crate::mission::plane::{Point, number};
use crate::mission::travel_time::CoarseGrid;
use crate::mission::uav_leg::UavLeg;
use crate::mission::vision::{Sensor, lanes_probability};
use crate::mission::world::World;

/// Everything that all episodes of a mission have in common. It is complete and consistent: nothing after it checks
/// input again.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    world: World,
    parameters: Parameters,
    grid: CoarseGrid,
    starts_m: Vec<Point>,
    robots: usize,
}

impl Scenario {
    /// A mission with these parameters in this world.
    ///
    /// # Errors
    /// See [`MissionError`].
    pub fn new(world: World, parameters: Parameters) -> Result<Self, MissionError> {
        check(&world, &parameters)?;
        let starts_m: Vec<Point> = parameters
            .teams
            .iter()
            .flat_map(|team| team.starts_m.clone())
            .collect();
        let grid = CoarseGrid::new(&world, &parameters).map_err(|_| MissionError::Number {
            key: "map",
            value: world.area().size_m()[0].min(world.area().size_m()[1]),
            limit: "a map is more than 1 m wide and high".into(),
            remedy: "give a larger map",
        })?;
        let scenario = Self {
            robots: parameters.teams.first().map_or(0, |team| team.robots()),
            world,
            parameters,
            grid,
            starts_m,
        };
        scenario.check_places()?;
        Ok(scenario)
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The parameters.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The coarse cells of travel times and coverage.
    #[must_use]
    pub fn grid(&self) -> &CoarseGrid {
        &self.grid
    }

    /// Where all agents start, m.
    #[must_use]
    pub fn starts_m(&self) -> &[Point] {
        &self.starts_m
    }

    /// Number of agents: of each team its UAV, then its robots.
    #[must_use]
    pub fn agents(&self) -> usize {
        self.starts_m.len()
    }

    /// Whether an agent is a UAV.
    #[must_use]
    pub fn is_uav(&self, agent: usize) -> bool {
        agent.is_multiple_of(self.robots + 1)
    }

    /// Team of an agent.
    #[must_use]
    pub fn team(&self, agent: usize) -> usize {
        agent / (self.robots + 1)
    }

    /// The paper's name of an agent: team and member, both from one.
    #[must_use]
    pub fn name(&self, agent: usize) -> String {
        let member = agent % (self.robots + 1) + 1;
        format!("a{},{member}", self.team(agent) + 1)
    }

    /// Height at which a UAV flies, m.
    #[must_use]
    pub fn altitude_m(&self, agent: usize) -> f64 {
        let flight = &self.parameters.flight;
        flight.altitude_m + flight.altitude_step_m * number(self.team(agent))
    }

    /// What an agent finds targets with.
    #[must_use]
    pub fn sensor(&self, agent: usize) -> &Sensor {
        let vision = &self.parameters.vision;
        if self.is_uav(agent) {
            &vision.uav
        } else {
            &vision.robot
        }
    }

    /// Within which range of its border an agent senses an obstacle, m.
    #[must_use]
    pub fn sense_obstacles_m(&self, agent: usize) -> f64 {
        let vision = &self.parameters.vision;
        if self.is_uav(agent) {
            vision.uav.range_m
        } else {
            vision.sense_obstacles_m
        }
    }

    /// The goals of the search task that an agent's number stands for: a UAV's area, a robot's strip.
    #[must_use]
    pub fn goals(&self, agent: usize) -> Vec<Point> {
        let search = &self.parameters.search;
        let area = &self.parameters.teams[self.team(agent)].area;
        if self.is_uav(agent) {
            return lanes(area, search.uav_lane_m);
        }
        let robot = agent % (self.robots + 1) - 1;
        lanes(&area.part(robot, self.robots), search.robot_lane_m)
    }

    /// How long a UAV takes from its start through all goals of its area, s; robots plan, so that theirs is not known
    /// before.
    #[must_use]
    pub fn first_sweep_s(&self, agent: usize) -> Option<f64> {
        if !self.is_uav(agent) {
            return None;
        }
        let epoch_s = self.parameters.epoch_s;
        let goals = self.goals(agent);
        let from = std::iter::once(&self.starts_m[agent]).chain(&goals);
        let legs = from.zip(&goals).filter_map(|(&from, &to)| {
            UavLeg::between(from, to, &self.parameters.flight.limits, epoch_s)
        });
        let epochs: usize = legs.map(|leg| leg.epochs()).sum();
        Some(number(epochs) * epoch_s)
    }

    /// The least distance that programs of robots keep, m.
    #[must_use]
    pub fn separation_m(&self) -> f64 {
        let planner = &self.parameters.planner;
        2.0 * planner.radius_m + planner.margin_m - 0.05
    }

    /// What is allowed but may not be meant.
    #[must_use]
    pub fn cautions(&self) -> Vec<MissionCaution> {
        let (search, vision) = (&self.parameters.search, &self.parameters.vision);
        let walking = self.parameters.behaviour.walking;
        let walking_m = self.parameters.behaviour.library.advance_m(walking);
        let lanes = [
            (
                "search.lane_m.uav",
                search.uav_lane_m,
                &vision.uav,
                self.parameters.flight.limits.speed_m_s,
            ),
            (
                "search.lane_m.robot",
                search.robot_lane_m,
                &vision.robot,
                walking_m / self.parameters.epoch_s,
            ),
        ];
        let gaps = lanes
            .into_iter()
            .filter(|(_, lane_m, sensor, _)| *lane_m > 2.0 * sensor.range_m);
        let gaps = gaps.map(|(key, lane_m, sensor, speed_m_s)| MissionCaution::Gaps {
            key,
            lane_m,
            range_m: sensor.range_m,
            probability: lanes_probability(sensor, speed_m_s, lane_m),
        });
        let clearance_m = self.parameters.planner.clearance_m();
        let wide = self.world.components(clearance_m);
        let narrow = self.robots().filter_map(|agent| {
            let goals = self.goals(agent);
            let raster = self.world.raster();
            let start = raster.cell(self.starts_m[agent]);
            // A goal too near an obstacle is moved: only those with room of their own are counted.
            let has_room = |goal: &&Point| self.world.clear_m(**goal, &[]) >= clearance_m;
            let cut_off = |goal: &&Point| !wide.connect(start, raster.cell(**goal));
            let cut_off = goals.iter().filter(has_room).filter(cut_off).count();
            (cut_off > 0).then(|| MissionCaution::NarrowPassages {
                agent: self.name(agent),
                goals: cut_off,
                all: goals.len(),
                clearance_m,
            })
        });
        gaps.chain(narrow).collect()
    }

    fn robots(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.agents()).filter(|&agent| !self.is_uav(agent))
    }

    fn check_places(&self) -> Result<(), MissionError> {
        let needed_m = self.parameters.planner.radius_m;
        for agent in self.robots() {
            let (agent, place_m, goals) =
                (self.name(agent), self.starts_m[agent], self.goals(agent));
            let clear_m = self.world.clear_m(place_m, &[]);
            if clear_m < needed_m {
                return Err(MissionError::StartBlocked {
                    agent,
                    place_m,
                    clear_m,
                    needed_m,
                });
            }
            if !goals.iter().any(|&goal| self.world.joined(place_m, goal)) {
                return Err(MissionError::StartCutOff { agent, place_m });
            }
        }
        if let Targets::Fixed(points) = &self.parameters.targets {
            let blocked = |point: &Point| self.world.clear_m(*point, &[]) < 0.0;
            if let Some(index) = points.iter().position(blocked) {
                return Err(MissionError::TargetBlocked {
                    target: index + 1,
                    place_m: points[index],
                });
            }
        }
        Ok(())
    }
}
