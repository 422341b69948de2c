//! What is wrong with a run: why it is not to be relied on, and which requirements do not hold.

use std::path::Path;
use urts_mc::campaign::{ALL, Campaign};
use urts_mc::comparison::LEVEL;
use urts_mc::cross_check::{ERROR_LIMIT, RMSE_LIMIT};
use urts_mc::run::Findings;
use urts_mc::statistics::runs_needed;

/// Why the result is not to be relied on: episodes are missing, or the cross-check found too much.
pub(crate) fn shortcoming(findings: &Findings<'_>, out: &Path) -> Option<String> {
    let manifest = &findings.manifest;
    let missing = manifest.interrupted.as_ref().map(|reason| {
        format!(
            "{reason}; the {} of {} episodes that were finished are in {}; use --backend cpu for all",
            manifest.episodes,
            manifest.episodes_asked,
            out.display()
        )
    });
    // A GPU that is gone cannot be checked: that it is gone has been said.
    let unchecked = manifest
        .cross_check_missing
        .as_ref()
        .filter(|_| manifest.interrupted.is_none());
    let unchecked = unchecked.map(|reason| {
        format!(
            "the cross-check could not be done: {reason}; use --backend cpu, or --cross-check 0"
        )
    });
    let failed = manifest.cross_check.as_ref().filter(|check| !check.holds());
    let differs = failed.map(|check| {
        format!(
            "the cross-check fails: |e| differs by {:.1e} (limit {ERROR_LIMIT:.0e}), the RMS error by {:.1e} relative \
             (limit {RMSE_LIMIT:.0e}), {} verdicts without being near a threshold (limit 0), {} flights give other \
             numbers when repeated (limit 0); use --backend cpu, and please report this",
            check.largest_error_difference,
            check.largest_rmse_difference,
            check.verdicts_differ_clearly,
            check.not_repeated
        )
    });
    let all: Vec<String> = missing
        .into_iter()
        .chain(unchecked)
        .chain(differs)
        .collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

/// The requirements that do not hold, each with the reason and what to do: one a line.
pub(crate) fn unmet(campaign: &Campaign, findings: &Findings<'_>) -> String {
    let unmet = findings.unmet.iter().map(|(requirement, rate)| {
        let index = campaign
            .requirements
            .iter()
            .position(|own| own == *requirement)
            .unwrap_or_default();
        let limit = requirement.failure_rate_upper_95;
        let place = if *requirement.stratum == *ALL {
            String::new()
        } else {
            format!(" of the stratum {:?}", requirement.stratum)
        };
        let remedy = match runs_needed(limit, LEVEL, rate.failed()) {
            Some(enough) if rate.failed() == 0 => format!("fly at least {enough} episodes"),
            Some(enough) if rate.rate() < limit => format!(
                "fly at least {enough} episodes, of which no more may fail, or change the controller or the limit"
            ),
            _ => "change the controller or the limit".to_string(),
        };
        format!(
            "{}: require[{index}].failure_rate_upper_95 = {limit}: {:?} failed in {} of {} episodes{place}, so with 95 % \
             confidence its failure rate is known only to be below {:.4}; {remedy}",
            campaign.path.display(),
            requirement.controller,
            rate.failed(),
            rate.n,
            rate.upper_95.unwrap_or(1.0),
        )
    });
    unmet.collect::<Vec<_>>().join("\n")
}
