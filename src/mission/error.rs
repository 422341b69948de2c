//! What can be wrong with a mission.

use crate::mission::plane::Point;
use thiserror::Error;

/// A mission that cannot be started, and why. Numbers of teams, agents and targets count from one.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MissionError {
    /// A number breaks a limit.
    #[error("{key} = {value}: {limit}; {remedy}")]
    Number {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// The limit.
        limit: String,
        /// What to write instead.
        remedy: &'static str,
    },
    /// Teams are not alike.
    #[error(
        "team {team} has {robots} robots and the first one {first}; teams are of one size, give each one start for its \
         UAV and one for every robot"
    )]
    UnequalTeams {
        /// The team.
        team: usize,
        /// Its robots.
        robots: usize,
        /// Those of the first team.
        first: usize,
    },
    /// An area does not lie on the map.
    #[error(
        "area.rectangles_m of team {team} does not lie on the map; give corners of the map or inside it"
    )]
    AreaOutside {
        /// The team.
        team: usize,
    },
    /// An agent starts in an obstacle.
    #[error(
        "agent {agent} starts at {place_m:?}, {clear_m:.2} m from obstacles of the map, and needs {needed_m} m; move its \
         start"
    )]
    StartBlocked {
        /// The agent.
        agent: String,
        /// Its start, m.
        place_m: Point,
        /// How far from obstacles it is, m.
        clear_m: f64,
        /// How far it must be, m.
        needed_m: f64,
    },
    /// No way leads from a start to what is to be searched.
    #[error(
        "no free cells join the start {place_m:?} of agent {agent} to any goal of its strip; move the start or open the \
         map"
    )]
    StartCutOff {
        /// The agent.
        agent: String,
        /// Its start, m.
        place_m: Point,
    },
    /// A target lies in an obstacle or outside.
    #[error(
        "targets.points_m: target {target} at {place_m:?} is outside of the map or in an obstacle; move it to free ground"
    )]
    TargetBlocked {
        /// The target.
        target: usize,
        /// Where it is, m.
        place_m: Point,
    },
    /// A class of terrain has no behaviour.
    #[error(
        "terrain class {class} occurs on the map and has no behaviour; name one of the gaits for it under \
         behaviour.of_class"
    )]
    ClassWithoutBehaviour {
        /// The class.
        class: u8,
    },
    /// A behaviour is none of the gaits.
    #[error("behaviour {behaviour} is none of the {gaits} gaits; name one that has pages")]
    UnknownBehaviour {
        /// The behaviour.
        behaviour: usize,
        /// How many gaits there are.
        gaits: usize,
    },
    /// Nothing more fits on the map.
    #[error(
        "{what} {index} of episode {episode} found no place in {tries} tries; give fewer or smaller ones, or less to keep \
         clear of ({keys})"
    )]
    NoPlace {
        /// What did not fit.
        what: &'static str,
        /// Which of them.
        index: usize,
        /// The episode.
        episode: u32,
        /// Tries.
        tries: u32,
        /// The keys that decide.
        keys: &'static str,
    },
}

/// What a reader of a mission should know.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MissionCaution {
    /// Lanes are so far apart that targets between them are never in range.
    #[error(
        "{key} = {lane_m} m is more than twice the range of {range_m} m: one sweep finds a target with probability \
         {probability:.2}"
    )]
    Gaps {
        /// The key.
        key: &'static str,
        /// The spacing, m.
        lane_m: f64,
        /// The sensor's range, m.
        range_m: f64,
        /// Probability that one sweep finds a target.
        probability: f64,
    },
    /// A goal can only be reached through passages that are too narrow.
    #[error(
        "{goals} of {all} goals of agent {agent} cannot be reached with {clearance_m} m to either side \
         (planner.radius_m + planner.margin_m)"
    )]
    NarrowPassages {
        /// The agent.
        agent: String,
        /// Goals that cannot be reached.
        goals: usize,
        /// Goals of its strip.
        all: usize,
        /// What a way keeps clear, m.
        clearance_m: f64,
    },
}
