//! What is drawn for one episode of a mission; every controller meets the same.

use crate::mission::error::MissionError;
use crate::mission::logarithm::natural_logarithm;
use crate::mission::parameters::{MOST, Obstacles, Range, Targets, WholeRange};
use crate::mission::plane::{Disc, Point, count, distance};
use crate::mission::scenario::Scenario;
use crate::random::philox::{Address, Stream};

/// Places that are tried for one target or obstacle.
const TRIES: u32 = 1000;

/// The random quantities of one episode.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionDraws {
    /// The campaign's seed; the planner's numbers come from it, too.
    pub seed: u64,
    /// The episode.
    pub episode: u32,
    /// Where the targets are, m.
    pub targets_m: Vec<Point>,
    /// Obstacles that nobody knows at first.
    pub obstacles: Vec<Disc>,
    /// By agent and target: the exposure at which the agent finds the target, without unit.
    pub thresholds: Vec<Vec<f64>>,
    /// By agent: until when it lasts, s.
    pub endurance_s: Vec<f64>,
}

/// What a number of the stream is for; the entries never change.
#[derive(Clone, Copy)]
#[repr(u32)]
enum Entry {
    /// Member target; indices 2k and 2k + 1 of try k.
    Target = 0,
    ObstacleCount = 1,
    /// Member obstacle; index 0 radius, 1 + 2k and 2 + 2k of try k.
    Obstacle = 2,
    /// Member agent · 64 + target.
    Threshold = 3,
    /// Member agent.
    Endurance = 4,
    TargetCount = 5,
}

/// The numbers of the stream of one episode.
#[derive(Clone, Copy)]
struct Numbers {
    seed: u64,
    episode: u32,
}

impl MissionDraws {
    /// The draws of an episode.
    ///
    /// # Errors
    /// If a target or an obstacle finds no place in 1000 tries.
    pub fn of_episode(scenario: &Scenario, seed: u64, episode: u32) -> Result<Self, MissionError> {
        let numbers = Numbers { seed, episode };
        let targets_m = targets(scenario, numbers)?;
        let obstacles = obstacles(scenario, numbers, &targets_m)?;
        let agents = 0..scenario.agents();
        let threshold = |agent: usize, target: usize| {
            let member = member(agent * MOST + target);
            -natural_logarithm(numbers.unit(Entry::Threshold, member, 0))
        };
        let of_agent = |agent: usize| (0..targets_m.len()).map(move |t| threshold(agent, t));
        let endurance = &scenario.parameters().endurance;
        let lasting = |agent: usize| {
            let range = if scenario.is_uav(agent) {
                endurance.uav_s
            } else {
                endurance.robot_s
            };
            let unit = numbers.unit(Entry::Endurance, member(agent), 0);
            range.map_or(f64::INFINITY, |range| uniform(range, unit))
        };
        Ok(Self {
            seed,
            episode,
            thresholds: agents
                .clone()
                .map(|agent| of_agent(agent).collect())
                .collect(),
            endurance_s: agents.map(lasting).collect(),
            obstacles,
            targets_m,
        })
    }
}

impl MissionDraws {
    /// The exposure at which an agent finds a target; infinite where none is drawn.
    #[must_use]
    pub fn threshold(&self, agent: usize, target: usize) -> f64 {
        let of_agent = self.thresholds.get(agent);
        let threshold = of_agent.and_then(|thresholds| thresholds.get(target));
        threshold.copied().unwrap_or(f64::INFINITY)
    }

    /// Until when an agent lasts, s; infinite where that is not drawn.
    #[must_use]
    pub fn lasts_s(&self, agent: usize) -> f64 {
        self.endurance_s
            .get(agent)
            .copied()
            .unwrap_or(f64::INFINITY)
    }
}

impl Numbers {
    fn unit(self, entry: Entry, member: u32, index: u32) -> f64 {
        let address = Address {
            episode: self.episode,
            stream: Stream::Mission,
            entry: entry as u32,
            member,
            index,
        };
        address.unit(self.seed)
    }
}

fn targets(scenario: &Scenario, numbers: Numbers) -> Result<Vec<Point>, MissionError> {
    let (range, clear_m) = match &scenario.parameters().targets {
        Targets::Fixed(points) => return Ok(points.clone()),
        Targets::Random { count, clear_m } => (*count, *clear_m),
    };
    let world = scenario.world();
    let count = whole(range, numbers.unit(Entry::TargetCount, 0, 0));
    let target = |target: u32| {
        let place = |k: u32| {
            let unit = |index: u32| numbers.unit(Entry::Target, target, index);
            world.area().at([unit(2 * k), unit(2 * k + 1)])
        };
        let mut tries = (0..TRIES).map(place);
        let found = tries.find(|&place| world.clear_m(place, &[]) >= clear_m);
        found.ok_or(MissionError::NoPlace {
            what: "target",
            index: index(target) + 1,
            episode: numbers.episode,
            tries: TRIES,
            keys: "targets.count, targets.clear_m",
        })
    };
    (0..count).map(target).collect()
}

fn obstacles(
    scenario: &Scenario,
    numbers: Numbers,
    targets_m: &[Point],
) -> Result<Vec<Disc>, MissionError> {
    let Obstacles {
        count,
        radius_m,
        keep_clear_m,
    } = scenario.parameters().obstacles;
    let world = scenario.world();
    let count = whole(count, numbers.unit(Entry::ObstacleCount, 0, 0));
    let kept = || scenario.starts_m().iter().chain(targets_m);
    let obstacle = |obstacle: u32| {
        let unit = |index: u32| numbers.unit(Entry::Obstacle, obstacle, index);
        let radius_m = uniform(radius_m, unit(0));
        let place = |k: u32| world.area().at([unit(1 + 2 * k), unit(2 + 2 * k)]);
        let fits = |place: &Point| {
            let apart = |other: &Point| distance(*place, *other) >= radius_m + keep_clear_m;
            world.clear_m(*place, &[]) >= 0.0 && kept().all(apart)
        };
        let centre_m = (0..TRIES).map(place).find(fits);
        let disc = centre_m.map(|centre_m| Disc { centre_m, radius_m });
        disc.ok_or(MissionError::NoPlace {
            what: "obstacle",
            index: index(obstacle) + 1,
            episode: numbers.episode,
            tries: TRIES,
            keys: "obstacles.count, obstacles.radius_m, obstacles.keep_clear_m",
        })
    };
    (0..count).map(obstacle).collect()
}

/// The whole number of a range that a number in (0, 1) stands for.
fn whole(range: WholeRange, unit: f64) -> u32 {
    let values = f64::from(range.most.saturating_sub(range.least)) + 1.0;
    let above = u32::try_from(count(unit * values)).unwrap_or(0);
    range.least.saturating_add(above).min(range.most)
}

fn uniform(range: Range, unit: f64) -> f64 {
    range.lower + unit * (range.upper - range.lower)
}

fn member(member: usize) -> u32 {
    u32::try_from(member).unwrap_or(u32::MAX)
}

fn index(number: u32) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}
