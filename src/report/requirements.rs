//! What became of a run's `[[require]]`, in words.

use crate::campaign::{ALL, Side};
use crate::results::RequirementResult;
use crate::run::manifest::Manifest;
use crate::statistics::{LEVEL, runs_needed, sequential_runs_needed};
use crate::util::format::{digits, rounded_up};

/// The requirements that do not hold, each with the reason and what to do: one a line; none if all hold.
#[must_use]
pub fn unmet(manifest: &Manifest) -> Option<String> {
    let unmet = manifest.requirements.iter();
    let unmet = unmet.filter(|result| !result.is_met());
    let lines: Vec<String> = unmet
        .map(|result| {
            format!(
                "{}: {}: {}",
                manifest.campaign_path,
                asked(result),
                reason(manifest, result)
            )
        })
        .collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// What a requirement asks, in the keys of the file.
fn asked(result: &RequirementResult) -> String {
    let (place, limit) = (result.place, result.limit);
    if result.is_failure_rate() {
        return format!("require[{place}].failure_rate_upper_95 = {limit}");
    }
    let side = result.side.words();
    format!("require[{place}]: {} {side} {limit}", result.quantity)
}

/// What a requirement asks, for people.
pub(crate) fn title(result: &RequirementResult) -> String {
    let (place, subject, limit) = (result.place, result.subject(), result.limit);
    if result.is_failure_rate() {
        return format!("require[{place}]: failure rate of {subject} below {limit}");
    }
    format!("require[{place}]: {}", limited(result))
}

/// What is limited, and how.
pub(crate) fn limited(result: &RequirementResult) -> String {
    let (quantity, subject) = (&result.quantity, result.subject());
    format!(
        "{quantity} of {subject} {} {}",
        result.side.words(),
        result.limit
    )
}

/// What was found, beside what is asked.
pub(crate) fn found(result: &RequirementResult) -> String {
    let RequirementResult {
        quantity,
        side,
        limit,
        n,
        failed,
        ..
    } = result;
    if result.is_failure_rate() {
        let bound = result.bound_95.unwrap_or(1.0);
        return format!(
            "below {}, required {limit:.4} ({failed} of {n} failed)",
            rounded_up(bound, 4)
        );
    }
    let value = result.value.map_or(String::new(), |value| {
        format!(", {} in these episodes", digits(value, 4))
    });
    format!(
        "{quantity} {}, required {} {limit}{value}",
        bound(result),
        side.words()
    )
}

/// What is known of a limit on how two runs compare.
pub(crate) fn demanded(result: &RequirementResult) -> String {
    let value = result.value.map_or(String::new(), |value| {
        format!(" ({} in these episodes)", digits(value, 4))
    });
    format!(
        "{} of {} is {} with 95 % confidence{value}, asked is {} {}",
        result.quantity,
        result.subject(),
        bound(result),
        result.side.words(),
        result.limit
    )
}

/// What is known of a quantity.
pub(crate) fn bound(result: &RequirementResult) -> String {
    match result.bound_95 {
        Some(bound) => format!("{} {}", result.side.words(), outwards(bound, result.side)),
        None => format!("without a bound from {} episodes", result.n),
    }
}

/// A bound with four digits that count: never better than what was proved.
fn outwards(bound: f64, side: Side) -> String {
    if bound == 0.0 {
        return "0".to_string();
    }
    let scale = 10f64.powf(3.0 - bound.abs().log10().floor());
    let scaled = bound * scale;
    let whole = match side {
        // A bound that is a number of four digits stays what it is, whatever binary fractions make of it.
        Side::AtMost => (scaled - 1e-9).ceil(),
        Side::AtLeast => (scaled + 1e-9).floor(),
    };
    digits(whole / scale, 4)
}

/// Why a requirement does not hold, and what to do.
pub(crate) fn reason(manifest: &Manifest, result: &RequirementResult) -> String {
    let place = if result.stratum == ALL {
        String::new()
    } else {
        format!(" of the stratum {:?}", result.stratum)
    };
    if result.is_failure_rate() {
        return of_failure_rate(manifest, result, &place);
    }
    let (controller, quantity, n) = (&result.controller, &result.quantity, result.n);
    let Some(value) = result.value else {
        return format!(
            "{quantity} of {controller:?} is not known; require something else of it, or give it gains that say \
             what they are made for"
        );
    };
    let remedy = match (result.bound_95, result.seems_met()) {
        (_, true) => "simulate more episodes, or change the controller or the limit",
        (_, false) => "change the controller or the limit",
    };
    format!(
        "{quantity} of {controller:?} is {} in {n} episodes{place}, so with 95 % confidence it is {}; {remedy}",
        digits(value, 4),
        bound(result),
    )
}

fn of_failure_rate(manifest: &Manifest, result: &RequirementResult, place: &str) -> String {
    let needed = match manifest.stopped {
        Some(_) => sequential_runs_needed,
        None => runs_needed,
    };
    let remedy = match needed(result.limit, LEVEL, result.failed) {
        Some(enough) if result.failed == 0 => format!("simulate at least {enough} episodes"),
        Some(enough) if result.seems_met() => format!(
            "simulate at least {enough} episodes, of which no more may fail, or change the controller or the limit"
        ),
        _ => "change the controller or the limit".to_string(),
    };
    format!(
        "{:?} failed in {} of {} episodes{place}, so with 95 % confidence its failure rate is known only to be below {}; \
         {remedy}",
        result.controller,
        result.failed,
        result.n,
        rounded_up(result.bound_95.unwrap_or(1.0), 4),
    )
}
