//! What a run comes to: its verdict and its requirements.

use super::style::{heading, judged};
use super::text::line;
use crate::campaign::Campaign;
use crate::results::{RequirementResult, how_sure};
use crate::run::Findings;
use crate::util::format::rounded_up;

/// Who does better, in a sentence each.
pub(super) fn in_short(campaign: &Campaign, findings: &Findings) -> String {
    let mut text = String::new();
    let sentences = &findings.manifest.verdict;
    if !sentences.is_empty() {
        let sure = match findings.manifest.episodes {
            1 => String::new(),
            _ => format!(" ({})", how_sure(campaign)),
        };
        line(&mut text, &format!("\n{}{sure}", heading("in short")));
    }
    for sentence in sentences {
        line(&mut text, &format!("  {sentence}"));
    }
    text
}

/// What became of each `[[require]]`, one a line.
pub(super) fn requirements(results: &[RequirementResult]) -> String {
    let mut text = String::new();
    if !results.is_empty() {
        line(
            &mut text,
            &format!(
                "\n{}: the failure rate with 95 % confidence",
                heading("requirements")
            ),
        );
    }
    let width = results.iter().map(|own| own.subject().chars().count());
    let width = width.max().unwrap_or(0);
    for (index, result) in results.iter().enumerate() {
        line(
            &mut text,
            &format!(
                "  {}  require[{index}]  {:<width$}  below {}, required {:.4} ({} of {} failed)",
                judged(result.is_met(), "met  ", "UNMET"),
                result.subject(),
                rounded_up(result.upper_95, 4),
                result.limit,
                result.failed,
                result.n
            ),
        );
    }
    text
}
