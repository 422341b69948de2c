//! How long a campaign would take, roughly.

use crate::agent::Agent;
use crate::campaign::{AgentGroup, Campaign};

/// Nanoseconds that a step of an agent takes a core with 16 lanes in single precision.
struct Cost {
    /// With neither disturbances nor faults.
    bare: f64,
    /// More for each disturbance and each fault: whether it is there is asked in every step.
    signal: f64,
}

/// Measured on a core of an AMD EPYC: UAVs with 1 to 4 disturbances and 0 to 34 faults, from 37 to 750 ns. What a
/// signal takes depends on its kind, and on how many of the lanes have it: that is within a factor of two of all of
/// these.
const UAV: Cost = Cost {
    bare: 22.0,
    signal: 12.0,
};
/// The same of robots with 2 and 33 signals: 190 to 290 ns and 1030 ns.
const BIPED: Cost = Cost {
    bare: 180.0,
    signal: 30.0,
};

/// Steps of single agents in a campaign.
pub(super) fn steps(campaign: &Campaign) -> f64 {
    campaign.groups().iter().map(steps_of).sum()
}

fn steps_of(group: &AgentGroup) -> f64 {
    let simulated = group.team * group.controllers.len();
    f64::from(group.time.steps) * f64::from(group.episodes) * simulated as f64
}

/// How long they take on one core with 16 lanes, s.
pub(super) fn seconds(campaign: &Campaign) -> f64 {
    let of_group = |group: &AgentGroup| {
        let cost = match group.agent {
            Agent::Uav(_) => UAV,
            Agent::Biped(_) => BIPED,
        };
        let signals = group.disturbances.len() + group.faults.len();
        1e-9 * steps_of(group) * (cost.bare + cost.signal * signals as f64)
    };
    campaign.groups().iter().map(of_group).sum()
}

/// Nanoseconds of a core for a byte of a large table, for its row to be made, packed, written and hashed: what
/// 1,000,000 episodes of uav-paper took longer in detail "all" than in "episodes".
const TABLE_BYTE: f64 = 75.0;

/// How long it takes to make large tables of so many bytes, on one core, s.
pub(super) fn table_seconds(bytes: u64) -> f64 {
    1e-9 * TABLE_BYTE * bytes as f64
}

/// A length of time in the unit that people would use.
pub(super) fn lasting(seconds: f64) -> String {
    const UNITS: [(f64, &str); 4] = [
        (86_400.0, "days"),
        (3_600.0, "hours"),
        (60.0, "minutes"),
        (1.0, "s"),
    ];
    // Two of a unit, so that there is no plural to ask for.
    let unit = UNITS.iter().find(|(unit, _)| seconds >= 2.0 * unit);
    match unit {
        Some((unit, name)) => format!("{:.0} {name}", seconds / unit),
        None => "1 s".to_string(),
    }
}
