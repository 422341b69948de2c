//! The sensors of a group of channels: y = C x + B2 f2 (16) with a row of C and of B2 for each sensor.
//!
//! Without a change each channel x has three, of the integral of x, of x and of x', which is C = C0 (x) I and
//! B2 = B20 (x) I of (34). Changes replace, add and remove sensors, and may name the faults that strike them.

use super::detectability::hidden_integral;
use super::sensor::{SensorChanges, SensorRow};
use super::sensor_error::SensorError;
use super::sensor_names::{Names, SIGNALS};
use crate::synthesis::channel::ERROR_STATES;
use crate::synthesis::design::ChannelDesign;
use nalgebra::DMatrix;
use serde::Serialize;

/// The sensors of a group of channels, which show every integral, so that a filter of them exists.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensors {
    channels: Vec<String>,
    faults: Vec<String>,
    rows: Vec<SensorRow>,
}

impl Sensors {
    /// The sensors of `channels`, all different, with changes.
    ///
    /// # Errors
    /// A name that is not known or given twice, a factor or noise beyond its limits, a fault that strikes no sensor or
    /// an integral, more faults than channels, and an integral that no sensor shows.
    pub fn new(
        channels: &[String],
        design: &ChannelDesign,
        changes: &SensorChanges,
    ) -> Result<Self, SensorError> {
        let names = Names::new(channels, changes)?;
        names.check_known(changes)?;
        let mut rows = Vec::new();
        for (signal, name) in names.signals.iter().enumerate() {
            if changes.remove.contains(name) {
                continue;
            }
            rows.push(match changes.replace.get(name) {
                Some(sensor) => {
                    let key = format!("replace.{name:?}");
                    names.row(&key, name, sensor, design)?
                }
                None => names.unchanged(signal, changes.faults.is_none(), design),
            });
        }
        for (index, sensor) in changes.add.iter().enumerate() {
            let key = format!("add[{index}]");
            rows.push(names.row(&key, &key, sensor, design)?);
        }
        let mut sensors = Self {
            channels: channels.to_vec(),
            faults: names.faults,
            rows,
        };
        sensors.check_faults(changes.faults.is_some())?;
        sensors.check_detectable(changes)?;
        Ok(sensors)
    }

    /// Names of the n channels.
    #[must_use]
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// Names of the o sensor faults.
    #[must_use]
    pub fn faults(&self) -> &[String] {
        &self.faults
    }

    /// The l sensors.
    #[must_use]
    pub fn rows(&self) -> &[SensorRow] {
        &self.rows
    }

    /// C of (16), l x 3 n.
    #[must_use]
    pub fn c(&self) -> DMatrix<f64> {
        let columns = ERROR_STATES * self.channels.len();
        DMatrix::from_fn(self.rows.len(), columns, |i, j| self.rows[i].c[j])
    }

    /// B2 of (16), l x o.
    #[must_use]
    pub fn b2(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.rows.len(), self.faults.len(), |i, j| {
            self.rows[i].b2[j]
        })
    }

    /// Refuses a named fault that strikes no sensor, and drops one without a name of its own, which would be estimated
    /// from nothing.
    fn check_faults(&mut self, named: bool) -> Result<(), SensorError> {
        let strikes = |fault: usize| self.rows.iter().any(|row| row.b2[fault] != 0.0);
        let struck: Vec<bool> = (0..self.faults.len()).map(strikes).collect();
        if let (true, Some(none)) = (named, struck.iter().position(|strikes| !strikes)) {
            return Err(SensorError::new(
                format!("faults[{none}]"),
                format!("{:?}", self.faults[none]),
                "strikes no sensor",
                "give it to a sensor under replace or add, or remove it",
            ));
        }
        let kept = |list: &mut Vec<f64>| {
            let mut strikes = struck.iter();
            list.retain(|_| strikes.next() == Some(&true));
        };
        self.rows.iter_mut().for_each(|row| kept(&mut row.b2));
        let mut strikes = struck.iter();
        self.faults.retain(|_| strikes.next() == Some(&true));
        Ok(())
    }

    /// Refuses sensors that leave an integral unseen.
    fn check_detectable(&self, changes: &SensorChanges) -> Result<(), SensorError> {
        let Some(hidden) = hidden_integral(&self.c(), self.channels.len()) else {
            return Ok(());
        };
        let largest = hidden.iter().enumerate();
        let largest = largest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let channel = &self.channels[largest.map_or(0, |(index, _)| index)];
        let own = format!("{channel}{}", SIGNALS[0]);
        let (key, value) = match changes.replace.contains_key(&own) {
            true => (format!("replace.{own:?}"), "this sensor".to_string()),
            false => ("remove".to_string(), format!("{:?}", changes.remove)),
        };
        let hidden = combination(&self.channels, &hidden);
        Err(SensorError::new(
            key,
            value,
            &format!("no sensor shows the integral of {hidden}, so no filter can hold it"),
            &format!("keep {own:?} as it is, or add a sensor of it"),
        ))
    }
}

/// A sum of channels with factors relative to the largest, such as `x - 0.5 y`.
fn combination(channels: &[String], factors: &[f64]) -> String {
    let largest = factors
        .iter()
        .copied()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let relative = factors.iter().map(|factor| factor / largest.unwrap_or(1.0));
    let mut text = String::new();
    for (channel, factor) in channels.iter().zip(relative) {
        // Rounding leaves dust on the channels that take no part.
        if factor.abs() < 1e-6 {
            continue;
        }
        let sign = match (text.is_empty(), factor < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = match (factor.abs() - 1.0).abs() < 1e-6 {
            true => String::new(),
            false => format!("{:.3} ", factor.abs()),
        };
        text += &format!("{sign}{size}{channel}");
    }
    text
}
