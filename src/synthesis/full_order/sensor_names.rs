//! From the names that sensors are written with to their rows of C and B2.

use super::sensor::{Sensor, SensorChanges, SensorRow};
use super::sensor_error::SensorError;
use crate::synthesis::channel::ERROR_STATES;
use crate::synthesis::design::ChannelDesign;
use crate::util::suggest::did_you_mean;
use std::collections::{BTreeMap, BTreeSet};

/// Largest size of a factor of C and B2.
const LARGEST_FACTOR: f64 = 1e3;
/// Range of the noise weight nu.
const NOISE: [f64; 2] = [1e-12, 1e12];
/// Endings of the names of a channel's three signals, in the order of the states.
pub(super) const SIGNALS: [&str; ERROR_STATES] = [".integral", "", ".rate"];

/// The names that sensors are written with.
pub(super) struct Names {
    /// Of the 3 n signals, and of their sensors, in the order of the states.
    pub(super) signals: Vec<String>,
    /// Of the faults.
    pub(super) faults: Vec<String>,
}

impl Names {
    pub(super) fn new(channels: &[String], changes: &SensorChanges) -> Result<Self, SensorError> {
        check_distinct("channels", channels)?;
        if channels.is_empty() {
            return Err(SensorError::new(
                "channels",
                "[]",
                "there is at least one channel",
                "name it",
            ));
        }
        let faults = changes.faults.as_deref().unwrap_or(channels);
        check_distinct("faults", faults)?;
        if faults.len() > channels.len() {
            return Err(SensorError::new(
                "faults",
                format!("{faults:?}"),
                &format!("{} channels have at most so many faults", channels.len()),
                "let one fault strike several sensors",
            ));
        }
        let signals = SIGNALS.iter().flat_map(|ending| {
            let names = channels.iter();
            names.map(move |channel| format!("{channel}{ending}"))
        });
        Ok(Self {
            signals: signals.collect(),
            faults: faults.to_vec(),
        })
    }

    /// Refuses changes of sensors that there are not, and two changes of one.
    pub(super) fn check_known(&self, changes: &SensorChanges) -> Result<(), SensorError> {
        let replaced = changes.replace.keys();
        let replaced = replaced.map(|name| (format!("replace.{name:?}"), name));
        let removed = changes.remove.iter().enumerate();
        let removed = removed.map(|(index, name)| (format!("remove[{index}]"), name));
        let mut seen = BTreeSet::new();
        for (key, name) in replaced.chain(removed) {
            if !self.signals.contains(name) {
                return Err(unknown(
                    key,
                    format!("{name:?}"),
                    name,
                    "sensors",
                    &self.signals,
                ));
            }
            if !seen.insert(name) {
                return Err(SensorError::new(
                    key,
                    format!("{name:?}"),
                    "a sensor is replaced or removed once",
                    "keep one of the two",
                ));
            }
        }
        Ok(())
    }

    /// The sensor of a signal as it is without changes.
    pub(super) fn unchanged(
        &self,
        signal: usize,
        struck: bool,
        design: &ChannelDesign,
    ) -> SensorRow {
        let n = self.signals.len() / ERROR_STATES;
        let mut row = SensorRow {
            name: self.signals[signal].clone(),
            c: vec![0.0; self.signals.len()],
            b2: vec![0.0; self.faults.len()],
            noise: design.nu,
        };
        row.c[signal] = 1.0;
        if struck {
            row.b2[signal % n] = design.sensor_fault_input[signal / n];
        }
        row
    }

    /// The rows of a sensor that is written at `key`.
    pub(super) fn row(
        &self,
        key: &str,
        name: &str,
        sensor: &Sensor,
        design: &ChannelDesign,
    ) -> Result<SensorRow, SensorError> {
        let key_of = format!("{key}.of");
        let c = factors(&key_of, &sensor.of, "signals", &self.signals)?;
        if c.iter().all(|&factor| factor == 0.0) {
            return Err(SensorError::new(
                key_of,
                "nothing",
                "a sensor measures at least one signal",
                "name what it measures, or remove it",
            ));
        }
        let key_of_faults = format!("{key}.faults");
        let b2 = factors(&key_of_faults, &sensor.faults, "faults", &self.faults)?;
        let n = self.signals.len() / ERROR_STATES;
        let integrates = c[..n].iter().any(|&factor| factor != 0.0);
        if integrates && b2.iter().any(|&factor| factor != 0.0) {
            return Err(SensorError::new(
                key_of_faults,
                "given",
                "an integral is computed, not sensed, so no sensor fault enters it",
                "remove the faults",
            ));
        }
        let noise = sensor.noise.unwrap_or(design.nu);
        if !(NOISE[0]..=NOISE[1]).contains(&noise) {
            return Err(SensorError::new(
                format!("{key}.noise"),
                noise.to_string(),
                &format!("must lie within {:e} and {:e}", NOISE[0], NOISE[1]),
                "give a value within the limits",
            ));
        }
        Ok(SensorRow {
            name: name.to_string(),
            c,
            b2,
            noise,
        })
    }
}

/// A row of factors by the names of its columns, which are `what`.
fn factors(
    key: &str,
    given: &BTreeMap<String, f64>,
    what: &str,
    names: &[String],
) -> Result<Vec<f64>, SensorError> {
    let mut row = vec![0.0; names.len()];
    for (name, &factor) in given {
        let key = format!("{key}.{name:?}");
        let Some(column) = names.iter().position(|known| known == name) else {
            return Err(unknown(key, factor.to_string(), name, what, names));
        };
        if !(-LARGEST_FACTOR..=LARGEST_FACTOR).contains(&factor) {
            return Err(SensorError::new(
                key,
                factor.to_string(),
                &format!("must lie within -{LARGEST_FACTOR} and {LARGEST_FACTOR}"),
                "give a value within the limits",
            ));
        }
        row[column] = factor;
    }
    Ok(row)
}

/// Refuses names that are empty or given twice.
fn check_distinct(key: &str, names: &[String]) -> Result<(), SensorError> {
    let again = (0..names.len()).find(|&k| names[k].is_empty() || names[..k].contains(&names[k]));
    let Some(index) = again else { return Ok(()) };
    Err(SensorError::new(
        format!("{key}[{index}]"),
        format!("{:?}", names[index]),
        "each has a name of its own",
        "rename it",
    ))
}

/// A name that is none of those that there are, which are `what`.
fn unknown(key: String, value: String, name: &str, what: &str, names: &[String]) -> SensorError {
    let known = names.iter().map(String::as_str);
    let limit = match names.is_empty() {
        true => format!("there are no {what}"),
        false => format!("the {what} are {}", names.join(", ")),
    };
    let remedy = did_you_mean(name, known, "take one of them");
    SensorError::new(key, value, &limit, &remedy)
}
