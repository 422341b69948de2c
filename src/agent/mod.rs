//! The agents of a team as the controller models them, and their channels.

mod actuation;
pub mod robot;
mod role;

pub use actuation::ActuationKind;
pub use role::ChannelRole;

use nalgebra::Vector6;
use robot::dynamics::mass_matrix;
use robot::kinematics::by_leg;
use robot::{JOINTS, LEG_JOINTS, Leg, Robot};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Channels of a UAV, in the order of every table and list.
pub(crate) const UAV_CHANNELS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];
/// The channel of a UAV's height.
pub const HEIGHT: usize = 2;
/// The first attitude channel of a UAV.
pub const FIRST_ATTITUDE: usize = 3;

/// What every member of a team is.
#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one of it in a campaign"
)]
pub enum Agent {
    /// The quadrotor of (3).
    Uav(Uav),
    /// The biped of (4).
    Biped(Biped),
}

/// The UAV of (3) as the controller models it, with the limits of the `thrust` actuation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uav {
    /// What the command acts through: `Full` or `Thrust`.
    pub actuation: ActuationKind,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Principal inertias, kg m^2.
    pub inertia_kg_m2: [f64; 3],
    /// Translational damping, N s/m.
    pub drag_n_s_m: f64,
    /// Rotational damping, N m s.
    pub angular_drag_n_m_s: f64,
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// Bandwidth of the attitude command filter, rad/s.
    pub command_filter_rad_s: f64,
    /// Largest thrust, N.
    pub max_thrust_n: f64,
    /// Largest torque about each axis, N m.
    pub max_torque_n_m: f64,
    /// Largest commanded roll and pitch, rad.
    pub max_tilt_rad: f64,
}

/// The biped of (4): two legs of six joints on a pelvis that stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Biped {
    /// What the command acts through: `Full` or `Limited`.
    pub actuation: ActuationKind,
    /// The robot.
    pub robot: Robot,
    /// The file that it was read from.
    pub file: RobotFile,
}

/// A robot's file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotFile {
    /// Its path, which says whether it is a joint table or a URDF.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

/// Channels of one unit whose errors may be averaged and whose gains are the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelGroup {
    /// What they are.
    pub role: ChannelRole,
    /// Which of the agent's channels.
    pub channels: Range<usize>,
}

/// Channels that may share sensors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SensorGroup {
    /// Its name in campaign files.
    pub name: &'static str,
    /// Which of the agent's channels.
    pub channels: Range<usize>,
    /// Which of the agent's channel groups they belong to.
    pub place: usize,
}

impl Agent {
    /// What so many of them are called.
    #[must_use]
    pub fn noun(&self, count: usize) -> &'static str {
        match (self, count) {
            (Self::Uav(_), 1) => "UAV",
            (Self::Uav(_), _) => "UAVs",
            (Self::Biped(_), 1) => "robot",
            (Self::Biped(_), _) => "robots",
        }
    }

    /// What several of them are called.
    #[must_use]
    pub fn plural(&self) -> &'static str {
        self.noun(2)
    }

    /// What the command acts through.
    #[must_use]
    pub fn actuation(&self) -> ActuationKind {
        match self {
            Self::Uav(uav) => uav.actuation,
            Self::Biped(biped) => biped.actuation,
        }
    }

    /// The largest force or torque that the actuators can set against a disturbance, by channel, N or N m; infinite
    /// where nothing limits them. A UAV that tilts as far as it may pushes sideways with a part of its thrust, and
    /// upwards with what its weight leaves.
    #[must_use]
    pub fn reserves(&self) -> Vec<f64> {
        match self {
            Self::Uav(uav) if uav.actuation == ActuationKind::Thrust => {
                let sideways = uav.max_thrust_n * uav.max_tilt_rad.min(FRAC_PI_2).sin();
                let upwards = uav.max_thrust_n - uav.mass_kg * uav.gravity_m_s2;
                let position = [sideways, sideways, upwards];
                [position, [uav.max_torque_n_m; 3]].concat()
            }
            Self::Biped(biped) if biped.actuation == ActuationKind::Limited => {
                let joints = biped.robot.joints();
                joints.map(|joint| joint.torque_max_n_m).collect()
            }
            _ => vec![f64::INFINITY; self.channels().len()],
        }
    }

    /// The acceleration that a unit of force or torque gives each channel, 1/kg or 1/(kg m^2): of a robot that stands,
    /// the others of its joints being free.
    #[must_use]
    pub fn mobilities(&self) -> Vec<f64> {
        match self {
            Self::Uav(uav) => {
                let [x, y, z] = uav.inertia_kg_m2;
                [uav.mass_kg, uav.mass_kg, uav.mass_kg, x, y, z]
                    .map(f64::recip)
                    .to_vec()
            }
            Self::Biped(biped) => {
                let robot = &biped.robot;
                let legs = robot.legs.iter().zip(by_leg(&robot.standing_rad));
                let of_leg = |(leg, q_rad): (&Leg, Vector6<f64>)| {
                    let inverse = mass_matrix(leg, &q_rad).try_inverse().unwrap_or_default();
                    <[f64; LEG_JOINTS]>::from(inverse.diagonal())
                };
                legs.flat_map(of_leg).collect()
            }
        }
    }

    /// What was assumed or left out in reading a robot's file, a sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        match self {
            Self::Uav(_) => &[],
            Self::Biped(biped) => &biped.robot.notes,
        }
    }

    /// The file that it was read from, if there is one.
    #[must_use]
    pub fn file(&self) -> Option<&RobotFile> {
        match self {
            Self::Uav(_) => None,
            Self::Biped(biped) => Some(&biped.file),
        }
    }

    /// Names of the channels: axes and angles of a UAV, joints of a robot.
    pub(crate) fn channels(&self) -> Vec<Arc<str>> {
        match self {
            Self::Uav(_) => UAV_CHANNELS.map(Arc::from).to_vec(),
            Self::Biped(biped) => {
                let joints = biped.robot.joints();
                joints.map(|joint| Arc::from(joint.name.as_str())).collect()
            }
        }
    }

    /// The groups of channels, in their order.
    #[must_use]
    pub fn channel_groups(&self) -> Vec<ChannelGroup> {
        let group = |role, channels| ChannelGroup { role, channels };
        match self {
            Self::Uav(_) => vec![
                group(ChannelRole::Position, 0..FIRST_ATTITUDE),
                group(ChannelRole::Attitude, FIRST_ATTITUDE..UAV_CHANNELS.len()),
            ],
            Self::Biped(_) => vec![group(ChannelRole::Joints, 0..JOINTS)],
        }
    }

    /// The groups of channels that may share sensors: within one the plant and its kernels know all channels.
    #[must_use]
    pub fn sensor_groups(&self) -> Vec<SensorGroup> {
        let group = |name, channels, place| SensorGroup {
            name,
            channels,
            place,
        };
        match self {
            Self::Uav(_) => vec![
                group("position", 0..FIRST_ATTITUDE, 0),
                group("attitude", FIRST_ATTITUDE..UAV_CHANNELS.len(), 1),
            ],
            Self::Biped(_) => vec![
                group("left-leg", 0..LEG_JOINTS, 0),
                group("right-leg", LEG_JOINTS..JOINTS, 0),
            ],
        }
    }
}
