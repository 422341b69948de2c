//! What each stratum does to each controller, in a table and in words.

use super::findings::kind_of_interval;
use super::line;
use super::style::heading;
use urts_mc::campaign::Campaign;
use urts_mc::comparison::{FailureRate, Harm, Screening};
use urts_mc::run::Findings;
use urts_mc::statistics::Estimate;

/// Names that a sentence lists.
const MOST_NAMES: usize = 3;

/// The strata of a run; nothing of a campaign without.
pub(super) fn strata(campaign: &Campaign, findings: &Findings) -> String {
    let mut text = String::new();
    let strata = campaign.strata.all();
    if strata.is_empty() {
        return text;
    }
    let widths = strata.iter().map(|stratum| stratum.name.chars().count());
    let width = widths.max().unwrap_or(0).max(8);
    let title = format!("failure rates by stratum [{}]", kind_of_interval(campaign));
    let mut head = format!("\n{}\n  {:<width$} {:>6}", heading(&title), "stratum", "n");
    for controller in &campaign.controllers {
        head.push_str(&format!("  {controller:<24}"));
    }
    line(&mut text, head.trim_end());
    for stratum in strata {
        let of_stratum: Vec<&FailureRate> = campaign
            .controllers
            .iter()
            .filter_map(|name| {
                let rates = findings.summary.iter().map(|row| &row.failures);
                let mut own = rates.filter(|rate| rate.stratum == stratum.name);
                own.find(|rate| rate.controller == *name)
            })
            .collect();
        let n = of_stratum.first().map_or(0, |rate| rate.n);
        let mut cells = format!("  {:<width$} {n:>6}", stratum.name);
        for rate in of_stratum {
            cells.push_str(&format!("  {:<24}", rate_text(rate)));
        }
        line(&mut text, cells.trim_end());
    }
    if let Some(first) = findings.screenings.first() {
        let title = format!(
            "which fault hurts most, against the stratum {:?} [95 %]",
            first.reference
        );
        line(&mut text, &format!("\n{}", heading(&title)));
    }
    for screening in &findings.screenings {
        // Without a stratum that has no faults, each controller has a reference of its own.
        let other = findings.screenings[0].reference != screening.reference;
        let against = match other {
            true => format!(" (against {:?})", screening.reference),
            false => String::new(),
        };
        let name = &screening.controller;
        line(
            &mut text,
            &format!("  {name:<12} {}{against}", by_failures(screening)),
        );
        for sentence in by_growth(screening) {
            line(&mut text, &format!("  {:<12} {sentence}", ""));
        }
    }
    text
}

fn rate_text(rate: &FailureRate) -> String {
    let interval = rate.interval().map_or(String::new(), |interval| {
        format!(
            " [{:.1}, {:.1}]",
            100.0 * interval.lower,
            100.0 * interval.upper
        )
    });
    match rate.n {
        0 => "-".to_string(),
        _ => format!("{:.1}%{interval}", 100.0 * rate.rate()),
    }
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
        format!("{value:+.1} % [{lower:+.1}, {upper:+.1}]")
    };
    format!(
        "fails most often with {:?}: {} of {}, {}{}",
        top.stratum,
        top.rate.failed(),
        top.rate.n,
        change(top.failures, &percent),
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
        let (name, growth) = top.growth.get(group)?;
        let known = |harm: &Harm| harm.growth.get(group).is_some_and(|own| own.1.is_some());
        if !screening.harms.iter().any(known) {
            let too_few = "too few episodes in each stratum to tell which fault makes it grow most";
            return Some(format!("RMS error, {name}: {too_few}"));
        }
        Some(format!(
            "RMS error, {name}, grows most with {:?}: {}{}",
            top.stratum,
            change(*growth, &times),
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
fn change(change: Option<Estimate>, shown: &dyn Fn(&Estimate) -> String) -> String {
    let Some(found) = change else {
        return "too few episodes for an interval".to_string();
    };
    let Estimate { interval, .. } = found;
    if interval.lower <= 0.0 && interval.upper >= 0.0 {
        format!("{}, which may be no change", shown(&found))
    } else {
        shown(&found)
    }
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
