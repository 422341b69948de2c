//! How many episodes a claim about a failure rate needs.

use super::text::line;
use crate::statistics::{power, runs_needed};
use serde_json::{Value, json};

/// True failure rates, as shares of the claimed one, for which the chances of success are shown.
const TRUE_SHARES: [f64; 3] = [0.1, 0.25, 0.5];

/// A number of failures, the episodes that still prove the claim with it, and the chances that a run of so many does,
/// for each of the true rates.
type Row = (u64, u64, [f64; TRUE_SHARES.len()]);

fn rows(failure_rate: f64, confidence: f64, most_failures: u64) -> Vec<Row> {
    let row = |failures| {
        let n = runs_needed(failure_rate, confidence, failures)?;
        let chances =
            TRUE_SHARES.map(|share| power(share * failure_rate, failure_rate, confidence, n));
        Some((failures, n, chances))
    };
    (0..=most_failures).map_while(row).collect()
}

/// The episodes that a claim needs, with none, one, .. failures.
pub fn runs(failure_rate: f64, confidence: f64, most_failures: u64) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "to be {} sure that fewer than {} of all episodes fail",
            percent(confidence),
            percent(failure_rate)
        ),
    );
    let mut head = format!("  {:>16}  {:>10}", "failures allowed", "episodes");
    for share in TRUE_SHARES {
        let rate = format!("at {:.3e}", share * failure_rate);
        head.push_str(&format!("  {rate:>13}"));
    }
    line(&mut text, &head);
    let rows = rows(failure_rate, confidence, most_failures);
    if rows.is_empty() {
        line(
            &mut text,
            "  no number of episodes that can be counted proves that",
        );
    }
    for (failures, n, chances) in rows {
        let mut cells = format!("  {failures:>16}  {n:>10}");
        for chance in chances {
            cells.push_str(&format!("  {:>12.1}%", 100.0 * chance));
        }
        line(&mut text, &cells);
    }
    line(
        &mut text,
        "The last columns: the chance that a run of so many episodes succeeds, if the true failure rate is the one above the column.\n\
         Decide on a row before the run; the number of failures that you then see does not change it.",
    );
    text
}

/// A share between 0 and 1 in percent, with as many digits as it takes not to say none or all.
fn percent(share: f64) -> String {
    let written = |decimals: usize| format!("{:.decimals$}", 100.0 * share);
    let says_it = |decimals: &usize| {
        let read: f64 = written(*decimals).parse().unwrap_or(f64::NAN);
        (read / 100.0 - share).abs() <= 1e-6 * share.min(1.0 - share)
    };
    match (0..=15).find(says_it) {
        Some(decimals) => format!("{}%", written(decimals)),
        None => format!("{:e}%", 100.0 * share),
    }
}

/// [`runs`] for programs.
pub fn runs_json(failure_rate: f64, confidence: f64, most_failures: u64) -> Value {
    let rows = rows(failure_rate, confidence, most_failures);
    let row = |(failures, episodes, chances): Row| {
        let chances = TRUE_SHARES.iter().zip(chances);
        json!({
            "failures_allowed": failures,
            "episodes": episodes,
            "chances": chances.map(|(share, chance)| json!({
                "true_failure_rate": share * failure_rate, "success": chance,
            })).collect::<Vec<_>>(),
        })
    };
    json!({
        "failure_rate": failure_rate,
        "confidence": confidence,
        "rows": rows.into_iter().map(row).collect::<Vec<_>>(),
    })
}
