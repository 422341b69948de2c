//! Which parameters make a mission in a world.

use self::Limit::{AtLeast, AtMost, NotNegative, Positive};
use crate::mission::error::MissionError;
use crate::mission::parameters::{MOST, Parameters, Range, Targets, Vision, WholeRange};
use crate::mission::plane::number;
use crate::mission::world::World;

/// The longest epoch, s.
const LONGEST_EPOCH_S: f64 = 10.0;
/// Farther apart, points of a way cut its corners, m.
const LARGEST_SPACING_M: f64 = 5.0;
/// A range below so many cells says more of the map's cells than of the world.
const RANGE_CELLS: f64 = 4.0;

const IN_SECONDS: &str = "give a time in s";
const IN_METRES: &str = "give a length in m";
const IN_CELLS: &str = "give more metres, or the map smaller cells";
const WHOLE: &str = "give a whole number";

/// A key, its value, what the value must be, and what to do.
type Checked = (&'static str, f64, Limit, &'static str);

/// Refuses parameters out of their limits, and those that contradict each other or the map.
pub(crate) fn check(world: &World, parameters: &Parameters) -> Result<(), MissionError> {
    check_teams(world, parameters)?;
    check_ranges(parameters)?;
    let least_range = AtLeast(RANGE_CELLS * world.raster().resolution_m());
    let numbers = searching(parameters)
        .into_iter()
        .chain(seeing(parameters, least_range))
        .chain(planning(parameters, least_range))
        .chain(counts(parameters));
    for (key, value, limit, remedy) in numbers {
        if !limit.holds(value) {
            return Err(MissionError::Number {
                key,
                value,
                limit: limit.said(),
                remedy,
            });
        }
    }
    check_gaits(world, parameters)
}

fn check_gaits(world: &World, parameters: &Parameters) -> Result<(), MissionError> {
    let behaviour = &parameters.behaviour;
    let gaits = behaviour.library.gaits.len();
    let named = behaviour.of_class.iter().chain([&behaviour.walking]);
    if let Some(&behaviour) = named.clone().find(|&&behaviour| behaviour >= gaits) {
        return Err(MissionError::UnknownBehaviour { behaviour, gaits });
    }
    let without = |class: &&u8| usize::from(**class) >= behaviour.of_class.len();
    match world.terrain().iter().find(without) {
        Some(&class) => Err(MissionError::ClassWithoutBehaviour { class }),
        None => Ok(()),
    }
}

/// What a number must be.
#[derive(Clone, Copy)]
enum Limit {
    Positive,
    NotNegative,
    AtLeast(f64),
    AtMost(f64),
}

impl Limit {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::AtLeast(least) => value >= least,
                Self::AtMost(most) => value > 0.0 && value <= most,
            }
    }

    fn said(self) -> String {
        match self {
            Self::Positive => "must be above 0".into(),
            Self::NotNegative => "must not be negative".into(),
            Self::AtLeast(least) => format!("must be at least {least}"),
            Self::AtMost(most) => format!("must be above 0 and at most {most}"),
        }
    }
}

/// Times, lanes and flight.
fn searching(p: &Parameters) -> Vec<Checked> {
    let limits = &p.flight.limits;
    let lasting = [p.endurance.uav_s, p.endurance.robot_s];
    let lasting = lasting.map(|range| range.map_or(1.0, |range| range.lower));
    let epochs = f64::from(p.epochs);
    let heartbeat = f64::from(p.heartbeat_epochs);
    let one_epoch = "give at least one epoch";
    let acceleration = "give an acceleration in m/s^2";
    vec![
        ("epoch_s", p.epoch_s, AtMost(LONGEST_EPOCH_S), IN_SECONDS),
        ("time.duration_s", epochs, AtLeast(1.0), one_epoch),
        (
            "search.lane_m.uav",
            p.search.uav_lane_m,
            Positive,
            IN_METRES,
        ),
        (
            "search.lane_m.robot",
            p.search.robot_lane_m,
            Positive,
            IN_METRES,
        ),
        (
            "flight.speed_m_s",
            limits.speed_m_s,
            Positive,
            "give a speed in m/s",
        ),
        (
            "flight.acceleration_m_s2",
            limits.acceleration_m_s2,
            Positive,
            acceleration,
        ),
        (
            "flight.altitude_m",
            p.flight.altitude_m,
            NotNegative,
            IN_METRES,
        ),
        (
            "flight.altitude_step_m",
            p.flight.altitude_step_m,
            NotNegative,
            IN_METRES,
        ),
        (
            "ground_station.heartbeat_s",
            heartbeat,
            AtLeast(1.0),
            one_epoch,
        ),
        ("endurance_s.uav", lasting[0], Positive, IN_SECONDS),
        ("endurance_s.robot", lasting[1], Positive, IN_SECONDS),
    ]
}

/// Sensors.
fn seeing(p: &Parameters, range: Limit) -> Vec<Checked> {
    let Vision {
        uav,
        robot,
        sense_obstacles_m,
    } = p.vision;
    let rate = "give finds per second";
    vec![
        ("vision.uav.range_m", uav.range_m, range, IN_CELLS),
        ("vision.robot.range_m", robot.range_m, range, IN_CELLS),
        ("vision.uav.rate_per_s", uav.rate_per_s, Positive, rate),
        ("vision.robot.rate_per_s", robot.rate_per_s, Positive, rate),
        (
            "vision.sense_obstacles_m",
            sense_obstacles_m,
            NotNegative,
            IN_METRES,
        ),
    ]
}

/// Ways and rescues.
fn planning(p: &Parameters, range: Limit) -> Vec<Checked> {
    let planner = &p.planner;
    let spacing = AtMost(LARGEST_SPACING_M);
    vec![
        ("rescue.reach_m", p.rescue.reach_m, NotNegative, IN_METRES),
        (
            "obstacles.keep_clear_m",
            p.obstacles.keep_clear_m,
            NotNegative,
            IN_METRES,
        ),
        ("planner.radius_m", planner.radius_m, Positive, IN_METRES),
        ("planner.margin_m", planner.margin_m, NotNegative, IN_METRES),
        ("planner.range_m", planner.range_m, range, IN_CELLS),
        ("planner.spacing_m", planner.spacing_m, spacing, IN_METRES),
        (
            "behaviour.min_segment_m",
            p.behaviour.min_segment_m,
            NotNegative,
            IN_METRES,
        ),
    ]
}

/// Numbers of things that there may be none of.
fn counts(p: &Parameters) -> Vec<Checked> {
    let mut counts = Vec::new();
    if p.rescue.robots > 0 {
        let robots = p.teams.iter().map(|team| team.robots()).sum();
        let fewer = "send no more robots to a target than there are";
        let sent = f64::from(p.rescue.robots);
        counts.push(("rescue.robots", sent, AtMost(number(robots)), fewer));
    }
    let most = AtMost(number(MOST));
    match &p.targets {
        Targets::Fixed(points) => {
            counts.push(("targets.points_m", number(points.len()), most, WHOLE));
        }
        Targets::Random { count, clear_m } => {
            counts.push(("targets.count", f64::from(count.most), most, WHOLE));
            counts.push(("targets.clear_m", *clear_m, NotNegative, IN_METRES));
        }
    }
    if p.obstacles.count.most > 0 {
        let radius_m = p.obstacles.radius_m.lower;
        counts.push((
            "obstacles.count",
            f64::from(p.obstacles.count.most),
            most,
            WHOLE,
        ));
        counts.push(("obstacles.radius_m", radius_m, Positive, IN_METRES));
    }
    counts
}

fn check_teams(world: &World, parameters: &Parameters) -> Result<(), MissionError> {
    let first = parameters.teams.first().map_or(0, |team| team.robots());
    let agents: usize = parameters
        .teams
        .iter()
        .map(|team| team.starts_m.len())
        .sum();
    if !(1..=MOST).contains(&agents) {
        return Err(MissionError::Number {
            key: "teams and robots",
            value: number(agents),
            limit: format!("a mission has 1 to {MOST} agents"),
            remedy: "give fewer teams or robots, or at least one team",
        });
    }
    for (index, team) in parameters.teams.iter().enumerate() {
        if team.starts_m.len() != first + 1 {
            return Err(MissionError::UnequalTeams {
                team: index + 1,
                robots: team.robots(),
                first,
            });
        }
        let map = world.area();
        let corners = [team.area.lower_m, team.area.upper_m];
        let size = team.area.size_m();
        if !(size[0] > 0.0 && size[1] > 0.0 && corners.iter().all(|&corner| map.contains(corner))) {
            return Err(MissionError::AreaOutside { team: index + 1 });
        }
    }
    Ok(())
}

fn check_ranges(parameters: &Parameters) -> Result<(), MissionError> {
    let endurance = &parameters.endurance;
    let real = [
        ("endurance_s.uav", endurance.uav_s),
        ("endurance_s.robot", endurance.robot_s),
        ("obstacles.radius_m", Some(parameters.obstacles.radius_m)),
    ];
    let whole = |count: WholeRange| Range {
        lower: f64::from(count.least),
        upper: f64::from(count.most),
    };
    let targets = match &parameters.targets {
        Targets::Fixed(_) => None,
        Targets::Random { count, .. } => Some(whole(*count)),
    };
    let counts = [
        ("targets.count", targets),
        ("obstacles.count", Some(whole(parameters.obstacles.count))),
    ];
    for (key, range) in real.into_iter().chain(counts) {
        let Some(Range { lower, upper }) = range else {
            continue;
        };
        if !(lower <= upper && lower.is_finite() && upper.is_finite()) {
            return Err(MissionError::Number {
                key,
                value: upper,
                limit: format!(
                    "the upper end of a range is finite and at least the lower one, {lower}"
                ),
                remedy: "give the smaller number first",
            });
        }
    }
    Ok(())
}
