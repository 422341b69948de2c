//! Which stratum hurts each controller most, in sentences.

use super::screening::{FaultEffect, Growth, Screening};
use crate::statistics::Estimate;

/// Names that a sentence lists.
const MOST_NAMES: usize = 3;

/// What the strata do to each controller, against which of them, each in a sentence with the numbers that it stands on;
/// what may be no change is said to be so.
#[must_use]
pub fn harm(screenings: &[Screening]) -> Vec<String> {
    screenings.iter().flat_map(of_controller).collect()
}

fn of_controller(screening: &Screening) -> Vec<String> {
    let controller = &screening.controller;
    let mut sentences = vec![format!("{controller} {}", by_failures(screening))];
    let growth = by_growth(screening).into_iter();
    sentences.extend(growth.map(|sentence| format!("{controller}: {sentence}")));
    sentences
}

/// Which fault makes the controller fail most often.
fn by_failures(screening: &Screening) -> String {
    let rates = screening.harms.iter().map(|harm| &harm.rate);
    if rates.clone().all(|rate| rate.failed() == 0) {
        let least = rates.map(|rate| rate.n).min().unwrap_or(0);
        return format!("fails with none of the faults (at least {least} episodes each)");
    }
    let Some(top) = screening
        .most_failures
        .first()
        .map(|&k| &screening.harms[k])
    else {
        return "no fault to tell of".to_string();
    };
    let percent = |difference: &Estimate| {
        let [value, lower, upper] = ends(difference).map(|share| 100.0 * share);
        format!("{value:+.1} points [{lower:+.1}, {upper:+.1}]")
    };
    format!(
        "fails most often with {:?}: {} of {}, {}{}",
        top.stratum,
        top.rate.failed(),
        top.rate.n,
        change(screening, top.failures, &percent),
        apart(screening, &screening.most_failures)
    )
}

/// Which fault makes the errors of each channel group grow most.
fn by_growth(screening: &Screening) -> Vec<String> {
    let times = |growth: &Estimate| {
        let [value, lower, upper] = ends(growth).map(f64::exp);
        if value.is_infinite() {
            return format!(
                "beyond measure: half of its episodes diverge, at least {lower:.2} times"
            );
        }
        format!("{value:.2} times [{lower:.2}, {upper:.2}]")
    };
    let of_group = |(group, most): (usize, &Vec<usize>)| {
        let top = &screening.harms[*most.first()?];
        let Growth {
            group: name,
            log_growth,
            ..
        } = top.growth.get(group)?;
        let known = |harm: &FaultEffect| {
            let own = harm.growth.get(group);
            own.is_some_and(|own| own.log_growth.is_some())
        };
        if !screening.harms.iter().any(known) {
            let too_few = "too few episodes in each stratum to tell which fault makes it grow most";
            return Some(format!("RMS error, {name}: {too_few}"));
        }
        Some(format!(
            "RMS error, {name}, grows most with {:?}: {}{}",
            top.stratum,
            change(screening, *log_growth, &times),
            apart(screening, most)
        ))
    };
    screening
        .most_growth
        .iter()
        .enumerate()
        .filter_map(of_group)
        .collect()
}

fn ends(estimate: &Estimate) -> [f64; 3] {
    [
        estimate.value,
        estimate.interval.lower,
        estimate.interval.upper,
    ]
}

/// A change against the reference, and whether it is one.
fn change(
    screening: &Screening,
    change: Option<Estimate>,
    shown: &dyn Fn(&Estimate) -> String,
) -> String {
    let Some(found) = change else {
        return "too few episodes for an interval".to_string();
    };
    let Estimate { interval, .. } = found;
    let unsure = match interval.lower <= 0.0 && interval.upper >= 0.0 {
        true => ", which may be no change",
        false => "",
    };
    format!(
        "{} against {:?}{unsure}",
        shown(&found),
        screening.reference
    )
}

/// The faults that the worst cannot be told apart from.
fn apart(screening: &Screening, most: &[usize]) -> String {
    let names: Vec<String> = most
        .iter()
        .skip(1)
        .map(|&k| format!("{:?}", screening.harms[k].stratum))
        .collect();
    match names.len() {
        0 => String::new(),
        all if all + 1 == screening.harms.len() => {
            "; no other fault can be told apart from it".to_string()
        }
        few if few <= MOST_NAMES => format!("; {} cannot be told apart from it", names.join(", ")),
        many => format!(
            "; {} and {} more cannot be told apart from it",
            names[..MOST_NAMES].join(", "),
            many - MOST_NAMES
        ),
    }
}
