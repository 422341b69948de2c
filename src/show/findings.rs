//! What a run found, for people and for programs.

use super::line;
use serde_json::{Value, json};
use std::path::Path;
use urts_mc::campaign::Campaign;
use urts_mc::comparison::{FailureRate, LEVEL, PairedComparison, Ratio};
use urts_mc::cross_check::{CrossCheck, ERROR_LIMIT, RMSE_LIMIT};
use urts_mc::flight::{Engine, Leg};
use urts_mc::ranking::RankedCondition;
use urts_mc::run::Findings;
use urts_mc::statistics::{Estimate, Interval, runs_needed};
use urts_mc::synthesis::ChannelRole;

/// Channels that are shown one by one.
const MOST_CHANNELS: usize = 6;

/// Conditions that are shown of each target.
const STRONGEST: usize = 3;
/// The p-value, corrected for all conditions of a target, at or below which an effect is shown.
const SURE: f64 = 0.05;

/// The findings of a run at a glance.
pub(crate) fn findings(campaign: &Campaign, findings: &Findings<'_>, out: &Path) -> String {
    let mut text = String::new();
    let manifest = &findings.manifest;
    let precision = format!("{:?}", manifest.precision).to_lowercase();
    let engines: Vec<String> = manifest.legs.iter().map(engine).collect();
    line(
        &mut text,
        &format!(
            "{}: {} episodes x {} {}, seed {}, {precision} on {}, {:.1} s of flying",
            campaign.name,
            manifest.episodes,
            campaign.team,
            campaign.agent.noun(campaign.team),
            campaign.seed,
            engines.join(", then on "),
            manifest.times.loop_s
        ),
    );
    for note in &manifest.notes {
        line(&mut text, &format!("note: {note}"));
    }
    if let Some(check) = &manifest.cross_check {
        line(&mut text, &cross_check(check, campaign.controllers.len()));
    }
    line(
        &mut text,
        &match campaign.team {
            1 => "\nfailures".to_string(),
            _ => format!(
                "\nfailures (an episode fails with any of its {})",
                campaign.agent.plural()
            ),
        },
    );
    line(
        &mut text,
        &format!(
            "  {:<12} {:>14}  {:>8}  {:<19} {}",
            "controller", "failed", "rate", "Wilson 95 %", "95 % sure below"
        ),
    );
    for failures in rates(findings, "all") {
        line(
            &mut text,
            &format!(
                "  {:<12} {:>14}  {:>7.2}%  {:<19} {:.2}%{}",
                failures.controller,
                format!("{} of {}", failures.failed(), failures.n),
                100.0 * failures.rate(),
                format!(
                    "{:.2} .. {:.2}%",
                    100.0 * failures.wilson.lower,
                    100.0 * failures.wilson.upper
                ),
                100.0 * failures.upper_95,
                if failures.diverged > 0 {
                    format!("  ({} diverged)", failures.diverged)
                } else {
                    String::new()
                },
            ),
        );
    }
    line(
        &mut text,
        "\nRMS error from settle_s on, median [95 % interval] and 95th percentile over the episodes",
    );
    let roles: Vec<ChannelRole> = campaign
        .channel_groups()
        .iter()
        .map(|group| group.role)
        .collect();
    let mut head = format!("  {:<12}", "controller");
    for role in &roles {
        let title = format!("{}, {}", role.name(), role.unit());
        head.push_str(&format!(" {title:>34} "));
    }
    line(&mut text, head.trim_end());
    for name in &campaign.controllers {
        let cell = |group: &str| {
            let row = findings.summary.iter().find(|row| {
                row.failures.controller == *name
                    && row.failures.stratum == "all"
                    && row.metric == "rmse"
                    && row.group == group
            });
            row.map_or(String::new(), |row| {
                let value = |k: usize| {
                    row.quantiles[k]
                        .1
                        .map_or("-".to_string(), |value| format!("{value:.4}"))
                };
                let interval = row.quantiles[0].2.map_or(String::new(), |i| {
                    format!(" [{:.4}, {:.4}]", i.lower, i.upper)
                });
                format!("{}{interval}, {}", value(0), value(1))
            })
        };
        let mut cells = format!("  {name:<12}");
        for role in &roles {
            cells.push_str(&format!(" {:>34} ", cell(role.name())));
        }
        line(&mut text, cells.trim_end());
    }
    if !findings.comparisons.is_empty() {
        line(
            &mut text,
            "\npair by pair: how many times smaller the RMS error of the first is, median [BCa 95 %], and how often it wins",
        );
    }
    let names = campaign.channels().iter().map(|name| name.len());
    let width = names.max().unwrap_or(0).max(8);
    for comparison in &findings.comparisons {
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
    text.push_str(&what_matters(findings));
    text.push_str(&worst(findings, out));
    let times = manifest.times;
    line(
        &mut text,
        &format!(
            "\nwritten to {} (synthesis {:.1} s, flying {:.1} s, cross-check {:.1} s, statistics {:.1} s, writing {:.1} s)",
            out.display(),
            times.synthesis_s,
            times.loop_s,
            times.cross_check_s,
            times.statistics_s,
            times.writing_s
        ),
    );
    text
}

/// What flew some episodes.
fn engine(leg: &Leg) -> String {
    match &leg.engine {
        Engine::Cpu { simd, threads } => {
            let lanes = simd.map_or(String::new(), |simd| format!(" ({simd:?})").to_lowercase());
            format!("the CPU{lanes}, {threads} threads")
        }
        Engine::Gpu { adapter, .. } => format!("{} ({})", adapter.name, adapter.driver),
    }
}

fn cross_check(check: &CrossCheck, controllers: usize) -> String {
    let pairs = check.episodes.len() * controllers;
    let differences = if check.compared == 0 {
        format!("no errors compared (all {pairs} flights fail or saturate)")
    } else {
        format!(
            "|e| within {:.1e}, RMS error within {:.1e} relative ({} of {pairs} flights neither fail nor saturate)",
            check.largest_error_difference, check.largest_rmse_difference, check.compared,
        )
    };
    format!(
        "cross-check of {} episodes with f64 on the CPU: {differences}, {} of {pairs} verdicts differ",
        check.episodes.len(),
        check.verdicts_differ,
    )
}

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
        let remedy = match runs_needed(limit, LEVEL, rate.failed()) {
            Some(enough) if rate.failed() == 0 => format!("fly at least {enough} episodes"),
            Some(enough) if rate.rate() < limit => format!(
                "fly at least {enough} episodes, of which no more may fail, or change the controller or the limit"
            ),
            _ => "change the controller or the limit".to_string(),
        };
        format!(
            "{}: require[{index}].failure_rate_upper_95 = {limit}: {:?} failed in {} of {} episodes, so with 95 % \
             confidence its failure rate is known only to be below {:.4}; {remedy}",
            campaign.path.display(),
            requirement.controller,
            rate.failed(),
            rate.n,
            rate.upper_95,
        )
    });
    unmet.collect::<Vec<_>>().join("\n")
}

/// What raises failures and errors of each controller, as far as it is sure.
fn what_matters(findings: &Findings<'_>) -> String {
    let sure: Vec<&RankedCondition> = findings
        .ranking
        .iter()
        .filter(|ranked| ranked.target.kind != "log_ratio" && ranked.p_holm <= SURE)
        .collect();
    let mut text = String::new();
    if sure.is_empty() {
        return text;
    }
    line(
        &mut text,
        "\nwhat matters: rank correlation [95 %] with failures and with the RMS error, the strongest of those that are sure at 5 %",
    );
    for same in sure.chunk_by(|a, b| a.target == b.target) {
        let target = &same[0].target;
        let about = target.group.map_or("failures".to_string(), str::to_string);
        let strongest = same.iter().take(STRONGEST).map(|ranked| {
            let trend = &ranked.effect.trend;
            format!(
                "{} {:+.2} [{:+.2}, {:+.2}]",
                ranked.condition, trend.value, trend.interval.lower, trend.interval.upper
            )
        });
        let strongest: Vec<String> = strongest.collect();
        line(
            &mut text,
            &format!(
                "  {:<12} {about:<9} {}",
                target.controller,
                strongest.join(", ")
            ),
        );
    }
    text
}

/// The worst episode of each controller, and how to see it.
fn worst(findings: &Findings<'_>, out: &Path) -> String {
    let mut text = String::new();
    line(
        &mut text,
        "\nworst episode of each controller (worst.csv has ten)",
    );
    for worst in findings.worst.iter().filter(|worst| worst.rank == 1) {
        line(
            &mut text,
            &format!(
                "  {:<12} {}{}: urts-mc replay {} --episode {} --controller {}",
                worst.controller,
                worst.status.word(),
                if worst.excess.is_finite() {
                    format!(
                        ", |e| up to {:.2} of the limit on {} of agent {}",
                        worst.excess, worst.channel, worst.agent
                    )
                } else {
                    String::new()
                },
                out.display(),
                worst.episode,
                worst.controller
            ),
        );
    }
    text
}

/// The groups, and of many channels the one where the first controller gains least and the one where it gains most; and how many
/// are left out.
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
    match ratio.log_ratio {
        Some(Estimate {
            value,
            interval: Interval { lower, upper },
        }) => {
            let interval = format!("[{}, {}]", times(lower), times(upper));
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
    let difference = comparison.difference.map_or(String::new(), |difference| {
        format!(
            "{:+.2} % [{:+.2}, {:+.2}], ",
            100.0 * difference.value,
            100.0 * difference.interval.lower,
            100.0 * difference.interval.upper
        )
    });
    format!(
        "{difference}only {} {}, only {} {}, both {}, McNemar mid-p {:.2e}",
        comparison.a,
        failures.only_a,
        comparison.b,
        failures.only_b,
        failures.both,
        comparison.mid_p
    )
}

fn rates<'a>(findings: &'a Findings<'_>, stratum: &str) -> Vec<&'a FailureRate> {
    let mut rates: Vec<&FailureRate> = findings
        .summary
        .iter()
        .map(|row| &row.failures)
        .filter(|failures| failures.stratum == stratum)
        .collect();
    rates.dedup();
    rates
}

/// The findings of a run for programs.
pub(crate) fn findings_json(findings: &Findings<'_>) -> Value {
    let interval = |interval: Interval| json!([finite(interval.lower), finite(interval.upper)]);
    let estimate = |estimate: Option<Estimate>| {
        estimate.map(|estimate| json!({ "value": finite(estimate.value), "interval_95": interval(estimate.interval) }))
    };
    let rate = |rate: &FailureRate| {
        json!({
            "controller": rate.controller, "stratum": rate.stratum, "n": rate.n, "failed": rate.failed(),
            "exceeded": rate.exceeded, "diverged": rate.diverged, "failure_rate": rate.rate(),
            "wilson_95": interval(rate.wilson), "upper_95": rate.upper_95,
        })
    };
    json!({
        "manifest": findings.manifest,
        "failures": findings.summary.iter().map(|row| &row.failures).fold(Vec::new(), |mut rates, failures| {
            if rates.last() != Some(&failures) { rates.push(failures); }
            rates
        }).into_iter().map(rate).collect::<Vec<_>>(),
        "comparisons": findings.comparisons.iter().map(|comparison| json!({
            "a": comparison.a, "b": comparison.b,
            "both_failed": comparison.failures.both, "only_a_failed": comparison.failures.only_a,
            "only_b_failed": comparison.failures.only_b, "neither_failed": comparison.failures.neither,
            "mcnemar_mid_p": comparison.mid_p, "failure_rate_difference": estimate(comparison.difference),
            "log_ratios": comparison.ratios.iter().map(|ratio| json!({
                "scope": ratio.scope, "name": ratio.name, "log_ratio": estimate(ratio.log_ratio),
                "win_rate": estimate(ratio.win_rate), "diverged_only_a_only_b_both": ratio.diverged,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "ranking": findings.ranking.iter().map(|ranked| json!({
            "target": ranked.target.kind, "controller": ranked.target.controller, "against": ranked.target.against,
            "group": ranked.target.group, "condition": ranked.condition, "episodes": ranked.effect.n,
            "trend": estimate(Some(ranked.effect.trend)), "shape": ranked.effect.shape, "p_holm": ranked.p_holm,
        })).collect::<Vec<_>>(),
        "worst_episodes": findings.worst.iter().map(|worst| json!({
            "controller": worst.controller, "rank": worst.rank, "episode": worst.episode, "status": worst.status.word(),
            "largest_error_over_limit": finite(worst.excess), "agent": worst.agent, "channel": *worst.channel,
        })).collect::<Vec<_>>(),
        "unmet_requirements": findings.unmet.iter().map(|(requirement, found)| json!({
            "controller": requirement.controller, "limit": requirement.failure_rate_upper_95, "found": rate(found),
        })).collect::<Vec<_>>(),
    })
}

/// JSON has no infinity: it is written as null, as in the Parquet tables' readers.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
