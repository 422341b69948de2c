//! Where the agents are to go: r(t), r'(t) and r''(t) of every agent and channel.

pub mod path;
pub mod walk;

pub use path::WaypointPath;

use crate::campaign::FIRST_ATTITUDE;

/// The references of a team.
#[derive(Debug, Clone)]
pub enum Reference {
    /// A sinusoid per agent and channel.
    Sinusoid(Vec<[Sinusoid; 6]>),
    /// A path per agent; the attitude is level and the yaw zero.
    Waypoints(Vec<WaypointPath>),
}

/// r(t) = center + amplitude sin(frequency t + phase), in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Mean.
    pub center: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Phase at t = 0, rad.
    pub phase_rad: f64,
}

/// A reference and its derivatives at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReferencePoint {
    /// r, m or rad.
    pub value: f64,
    /// r', 1/s.
    pub rate: f64,
    /// r'', 1/s^2.
    pub acceleration: f64,
}

impl Reference {
    /// The reference of all channels of an agent at time `t_s`.
    #[must_use]
    pub fn at(&self, agent: usize, t_s: f64) -> [ReferencePoint; 6] {
        match self {
            Self::Sinusoid(agents) => agents[agent].map(|sinusoid| sinusoid.at(t_s)),
            Self::Waypoints(paths) => {
                let point = paths[agent].at(t_s);
                std::array::from_fn(|channel| {
                    if channel < FIRST_ATTITUDE {
                        ReferencePoint {
                            value: point.position[channel],
                            rate: point.velocity[channel],
                            acceleration: point.acceleration[channel],
                        }
                    } else {
                        ReferencePoint::default()
                    }
                })
            }
        }
    }
}

impl Sinusoid {
    /// The sinusoid at time `t_s`.
    #[must_use]
    pub fn at(&self, t_s: f64) -> ReferencePoint {
        let (sine, cosine) = (self.frequency_rad_s * t_s + self.phase_rad).sin_cos();
        let rate = self.amplitude * self.frequency_rad_s;
        ReferencePoint {
            value: self.center + self.amplitude * sine,
            rate: rate * cosine,
            acceleration: -rate * self.frequency_rad_s * sine,
        }
    }
}
