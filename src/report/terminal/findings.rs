//! What a run found, for people.

use super::attenuation;
use super::conclusion::{in_short, requirements};
use super::pairs::pairs;
use super::screening::strata;
use super::style::heading;
use super::text::{kind_of_interval, line};
use crate::campaign::{ALL, Campaign};
use crate::draw::quantities::title;
use crate::report::notes::caveats;
use crate::results::FailureRate;
use crate::results::sensitivity::SensitivityResult;
use crate::run::Findings;
use crate::run::manifest::Manifest;
use crate::run::replay::command;
use crate::simulation::Times;
use crate::simulation::cross_check::CrossCheck;
use crate::statistics::SIGNIFICANCE;
use crate::util::format::{digits, rounded_up};
use std::path::Path;

/// Conditions that are shown of each target.
const STRONGEST: usize = 3;

/// The findings of a run at a glance.
pub fn findings(campaign: &Campaign, findings: &Findings, out: &Path) -> String {
    let mut text = simulated(campaign, &findings.manifest);
    text.push_str(&failure_rates(campaign, findings));
    for caveat in caveats(campaign, &findings.manifest) {
        line(&mut text, &caveat);
    }
    text.push_str(&strata(campaign, findings));
    text.push_str(&rms_errors(campaign, findings));
    text.push_str(&pairs(campaign, findings));
    text.push_str(&what_matters(campaign, findings));
    text.push_str(&worst(findings, out));
    text.push_str(&in_short(campaign, findings));
    text.push_str(&requirements(&findings.manifest.requirements));
    text.push_str(&written(findings.manifest.times, out));
    text
}

/// What was simulated on what, and the cross-check.
fn simulated(campaign: &Campaign, manifest: &Manifest) -> String {
    let mut text = String::new();
    let precision = format!("{:?}", manifest.precision).to_lowercase();
    let engines = manifest
        .segments
        .iter()
        .map(|segment| segment.engine.to_string());
    let engines: Vec<String> = engines.collect();
    line(
        &mut text,
        &format!(
            "{}: {} x {}, seed {}, {precision} on {}, {:.1} s of simulation",
            heading(&campaign.name),
            counted(manifest.episodes),
            campaign.agents_in_words(),
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
        text.push_str(&attenuation::groups(&check.attenuation));
    }
    text
}

/// How often each controller failed.
fn failure_rates(campaign: &Campaign, findings: &Findings) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &match campaign.agents() {
            1 => format!("\n{}", heading("failures")),
            _ => format!(
                "\n{} (an episode fails with any of its {})",
                heading("failures"),
                campaign.plural()
            ),
        },
    );
    line(
        &mut text,
        &format!(
            "  {:<12} {:>14}  {:>8}  {:<19} {}",
            "controller",
            "failed",
            "rate",
            kind_of_interval(campaign),
            "95 % sure below"
        ),
    );
    let of_all = |rate: &&FailureRate| *rate.stratum == *ALL;
    for failures in findings.results.failures.iter().filter(of_all) {
        let name = match &failures.agents {
            None => failures.controller.clone(),
            Some(group) => format!("  {group}"),
        };
        line(
            &mut text,
            &format!(
                "  {name:<12} {:>14}  {:>7.2}%  {:<19} {}{}",
                format!("{} of {}", failures.failed(), failures.n),
                100.0 * failures.rate(),
                failures
                    .interval
                    .map_or("-".to_string(), |interval| format!(
                        "{:.2} .. {:.2}%",
                        100.0 * interval.lower,
                        100.0 * interval.upper
                    )),
                failures.upper_95.map_or("-".to_string(), |upper| format!(
                    "{}%",
                    rounded_up(100.0 * upper, 2)
                )),
                if failures.diverged > 0 {
                    format!("  ({} diverged)", failures.diverged)
                } else {
                    String::new()
                },
            ),
        );
    }
    text
}

/// How large the errors of each controller were.
fn rms_errors(campaign: &Campaign, findings: &Findings) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "\n{}, median [95 % interval] and 95th percentile over the episodes",
            heading("RMS error from settle_s on")
        ),
    );
    let roles = campaign.channel_groups();
    let mut head = format!("  {:<12}", "controller");
    for role in &roles {
        let title = format!("{}, {}", role.name, role.role.unit());
        head.push_str(&format!(" {title:>34} "));
    }
    line(&mut text, head.trim_end());
    for name in &campaign.controllers {
        let cell = |group: &str| {
            let row = findings.results.summary.iter().find(|row| {
                row.failures.controller == *name
                    && *row.failures.stratum == *ALL
                    && row.metric == "rmse"
                    && *row.group == *group
            });
            row.map_or(String::new(), |row| {
                let number = |value: f64| digits(value, 3);
                let value = |k: usize| row.quantiles[k].value.map_or("-".to_string(), number);
                let interval = row.quantiles[0].interval.map_or(String::new(), |i| {
                    format!(" [{}, {}]", number(i.lower), number(i.upper))
                });
                format!("{}{interval}, {}", value(0), value(1))
            })
        };
        let mut cells = format!("  {name:<12}");
        for role in &roles {
            cells.push_str(&format!(" {:>34} ", cell(&role.name)));
        }
        line(&mut text, cells.trim_end());
    }
    text
}

/// Where the files are, and how long it all took.
fn written(times: Times, out: &Path) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "\nwritten to {} (synthesis {:.1} s, simulation {:.1} s, cross-check {:.1} s, statistics {:.1} s, writing {:.1} s)",
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

/// So many episodes.
fn counted(episodes: u32) -> String {
    match episodes {
        1 => "1 episode".to_string(),
        many => format!("{many} episodes"),
    }
}

fn cross_check(check: &CrossCheck, controllers: usize) -> String {
    let pairs = check.episodes.len() * controllers;
    let differences = if check.compared == 0 {
        format!("no errors compared (all {pairs} episodes fail or saturate)")
    } else {
        format!(
            "|e| within {:.1e}, RMS error within {:.1e} relative ({} of {pairs} episodes neither fail nor saturate)",
            check.largest_error_difference, check.largest_rmse_difference, check.compared,
        )
    };
    let sensitive = match check.sensitive {
        0 => String::new(),
        count => format!("; {count} left out: {}", CrossCheck::SENSITIVE),
    };
    format!(
        "cross-check of {} episodes with f64 on the CPU: {differences}, {} of {pairs} verdicts differ{sensitive}",
        check.episodes.len(),
        check.verdicts_differ,
    )
}

/// What raises failures and errors of each controller, as far as it is sure.
fn what_matters(campaign: &Campaign, findings: &Findings) -> String {
    let sure: Vec<&SensitivityResult> = findings
        .results
        .ranking
        .iter()
        .filter(|ranked| ranked.target.kind != "log_ratio")
        .filter(|ranked| ranked.p_holm.is_some_and(|p_holm| p_holm <= SIGNIFICANCE))
        .collect();
    let mut text = String::new();
    if sure.is_empty() {
        return text;
    }
    line(
        &mut text,
        &format!(
            "\n{}: rank correlation [95 %] with failures and with the RMS error, the strongest of those that are sure at 5 %",
            heading("what matters")
        ),
    );
    for same in sure.chunk_by(|a, b| a.target == b.target) {
        let target = &same[0].target;
        let about = target.group.as_deref().unwrap_or("failures");
        let strongest = same.iter().take(STRONGEST).map(|ranked| {
            let interval = ranked.trend.interval.map_or(String::new(), |interval| {
                format!(" [{:+.2}, {:+.2}]", interval.lower, interval.upper)
            });
            let condition = title(campaign, &ranked.condition);
            format!("{condition} {:+.2}{interval}", ranked.trend.value)
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
fn worst(findings: &Findings, out: &Path) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "\n{} (worst.csv has ten)",
            heading("worst episode of each controller")
        ),
    );
    for worst in findings
        .results
        .worst
        .iter()
        .filter(|worst| worst.rank == 1)
    {
        line(
            &mut text,
            &format!(
                "  {:<12} {}{}: {}",
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
                command(out, worst.episode, &worst.controller)
            ),
        );
    }
    text
}
