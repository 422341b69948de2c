//! How often each controller fails in each stratum, and what hurts it most.

use super::style::heading;
use super::text::{kind_of_interval, line};
use crate::campaign::Campaign;
use crate::results::FailureRate;
use crate::run::Findings;

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
                let rates = findings.results.failures.iter();
                let of_all = rates.filter(|rate| rate.agents.is_none());
                let mut own = of_all.filter(|rate| rate.stratum == stratum.name);
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
    let sentences = &findings.manifest.harm;
    if !sentences.is_empty() {
        let title = heading("which stratum hurts most");
        line(&mut text, &format!("\n{title}, change [95 %]"));
    }
    for sentence in sentences {
        line(&mut text, &format!("  {sentence}"));
    }
    text
}

fn rate_text(rate: &FailureRate) -> String {
    let interval = rate.interval.map_or(String::new(), |interval| {
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
