//! What is wrong with a run, in words, as its manifest tells: why it is not to be relied on, and which requirements do
//! not hold.

use crate::campaign::ALL;
use crate::results::RequirementResult;
use crate::run::manifest::Manifest;
use crate::simulation::cross_check::{ERROR_LIMIT, RMSE_LIMIT};
use crate::statistics::{LEVEL, runs_needed, sequential_runs_needed};
use crate::util::format::rounded_up;
use std::path::Path;

/// Why the result of a run, written to `out`, is not to be relied on, one reason a line: episodes are missing, or the
/// cross-check could not be done or found too much; none if nothing is wrong.
#[must_use]
pub fn shortcoming(manifest: &Manifest, out: &Path) -> Option<String> {
    let all: Vec<String> = [
        missing(manifest, out),
        unchecked(manifest),
        differing(manifest),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

/// That episodes are missing.
pub(crate) fn missing(manifest: &Manifest, out: &Path) -> Option<String> {
    manifest.interrupted.as_ref().map(|reason| {
        format!(
            "{reason}; the {} of {} episodes that were finished are in {}; use --backend cpu for all",
            manifest.episodes,
            manifest.episodes_asked,
            out.display()
        )
    })
}

/// That the cross-check could not be done. A GPU that is gone cannot be checked: that it is gone is said elsewhere.
pub(crate) fn unchecked(manifest: &Manifest) -> Option<String> {
    let reason = manifest.cross_check_missing.as_ref()?;
    manifest.interrupted.is_none().then(|| {
        format!(
            "the cross-check could not be done: {reason}; use --backend cpu, or --cross-check 0"
        )
    })
}

/// That the cross-check fails.
pub(crate) fn differing(manifest: &Manifest) -> Option<String> {
    let failed = manifest.cross_check.as_ref().filter(|check| !check.holds());
    failed.map(|check| {
        format!(
            "the cross-check fails: |e| differs by {:.1e} (limit {ERROR_LIMIT:.0e}), the RMS error by {:.1e} relative \
             (limit {RMSE_LIMIT:.0e}), {} verdicts without being near a threshold (limit 0), {} episodes give other \
             numbers when repeated (limit 0); use --backend cpu, and please report this",
            check.largest_error_difference,
            check.largest_rmse_difference,
            check.verdicts_differ_clearly,
            check.not_repeated
        )
    })
}

/// The requirements that do not hold, each with the reason and what to do: one a line; none if all hold.
#[must_use]
pub fn unmet(manifest: &Manifest) -> Option<String> {
    let unmet = manifest
        .requirements
        .iter()
        .enumerate()
        .filter(|(_, result)| !result.is_met());
    let lines: Vec<String> = unmet
        .map(|(index, result)| {
            format!(
                "{}: require[{index}].failure_rate_upper_95 = {}: {}",
                manifest.campaign_path,
                result.limit,
                reason(manifest, result)
            )
        })
        .collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// Why a requirement does not hold, and what to do.
pub(crate) fn reason(manifest: &Manifest, result: &RequirementResult) -> String {
    let place = if result.stratum == ALL {
        String::new()
    } else {
        format!(" of the stratum {:?}", result.stratum)
    };
    let needed = match manifest.stopped {
        Some(_) => sequential_runs_needed,
        None => runs_needed,
    };
    let remedy = match needed(result.limit, LEVEL, result.failed) {
        Some(enough) if result.failed == 0 => format!("simulate at least {enough} episodes"),
        Some(enough) if result.rate() < result.limit => format!(
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
        rounded_up(result.upper_95, 4),
    )
}
