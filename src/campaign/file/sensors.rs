//! `[sensors]`: what the sensors of a group of channels measure, where they are not three of each channel.

use super::value::{some_table, tables};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// `[sensors]`: the sensors of those groups of channels in which they are not three of each channel, of its integral,
/// of x and of x'. A sensor measures channels of one group only. `urts-mc synthesize` shows the gains; episodes are not
/// simulated with them yet.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorsFile {
    /// UAV: of x, y and z.
    #[serde(default, deserialize_with = "some_table")]
    pub position: Option<ChannelSensorsFile>,
    /// UAV: of roll, pitch and yaw.
    #[serde(default, deserialize_with = "some_table")]
    pub attitude: Option<ChannelSensorsFile>,
    /// Biped: of the left leg's joints.
    #[serde(default, rename = "left-leg", deserialize_with = "some_table")]
    pub left_leg: Option<ChannelSensorsFile>,
    /// Biped: of the right leg's joints.
    #[serde(default, rename = "right-leg", deserialize_with = "some_table")]
    pub right_leg: Option<ChannelSensorsFile>,
}

/// The sensors of a group of channels, as changes of three of each channel x: `x.integral`, `x` and `x.rate`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelSensorsFile {
    /// Names of the sensor faults, at most one per channel (default: one of each channel, which enters the sensors that
    /// are not replaced as `sensor_fault_input` says).
    pub faults: Option<Vec<String>>,
    /// Sensors in the place of those with these names.
    #[serde(default)]
    pub replace: BTreeMap<String, SensorFile>,
    /// More sensors.
    #[serde(default, deserialize_with = "tables")]
    pub add: Vec<SensorFile>,
    /// Names of sensors that there are not.
    #[serde(default)]
    pub remove: Vec<String>,
}

/// A sensor.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorFile {
    /// What it measures: factors of the signals `x`, `x.rate` and `x.integral` of channels x, summed.
    pub of: BTreeMap<String, f64>,
    /// Factors with which sensor faults enter, by name (default: none do).
    #[serde(default)]
    pub faults: BTreeMap<String, f64>,
    /// Its measurement noise in the filter (default: `nu` of the channels' weights).
    pub noise: Option<f64>,
}
