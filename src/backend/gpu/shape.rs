//! What the shader of a group of channels depends on, and what follows from it in counts.

use super::signals::Lists;
use crate::model::agent::Coupling;
use crate::model::controller::observer_feedback::FTC_STATES;
use crate::model::plant::kinds::PlantKind;

/// What the text of a group's shader depends on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) plant: PlantKind,
    /// Constants of the plant's own, name and value: how the joints of a leg lie to each other.
    pub(crate) plant_constants: Vec<(String, u32)>,
    /// Whether limits cut the commands of a leg.
    pub(crate) cut: bool,
    /// Channels of the group.
    pub(crate) channels: usize,
    /// Rows of each channel in the reference table.
    pub(crate) rows: usize,
    /// Agents of an episode.
    pub(crate) team: usize,
    /// The number in the campaign of the first of them.
    pub(crate) first_agent: usize,
    /// Episodes of a workgroup.
    pub(crate) lanes: usize,
    /// Whether the controller is a fault-tolerant one.
    pub(crate) ftc: bool,
    /// How the agents act on each other.
    pub(crate) coupling: Coupling,
    /// Whether the first output is the integral of what is measured.
    pub(crate) measured_integral: bool,
    /// Whether the observers start from what is measured.
    pub(crate) observer_measured: bool,
    /// Whether the device has 64-bit integers.
    pub(crate) int64: bool,
    /// Its signals.
    pub(crate) lists: Lists,
}

impl Shape {
    /// Invocations of a workgroup.
    pub(crate) fn workgroup(&self) -> usize {
        self.channels * self.team * self.lanes
    }

    /// Rows of the reference table that belong to one instant.
    pub(crate) fn table_rows(&self) -> usize {
        self.team * self.channels * self.rows
    }

    /// States of a channel: those of the largest controller, and its plant's.
    pub(crate) fn states(&self) -> usize {
        FTC_STATES + self.extra_states()
    }

    /// States that a channel has of its plant: under thrust, the command filter's angle and rate.
    pub(crate) fn extra_states(&self) -> usize {
        self.plant.spec().own_states
    }

    /// Whether the commands have limits, whose excess is counted.
    pub(crate) fn limited(&self) -> bool {
        self.plant.spec().limited
    }

    /// Kinds of channels, each with gains of its own.
    pub(crate) fn kinds(&self) -> usize {
        self.plant.spec().kinds
    }

    /// Numbers that a channel shows to others.
    pub(crate) fn shared(&self) -> usize {
        // Under thrust, dead zones are shown too.
        let dead_zones = self.plant == PlantKind::Thrust && self.lists.count("dead_zones") > 0;
        self.plant.spec().shared + usize::from(dead_zones)
    }

    /// Numbers per invocation in workgroup memory; [`shaders/team.wgsl`] says why twice.
    pub(crate) fn published(&self) -> usize {
        2 * self.shared() + usize::from(self.leaks())
    }

    /// Bytes of workgroup memory.
    pub(crate) fn shared_bytes(&self) -> usize {
        4 * self.published() * self.workgroup()
    }

    /// Whether commands leak from agent to agent.
    pub(crate) fn leaks(&self) -> bool {
        self.lists.leaks()
    }

    /// The place of an agent's channel in a workgroup.
    pub(crate) fn place(&self, channel: usize, agent: usize, lane: usize) -> usize {
        (channel * self.team + agent) * self.lanes + lane
    }
}
