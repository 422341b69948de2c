//! The first screen of a report: every controller and every requirement as a card with large figures.

use crate::campaign::ALL;
use crate::controllers::spelled_out;
use crate::report::page::document::Card;
use crate::report::page::plot::Color;
use crate::report::requirements::{bound, limited};
use crate::report::run_data::RunData;
use crate::results::{RateMethod, RequirementResult};
use crate::util::format;

/// Controllers that have a card: more would be no glance.
const MOST: usize = 6;

/// A card for each of the first controllers, and one for each requirement.
pub(crate) fn band(data: &RunData) -> Vec<Card> {
    let controllers = 0..data.campaign.controllers.len().min(MOST);
    let controllers = controllers.map(|index| of_controller(data, index));
    let requirements = data.manifest.requirements.iter().map(of_requirement);
    controllers.chain(requirements).collect()
}

fn of_controller(data: &RunData, index: usize) -> Card {
    let name = &data.campaign.controllers[index];
    let mut numbers = vec![failures(data, name)];
    numbers.extend(errors(data, index));
    numbers.extend(effort(data, index));
    Card {
        name: name.clone(),
        color: Some(Color::Series(index)),
        note: of_what(data, name),
        numbers,
        holds: None,
    }
}

/// What a controller is: of one from a file, whose file.
fn of_what(data: &RunData, name: &str) -> String {
    let named = data.campaign.groups().iter();
    let mut named = named.flat_map(|group| &group.synthesis.named);
    match named.find(|own| own.name == name) {
        Some(own) => format!("{:?} of {}", own.controller, own.gains.display()),
        None => spelled_out(name).unwrap_or_default().to_string(),
    }
}

fn failures(data: &RunData, name: &str) -> (String, String) {
    let table = &data.summary;
    let wanted = [("controller", name), ("stratum", ALL)];
    let row = table.find(&wanted).next();
    let of = |column: &str| row.map_or(f64::NAN, |row| table.real(row, column));
    let method = RateMethod::of(&data.campaign).name();
    let ends = ["lower", "upper"].map(|side| of(&format!("failure_rate_{method}_{side}")));
    let rate = 100.0 * of("failure_rate");
    let interval = match ends.iter().all(|end| end.is_finite()) {
        true => format!(" [{:.2}, {:.2}]", 100.0 * ends[0], 100.0 * ends[1]),
        false => String::new(),
    };
    let rate = match rate {
        rate if rate.is_nan() => "-".to_string(),
        rate if rate == 0.0 || rate >= 10.0 => format!("{rate:.0} %"),
        rate => format!("{rate:.2} %"),
    };
    (rate, format!("fail{interval}"))
}

/// The median error on each channel group: of the first controller as it is, of the others beside it.
fn errors(data: &RunData, index: usize) -> Option<(String, String)> {
    let groups = data.campaign.channel_groups();
    let names: Vec<&str> = groups.iter().map(|own| &*own.name).collect();
    let controllers = &data.campaign.controllers;
    let first = controllers.first()?;
    if index == 0 {
        let error = |group: &&str| {
            let wanted = [
                ("controller", first.as_str()),
                ("stratum", ALL),
                ("metric", "rmse"),
                ("group", group),
            ];
            let row = data.summary.find(&wanted).next();
            format::digits(row.map_or(f64::NAN, |row| data.summary.real(row, "q50")), 3)
        };
        let units = groups.iter().map(|own| own.role.unit());
        let units: Vec<&str> = units.collect();
        let errors: Vec<String> = names.iter().map(error).collect();
        let what = format!(
            "median RMS error, {} ({})",
            names.join(" / "),
            units.join(" / ")
        );
        return Some((errors.join(" / "), what));
    }
    let table = &data.comparison;
    let times = |group: &&str| {
        let wanted = [
            ("a", first.as_str()),
            ("b", controllers[index].as_str()),
            ("stratum", ALL),
            ("scope", "group"),
            ("name", group),
        ];
        let row = table.find(&wanted).next();
        // The table has the other's error over the first's.
        format::digits(
            row.map_or(f64::NAN, |row| table.real(row, "log_ratio").exp()),
            3,
        )
    };
    let times: Vec<String> = names.iter().map(times).collect();
    let what = format!("times the RMS error of {first}, {}", names.join(" / "));
    Some((times.join(" / "), what))
}

/// The median effort, beside that of the first.
fn effort(data: &RunData, index: usize) -> Option<(String, String)> {
    let table = &data.fairness;
    let controllers = &data.campaign.controllers;
    let of = |name: &str| {
        let wanted = [("controller", name)];
        let rows = table.find(&wanted).map(|row| table.real(row, "effort_p50"));
        rows.collect::<Vec<f64>>()
    };
    let first = of(controllers.first()?);
    let own = of(&controllers[index]);
    if own.is_empty() {
        return None;
    }
    let (shown, what): (Vec<String>, _) = match index {
        0 => (
            own.iter().map(|own| format::digits(*own, 3)).collect(),
            "median effort, N² s or N² m² s".to_string(),
        ),
        _ => (
            own.iter()
                .zip(&first)
                .map(|(own, first)| format::digits(own / first, 3))
                .collect(),
            format!("times the effort of {}", controllers[0]),
        ),
    };
    Some((shown.join(" / "), what))
}

fn of_requirement(result: &RequirementResult) -> Card {
    Card {
        name: format!("require[{}]", result.place),
        color: None,
        note: limited(result),
        numbers: vec![(
            bound(result),
            format!("with 95 % confidence, {} episodes", result.n),
        )],
        holds: Some(result.is_met()),
    }
}
