//! Missions: teams of one UAV and some robots search an area for targets and rescue what they find.
//!
//! This is the decision layer of the paper's pipeline (Fig. 1): task allocation, global path planning, behaviour
//! decision and local references; the loops that track the references are elsewhere. Decisions are made at the
//! beginning of each epoch for the epoch after it, and see two things of the true motion: where agents are and who is
//! lost.
//!
//! ```text
//! world, parameters -> scenario -> draws -> mission: observe, sense, retire, avoid, allocate, next goal, advance
//! ```
//!
//! 1. *World*: an occupancy grid with its distance field and terrain.
//! 2. *Scenario*: a world and parameters that fit together; all episodes share it.
//! 3. *Draws*: targets, obstacles, thresholds of detection, endurance of one episode.
//! 4. *Mission*: [`Mission::decide`] takes places and losses, and gives every agent a [`Motion`] for one epoch.
//! 5. *Outcome*: times, counts and the log of events.
//!
//! Everything is a pure function in double precision of (scenario, draws, what was observed): no clock, no threads, no
//! order of a hash table, and no function of the standard library whose digits differ between machines.

pub mod assignment;
pub mod behaviour;
mod check;
pub mod collisions;
mod coverage;
mod decide;
mod draws;
mod error;
mod events;
mod ideal;
mod lanes;
mod logarithm;
mod motion;
mod observed;
mod outcome;
pub mod pages;
pub mod parameters;
pub mod plane;
pub mod planner;
mod program;
pub mod quintic;
mod scenario;
mod state;
mod tasks;
pub mod travel_time;
pub mod uav_leg;
pub mod vision;
pub mod world;

pub use draws::MissionDraws;
pub use error::{MissionCaution, MissionError};
pub use events::{Event, EventKind, Subject};
pub use ideal::{ideal, ideal_watched};
pub use lanes::{lanes, starts_below};
pub use motion::{Activity, Motion};
pub use observed::Observed;
pub use outcome::{Collisions, Outcome, Tally};
pub use parameters::Parameters;
pub use scenario::Scenario;
pub use state::Mission;
