//! The references of a team: one of the forms, for every agent.

use super::path::WaypointPath;
use super::point::ReferencePoint;
use super::sinusoid::Sinusoid;
use super::walk::{self, Walk};
use crate::agent::robot::{JOINTS, Robot};
use crate::agent::{FIRST_ATTITUDE, UAV_CHANNELS};
use std::sync::Arc;

/// The references of a team.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// A sinusoid per agent and channel.
    Sinusoid(Vec<Vec<Sinusoid>>),
    /// A UAV's path per agent; the attitude is level and the yaw zero.
    Waypoints(Vec<WaypointPath>),
    /// A robot's walk per agent.
    Walk(Vec<AgentWalk>),
}

/// A walk and when it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentWalk {
    /// The walk; robots that go the same way share it.
    pub walk: Arc<Walk>,
    /// The time of the walk's beginning, s. Before it the robot stands, as after its end; a robot that began before 0
    /// is on its way.
    pub start_s: f64,
}

impl Reference {
    /// The reference of all channels of an agent at time `t_s`.
    #[must_use]
    pub fn at(&self, agent: usize, t_s: f64) -> Vec<ReferencePoint> {
        match self {
            Self::Sinusoid(agents) => {
                let channels = agents[agent].iter();
                channels.map(|sinusoid| sinusoid.at(t_s)).collect()
            }
            Self::Waypoints(paths) => {
                let point = paths[agent].at(t_s);
                let channel = |channel: usize| {
                    if channel < FIRST_ATTITUDE {
                        ReferencePoint {
                            value: point.position[channel],
                            rate: point.velocity[channel],
                            acceleration: point.acceleration[channel],
                        }
                    } else {
                        ReferencePoint::default()
                    }
                };
                (0..UAV_CHANNELS.len()).map(channel).collect()
            }
            Self::Walk(walks) => {
                let AgentWalk { walk, start_s } = &walks[agent];
                walk.at(t_s - start_s).to_vec()
            }
        }
    }

    /// The torques J'f, N m, with which the ground answers an agent's walk at time `t_s`; none where nobody walks.
    #[must_use]
    pub fn ground_reaction(&self, robot: &Robot, agent: usize, t_s: f64) -> [f64; JOINTS] {
        match self {
            Self::Walk(walks) => {
                let AgentWalk { walk, start_s } = &walks[agent];
                walk::ground_reaction(walk, robot, t_s - start_s).torque_n_m
            }
            Self::Sinusoid(_) | Self::Waypoints(_) => [0.0; JOINTS],
        }
    }
}
