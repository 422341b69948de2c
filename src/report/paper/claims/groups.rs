//! Numbers of the channels, group by group, and how they are written.

use crate::report::paper::measures::top;
use crate::report::paper::scenarios::Scenarios;
use crate::util::format::number;

pub(super) fn channels(scenarios: &Scenarios) -> std::ops::Range<usize> {
    0..scenarios.group.channels().len()
}

/// The largest value over channels, of quantities without a unit.
pub(super) fn worst(scenarios: &Scenarios, of: impl Fn(usize) -> f64) -> f64 {
    top(channels(scenarios).map(of))
}

/// A number of each group of channels, and the unit of its errors: metres and radians are never mixed.
pub(super) type Grouped = Vec<(f64, &'static str)>;

pub(super) fn grouped(scenarios: &Scenarios, of: impl Fn(&[usize]) -> f64) -> Grouped {
    let groups = scenarios.group.channel_groups().into_iter();
    groups
        .map(|group| {
            let channels: Vec<usize> = group.channels.collect();
            (of(&channels), group.role.unit())
        })
        .collect()
}

/// The largest value over each group's channels.
pub(super) fn worst_of_groups(scenarios: &Scenarios, of: impl Fn(usize) -> f64) -> Grouped {
    grouped(scenarios, |channels| {
        top(channels.iter().map(|channel| of(*channel)))
    })
}

/// Numbers with their units, of which `unit` makes another quantity's.
pub(super) fn with_units(values: &Grouped, unit: impl Fn(&str) -> String) -> String {
    let texts: Vec<String> = values
        .iter()
        .map(|(value, own)| format!("{} {}", number(*value), unit(own)))
        .collect();
    texts.join(" and ")
}

/// The unit of errors.
pub(super) fn own(unit: &str) -> String {
    unit.to_string()
}

/// The unit of rates.
pub(super) fn rate(unit: &str) -> String {
    format!("{unit}/s")
}

/// The quotients of two numbers of each group.
pub(super) fn quotients(above: &Grouped, below: &Grouped) -> Vec<f64> {
    let pairs = above.iter().zip(below);
    pairs.map(|((a, _), (b, _))| a / b).collect()
}

/// Factors in a sentence.
pub(super) fn times(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| number(*value)).collect();
    texts.join(" and ")
}
