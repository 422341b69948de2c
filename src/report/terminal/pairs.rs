//! How each pair of controllers compares.

use super::style::heading;
use super::text::line;
use crate::campaign::{ALL, Campaign};
use crate::results::{Measured, PairedComparison, Ratio};
use crate::run::Findings;
use crate::statistics::Interval;

/// Channels that are shown one by one.
const MOST_CHANNELS: usize = 6;

/// How each pair of controllers compares.
pub(super) fn pairs(campaign: &Campaign, findings: &Findings) -> String {
    let mut text = String::new();
    if !findings.results.comparisons.is_empty() {
        line(
            &mut text,
            &format!(
                "\n{}: how many times smaller the RMS error of the first is, median [{} 95 %], and how often it wins",
                heading("pair by pair"),
                if campaign.sampling.replicates().is_some() {
                    "t over replicates"
                } else {
                    "BCa"
                }
            ),
        );
    }
    let first = findings.results.comparisons.first();
    let ratios = first.iter().flat_map(|first| &first.ratios);
    let names = ratios.map(|ratio| ratio.name.len());
    let width = names.max().unwrap_or(0).max(8);
    let of_all = findings
        .results
        .comparisons
        .iter()
        .filter(|own| *own.stratum == *ALL);
    for comparison in of_all {
        line(
            &mut text,
            &format!("  {} against {}", comparison.a, comparison.b),
        );
        let (shown, left_out) = worth_showing(&comparison.ratios);
        for ratio in shown {
            line(
                &mut text,
                &format!("    {:<width$}  {}", ratio.name, ratio_text(ratio)),
            );
        }
        if left_out > 0 {
            let rest = "between these two; comparison.csv has them all";
            line(
                &mut text,
                &format!("    {left_out} more channels lie {rest}"),
            );
        }
        line(
            &mut text,
            &format!("    {:<width$}  {}", "failures", failures_text(comparison)),
        );
        let diverged = comparison.ratios.first().map(|ratio| ratio.diverged);
        let diverged: u64 = diverged.iter().flatten().sum();
        if diverged > 0 {
            line(
                &mut text,
                &format!("    a diverged episode counts as infinitely bad: {diverged} pairs"),
            );
        }
    }
    text
}

/// The groups, and of many channels the one where the first controller gains least and the one where it gains most; and
/// how many are left out.
fn worth_showing(ratios: &[Ratio]) -> (Vec<&Ratio>, usize) {
    let (mut shown, mut channels): (Vec<&Ratio>, Vec<&Ratio>) =
        ratios.iter().partition(|ratio| ratio.scope == "group");
    let mut left_out = 0;
    if channels.len() > MOST_CHANNELS {
        let value = |ratio: &Ratio| ratio.log_ratio.map_or(f64::NAN, |ratio| ratio.value);
        channels.sort_by(|a, b| value(a).total_cmp(&value(b)));
        left_out = channels.len() - 2;
        channels = vec![channels[0], channels[left_out + 1]];
    }
    shown.extend(channels);
    (shown, left_out)
}

fn ratio_text(ratio: &Ratio) -> String {
    let wins = ratio.win_rate.map_or(String::new(), |rate| {
        format!("  wins {:>5.1} %", 100.0 * rate.value)
    });
    match ratio.known() {
        Some(Measured { value, interval }) => {
            // Of a few episodes every ratio may be the median.
            let known = interval.filter(|own| own.lower.is_finite() || own.upper.is_finite());
            let interval = known.map_or("[-]".to_string(), |Interval { lower, upper }| {
                format!("[{}, {}]", times(lower), times(upper))
            });
            format!("{:>8} {interval:<19}{wins}", times(value))
        }
        None => "no episodes".to_string(),
    }
}

fn times(log_ratio: f64) -> String {
    let ratio = log_ratio.exp();
    if ratio.is_infinite() {
        "inf".into()
    } else {
        format!("{ratio:.2}x")
    }
}

fn failures_text(comparison: &PairedComparison) -> String {
    let failures = &comparison.failures;
    let difference = comparison.known().map_or(String::new(), |difference| {
        let interval = difference.interval.map_or(String::new(), |interval| {
            format!(
                " [{:+.2}, {:+.2}]",
                100.0 * interval.lower,
                100.0 * interval.upper
            )
        });
        format!("{:+.2} points{interval}, ", 100.0 * difference.value)
    });
    format!(
        "{difference}only {} {}, only {} {}, both {}{}",
        comparison.a,
        failures.only_a,
        comparison.b,
        failures.only_b,
        failures.both,
        comparison.mid_p.map_or(String::new(), |mid_p| format!(
            ", McNemar mid-p {}",
            if mid_p < 0.001 {
                format!("{mid_p:.1e}")
            } else {
                format!("{mid_p:.3}")
            }
        )),
    )
}
