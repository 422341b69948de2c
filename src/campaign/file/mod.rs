//! The campaign file as it is written: one struct per TOML table, nothing checked but names and types.
//! [`super::Campaign`] is what the rest of the program sees.

mod campaign;
mod disturbances_and_faults;
mod parameters;
mod plan;
mod sensors;
mod tune;
mod value;

pub use campaign::{CampaignFile, GroupFile};
pub use disturbances_and_faults::*;
pub(super) use parameters::Parameters;
pub use plan::{
    DesignFile, OutputFile, RequireFile, SamplingFile, StopFile, StratumFaultsFile, StratumFile,
};
pub use sensors::{ChannelSensorsFile, SensorFile, SensorsFile};
pub use tune::{Texts, TuneFile};
pub(super) use value::in_toml;
pub use value::{
    ChannelsFile, DistributionFile, NormalFile, Numbers, TruncatedNormalFile, Value, WordOr,
};

use crate::agent::ActuationKind;
use crate::util::fixed_list::List;
use parameters::table_and_block;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use value::{some_table, some_tables, some_word, word};

/// `[time]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeFile {
    /// Length of an episode, s.
    pub duration_s: f64,
    /// Integration step, s.
    pub step_s: f64,
    /// Start of the metrics, s (default 0).
    pub settle_s: Option<f64>,
}

/// `[agent]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgentFile {
    /// The plant.
    #[serde(deserialize_with = "word")]
    pub kind: AgentKind,
    /// Agents in an episode, coupled through `[coupling]` (default 1).
    pub team: Option<u32>,
    /// What the command acts through (default "full").
    #[serde(default, deserialize_with = "some_word")]
    pub actuation: Option<ActuationKind>,
    /// Biped: a joint table (.toml) or a URDF; a relative path starts at the campaign file's folder (default: the
    /// Unitree G1).
    pub robot: Option<String>,
    /// URDF: the link that carries both legs (default: found in the tree).
    pub pelvis: Option<String>,
    /// URDF: the first joint of the left leg (default: the one at y > 0 of the pelvis).
    pub left_hip: Option<String>,
    /// URDF: the first joint of the right leg (default: the other one).
    pub right_hip: Option<String>,
    /// URDF: moving joints that are held at zero (default: all outside the legs).
    pub locked: Option<Vec<String>>,
    /// Inertia of each joint's rotor as seen from the joint, kg m^2: one for all, or a list, the left leg's first
    /// (default: that of the robot's file, else 0.01).
    pub armature_kg_m2: Option<Numbers>,
    /// Standing pose: the angles of the left leg's joints, then of the right one's, rad, or "bent", a pose that the
    /// program finds (default: that of a table; of a URDF zero, or the nearest angle that a joint can reach).
    pub standing: Option<WordOr<StandingFile, List<f64, 12>>>,
    /// URDF: two links whose frames are those of the left and right sole, z up, or "standing": the soles are level in
    /// the standing pose (default: that, where angles are given, else level at q = 0).
    pub sole: Option<WordOr<SoleFile, List<String, 2>>>,
    /// True mass over modelled mass (default 1); a biped's M and H as a whole.
    pub mass_scale: Option<Value>,
    /// True inertia over modelled inertia (default 1).
    pub inertia_scale: Option<Value>,
    /// Modelled mass, kg (default 2).
    pub mass_kg: Option<f64>,
    /// Modelled principal inertias, kg m^2 (default 1.25, 1.25, 2.2).
    pub inertia_kg_m2: Option<List<f64, 3>>,
    /// Translational damping, N s/m (default 0.01).
    pub drag_n_s_m: Option<f64>,
    /// Rotational damping, N m s (default 0.012).
    pub angular_drag_n_m_s: Option<f64>,
    /// Gravity, m/s^2 (default 9.81).
    pub gravity_m_s2: Option<f64>,
    /// Bandwidth of the attitude command filter, rad/s (default 20; thrust only).
    pub command_filter_rad_s: Option<f64>,
    /// Largest thrust, N (default 80; thrust only).
    pub max_thrust_n: Option<f64>,
    /// Largest torque about each axis, N m (default 60; thrust only).
    pub max_torque_n_m: Option<f64>,
    /// Largest commanded roll and pitch, rad (default 1; thrust only).
    pub max_tilt_rad: Option<f64>,
}

/// A standing pose by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StandingFile {
    /// Knees bent, feet level below the hips.
    Bent,
}

/// A way to find the soles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SoleFile {
    /// Level in the standing pose.
    Standing,
}

/// The plants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AgentKind {
    /// The quadrotor of (3).
    Uav,
    /// The biped of (4).
    Biped,
}

/// `[reference]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceFile {
    /// Form of the reference.
    #[serde(deserialize_with = "word")]
    pub kind: ReferenceKind,
    /// Sinusoid: mean, m or rad.
    pub center: Option<Numbers>,
    /// Sinusoid: amplitude, m or rad.
    pub amplitude: Option<Numbers>,
    /// Sinusoid: angular frequency, rad/s.
    pub frequency_rad_s: Option<Numbers>,
    /// Sinusoid: phase at t = 0, rad.
    pub phase_rad: Option<Numbers>,
    /// Waypoints: the points (x, y, z), m; walk: (x, y), m.
    pub points_m: Option<Vec<Vec<f64>>>,
    /// Walk: when the robot begins to stand on the first point, s; may be negative (default 0).
    pub start_s: Option<f64>,
    /// Sinusoid and walk: blocks that override the keys above, one per agent.
    #[serde(default, deserialize_with = "some_tables")]
    pub agents: Option<Vec<ReferenceBlock>>,
    /// Walk: how the robot walks (default: a slow walk of the Unitree G1, scaled to the robot).
    #[serde(default, deserialize_with = "some_table")]
    pub gait: Option<GaitFile>,
    /// Waypoints: offset of each agent from the points, m.
    pub offset_m: Option<Vec<List<f64, 3>>>,
    /// Waypoints: bound on the speed, m/s.
    pub max_speed_m_s: Option<f64>,
    /// Waypoints: bound on the acceleration, m/s^2.
    pub max_acceleration_m_s2: Option<f64>,
    /// Waypoints: spacing of the points interpolated on each leg; longer steps make wider, faster bends (default 2 m).
    pub step_m: Option<f64>,
}

/// Forms of a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKind {
    /// center + amplitude sin(frequency t + phase) on every channel.
    Sinusoid,
    /// UAV: a smooth rest-to-rest path through points.
    Waypoints,
    /// Biped: the joints of a robot that walks through points.
    Walk,
}

/// One agent's reference; what is absent is taken from `[reference]`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceBlock {
    /// Mean, m or rad.
    pub center: Option<Numbers>,
    /// Amplitude, m or rad.
    pub amplitude: Option<Numbers>,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: Option<Numbers>,
    /// Phase at t = 0, rad.
    pub phase_rad: Option<Numbers>,
    /// Walk: the points (x, y), m.
    pub points_m: Option<Vec<Vec<f64>>>,
    /// Walk: when the robot begins to stand on the first point, s.
    pub start_s: Option<f64>,
}

/// `[reference.gait]`; the defaults are a slow walk of the Unitree G1, whose lengths are scaled to other robots.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GaitFile {
    /// Sampling period of the plan, s (default 0.01).
    pub sampling_s: Option<f64>,
    /// Largest step length, m (default 0.2 for the G1).
    pub step_length_m: Option<f64>,
    /// How far a swinging ankle is raised, m (default 0.05 for the G1).
    pub step_height_m: Option<f64>,
    /// From touch-down to touch-down, s (default 0.9).
    pub step_period_s: Option<f64>,
    /// Part of the period in which both feet stand, s (default 0.15).
    pub double_support_s: Option<f64>,
    /// Distance of either foot from the line, m (default 0.1185 for the G1).
    pub foot_offset_m: Option<f64>,
    /// Height of the pelvis above the ground, m (default 0.74 for the G1).
    pub pelvis_height_m: Option<f64>,
    /// Height of an ankle above its foothold, m (default 0.035 for the G1).
    pub ankle_height_m: Option<f64>,
    /// How far ahead of the ankle the zero moment point is to lie under a foot, m (default 0.03 for the G1).
    pub zmp_ahead_m: Option<f64>,
    /// Standing before the first step, s (default 1.2).
    pub standing_before_s: Option<f64>,
    /// Standing after the last step, s (default 1.6).
    pub standing_after_s: Option<f64>,
    /// The foot that steps first (default "right").
    #[serde(default, deserialize_with = "some_word")]
    pub first_foot: Option<FootFile>,
    /// Spacing of the points interpolated between waypoints; longer steps make wider bends, m (default 2).
    pub smoothing_step_m: Option<f64>,
    /// Centre of mass in the pelvis frame, m (default: that of the standing pose).
    pub com_offset_m: Option<List<f64, 3>>,
}

/// A foot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FootFile {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

/// `[synthesis]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SynthesisFile {
    /// The weights: "uav-paper" or "uav-physical" of a UAV, "biped-paper" of a biped.
    pub preset: Option<String>,
    /// A gains.json that replaces the gains of all controllers that need no file of their own.
    pub gains: Option<String>,
    /// How the controller "pid-placed" is placed (default: with the delay margin of "ftc").
    #[serde(default, rename = "pid-placed", deserialize_with = "some_table")]
    pub pid_placed: Option<PidPlacedFile>,
    /// Additional controllers.
    #[serde(default)]
    pub named: BTreeMap<String, NamedGainsFile>,
    /// Overrides of the preset on the position channels.
    #[serde(default, deserialize_with = "some_table")]
    pub position: Option<WeightsFile>,
    /// Overrides of the preset on the attitude channels.
    #[serde(default, deserialize_with = "some_table")]
    pub attitude: Option<WeightsFile>,
    /// Overrides of the preset on a biped's joints.
    #[serde(default, deserialize_with = "some_table")]
    pub joints: Option<WeightsFile>,
}

/// `pid-placed`: a PID with a triple pole.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PidPlacedFile {
    /// The poles of its error lie at minus this, rad/s.
    pub poles_rad_s: Option<f64>,
    /// They lie where its delay margin is that of this controller: "ftc" (the default), "pid" or
    /// "pid-robust-observer".
    pub delay_margin_of: Option<String>,
    /// The poles of its observer lie at minus this, rad/s (default 800).
    pub observer_rad_s: Option<f64>,
}

/// An additional controller whose gains come from a file.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedGainsFile {
    /// A gains.json; a relative path starts at the campaign file's folder.
    pub gains: String,
    /// Which of the file's controllers to take (default "ftc").
    pub controller: Option<String>,
}

/// Overrides of a preset's weights; what they mean is in src/synthesis/README.md.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightsFile {
    /// Weights on the tracking error [int e, e, e'].
    pub q1: Option<List<f64, 3>>,
    /// Weights on the estimation error, one per observer state.
    pub q2: Option<Vec<f64>>,
    /// Weight on the feedback.
    pub r: Option<f64>,
    /// Attenuation level of both synthesis steps.
    pub rho: Option<f64>,
    /// Measurement noise of the filter.
    pub nu: Option<f64>,
    /// Weight of the sensor fault's model error in the filter.
    pub eps2: Option<f64>,
    /// Input of the sensor fault into [int y, y, y'], B20 of (34).
    pub sensor_fault_input: Option<List<f64, 3>>,
    /// Measurement noise of the "pid" observer.
    pub pid_nu: Option<f64>,
    /// Smoothing model: extrapolation order p.
    pub smoothing_order: Option<usize>,
    /// Smoothing model: leak, 1/s.
    pub smoothing_leak_per_s: Option<f64>,
    /// Smoothing model: spacing of the taps, s.
    pub smoothing_spacing_s: Option<f64>,
    /// Smoothing model: windows of the actuator and of the sensor fault.
    pub smoothing_windows: Option<List<usize, 2>>,
    /// Smoothing model: first row of the companion matrix instead of order and leak.
    pub smoothing_weights: Option<Vec<f64>>,
}

table_and_block! {
    /// `[initial]`
    InitialFile {
        /// What the observers start from (default "measured").
        #[serde(default, deserialize_with = "some_word")]
        observer: Option<ObserverStart>,
    }
    /// One agent's initial errors; what is absent is taken from `[initial]`.
    InitialBlock {
    }
    parameters {
        /// x - r at t = 0, m or rad.
        error,
        /// x' - r' at t = 0, m/s or rad/s.
        error_rate,
        /// Integral of the error at t = 0, m s or rad s.
        error_integral,
    }
}

/// What an observer starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ObserverStart {
    /// The first measurement: ehat(0) = y(0) - C0 r(0).
    Measured,
    /// Zero, whatever the error is.
    Zero,
}

/// `[coupling]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CouplingFile {
    /// Strength of the coupling (10) or (11): N/m^2 and N m/rad^2 on the channels of a UAV, N m/rad^2 on a biped's.
    pub kappa: Value,
    /// From where x is counted (default "absolute").
    #[serde(default, deserialize_with = "some_word")]
    pub coordinates: Option<CouplingCoordinates>,
}

/// From where the coupling counts x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CouplingCoordinates {
    /// From the origin, as (10) and (11) are printed.
    Absolute,
    /// From the team's centroid, so that where the team is does not matter.
    Centroid,
}

/// `[control]`
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlFile {
    /// What the first output integrates (default "exact").
    #[serde(default, deserialize_with = "some_word")]
    pub integral: Option<IntegralKind>,
    /// Time that a command takes to the actuator, s; whole steps (default: none).
    pub delay_s: Option<Value>,
    /// Commands per second, each held by the controller until the next; whole steps (default: a command at every
    /// instant).
    pub rate_hz: Option<f64>,
}

/// What the first output integrates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IntegralKind {
    /// x itself, as in the paper.
    Exact,
    /// What the sensor measures of x.
    Sensor,
}

/// `[verdict]`
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerdictFile {
    /// Largest admissible |e| from settle_s on, m or rad.
    pub max_error: Option<Numbers>,
    /// Largest admissible RMS error from settle_s on, m or rad.
    pub max_rmse: Option<Numbers>,
    /// |e| at or below this counts as settled, m or rad (default 0.05).
    pub settled_error: Option<Numbers>,
    /// Smallest ratio of two controllers' RMS errors that makes one of them better (default 1.05).
    pub smallest_ratio: Option<f64>,
    /// RMS errors below this are rounding, m or rad: comparisons take them for equal to it (default 1e-6).
    pub smallest_error: Option<f64>,
}
