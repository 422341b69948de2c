//! What all agents of a campaign have in common: its episodes, its controllers and its plan.

use super::overlay::Setting;
use super::plan::{Detail, Sampling, Stop, Strata};
use super::requirement::Requirement;
use super::time::Time;
use std::path::PathBuf;

/// Name of the paper's fault-tolerant controller.
pub const FTC: &str = "ftc";
/// Name of the PID computed-torque controller, the paper's text read plainly.
pub const PID: &str = "pid";
/// Name of the PID with the same feedback whose observer distrusts the faulty velocity channel.
pub const PID_ROBUST_OBSERVER: &str = "pid-robust-observer";
/// Name of the PID with a triple pole.
pub const PID_PLACED: &str = "pid-placed";
/// Name of the PID that a search found for the preset's campaign.
pub const PID_TUNED: &str = "pid-tuned";
/// Name of the fault-tolerant controller that the same search found.
pub const FTC_TUNED: &str = "ftc-tuned";

/// The controllers that need no file.
pub const BUILT_IN: [&str; 6] = [
    FTC,
    FTC_TUNED,
    PID,
    PID_PLACED,
    PID_TUNED,
    PID_ROBUST_OBSERVER,
];
/// Those among them whose gains are made of the campaign's weights.
pub const SYNTHESIZED: [&str; 3] = [FTC, PID, PID_ROBUST_OBSERVER];
/// Those that a campaign compares if it names none.
pub const COMPARED: [&str; 3] = [FTC, PID, PID_TUNED];

/// What all agents of a campaign have in common.
#[derive(Debug, Clone)]
pub struct Common {
    /// The file, as it was named on the command line.
    pub path: PathBuf,
    /// The file's text.
    pub text: String,
    /// The settings laid over it with `--set`, in their order.
    pub overlay: Vec<Setting>,
    /// Name.
    pub name: String,
    /// What is tested and why, in one line; empty if the file does not say.
    pub description: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Number of episodes, at least 1.
    pub episodes: u32,
    /// The number of episodes that was given in the place of the file's, if one was: errors name it so.
    pub episodes_given: Option<u32>,
    /// Names of the controllers, all different, at least one.
    pub controllers: Vec<String>,
    /// Duration and step.
    pub time: Time,
    /// Parts of the episodes with faults of their own.
    pub strata: Strata,
    /// How the random numbers of the episodes are chosen.
    pub sampling: Sampling,
    /// When the run may end early, if it may.
    pub stop: Option<Stop>,
    /// Which of the tables that grow with the episodes are written.
    pub detail: Detail,
    /// Conditions on the result.
    pub requirements: Vec<Requirement>,
}
