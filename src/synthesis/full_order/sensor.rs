//! A sensor as it is written, and as rows of the matrices of (16).

use serde::Serialize;
use std::collections::BTreeMap;

/// A sensor as it is written: what it measures, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Factors of the signals `x`, `x.rate` and `x.integral` of a channel x; what is absent has the factor 0.
    pub of: BTreeMap<String, f64>,
    /// Factors with which the sensor faults enter, by their names.
    pub faults: BTreeMap<String, f64>,
    /// Weight nu of its measurement noise; that of the design if absent.
    pub noise: Option<f64>,
}

/// How the sensors of a group of channels differ from the three of each channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorChanges {
    /// Names of the sensor faults; if absent each channel has one of its own name, which enters the sensors that are
    /// not changed as the design's B20 says.
    pub faults: Option<Vec<String>>,
    /// Sensors in the place of those with these names.
    pub replace: BTreeMap<String, Sensor>,
    /// More sensors.
    pub add: Vec<Sensor>,
    /// Names of sensors that there are not.
    pub remove: Vec<String>,
}

/// A sensor with its rows of C and B2.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorRow {
    /// Its name: that of the signal whose sensor it is or was, or `add[0]`, `add[1]`, ..
    pub name: String,
    /// Row of C, 3 n factors: of the integrals of all channels, of the channels, of their rates.
    pub c: Vec<f64>,
    /// Row of B2, o factors.
    pub b2: Vec<f64>,
    /// Weight nu of its measurement noise.
    pub noise: f64,
}
