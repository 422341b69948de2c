//! How many episodes a claim about a failure rate needs.

use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
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
    let head = ["failures allowed", "episodes"]
        .map(String::from)
        .into_iter();
    let rates = TRUE_SHARES.map(|share| format!("at {:.3e}", share * failure_rate));
    let rows = rows(failure_rate, confidence, most_failures);
    let cells = |(failures, n, chances): Row| {
        let chances = chances.map(|chance| format!("{:.1}%", 100.0 * chance));
        let counts = [failures.to_string(), n.to_string()].into_iter();
        counts.chain(chances).map(Cell::Number).collect()
    };
    let mut blocks = Vec::new();
    if rows.is_empty() {
        blocks.push(Block::text(
            "no number of episodes that can be counted proves that",
        ));
    } else {
        blocks.push(Block::Grid(Grid {
            head: head.chain(rates).collect(),
            rows: rows.into_iter().map(cells).collect(),
        }));
    }
    for sentence in [
        "The last columns: the chance that a run of so many episodes succeeds, if the true failure rate is the one above the column.",
        "Decide on a row before the run; the number of failures that you then see does not change it.",
    ] {
        blocks.push(Block::text(sentence));
    }
    let title = format!(
        "to be {} sure that fewer than {} of all episodes fail",
        percent(confidence),
        percent(failure_rate)
    );
    text(&Document {
        sections: vec![Section::new(title, blocks)],
        ..Document::default()
    })
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
