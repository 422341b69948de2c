//! Why a run is not to be relied on, in words, as its manifest tells.

use crate::run::manifest::Manifest;
use crate::simulation::cross_check::{ERROR_LIMIT, RMSE_LIMIT};
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
