//! What the commands print.

use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use urts_mc::campaign::{Campaign, FTC, PID, PID_TUNED, UAV_CHANNELS};
use urts_mc::comparison::{FailureRate, PairedComparison, Ratio};
use urts_mc::draw::draw;
use urts_mc::gains::{self, ChannelController, GainSet, ROLES, built_in};
use urts_mc::replay::Replay;
use urts_mc::run::Findings;
use urts_mc::statistics::{Estimate, Interval};
use urts_mc::synthesis::{ChannelSynthesis, ControllerGains};

/// Episodes that `check` draws to show real ranges.
const SHOWN_DRAWS: u32 = 200;

/// The findings of a run at a glance.
pub(crate) fn findings(campaign: &Campaign, findings: &Findings<'_>, out: &Path) -> String {
    let mut text = String::new();
    let manifest = &findings.manifest;
    let simd = manifest
        .simd
        .map_or(String::new(), |simd| format!(" {simd:?}").to_lowercase());
    let precision = format!("{:?}", manifest.precision).to_lowercase();
    line(
        &mut text,
        &format!(
            "{}: {} episodes x {} UAVs, seed {}, {precision}{simd} on the CPU, {} threads, {:.1} s of flying",
            campaign.name,
            campaign.episodes,
            campaign.team,
            campaign.seed,
            manifest.threads,
            manifest.times.loop_s
        ),
    );
    line(
        &mut text,
        "\nfailures (an episode fails with any of its UAVs)",
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
    line(
        &mut text,
        &format!(
            "  {:<12} {:>34}  {:>34}",
            "controller", "position, m", "attitude, rad"
        ),
    );
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
        line(
            &mut text,
            &format!(
                "  {name:<12} {:>34}  {:>34}",
                cell("position"),
                cell("attitude")
            ),
        );
    }
    if !findings.comparisons.is_empty() {
        line(
            &mut text,
            "\npair by pair: how many times smaller the RMS error of the first is, median [BCa 95 %], and how often it wins",
        );
    }
    for comparison in &findings.comparisons {
        line(
            &mut text,
            &format!("  {} against {}", comparison.a, comparison.b),
        );
        for ratio in &comparison.ratios {
            line(
                &mut text,
                &format!("    {:<9} {}", ratio.name, ratio_text(ratio)),
            );
        }
        line(
            &mut text,
            &format!("    failures  {}", failures_text(comparison)),
        );
    }
    let times = manifest.times;
    line(
        &mut text,
        &format!(
            "\nwritten to {} (synthesis {:.1} s, flying {:.1} s, statistics {:.1} s, writing {:.1} s)",
            out.display(),
            times.synthesis_s,
            times.loop_s,
            times.statistics_s,
            times.writing_s
        ),
    );
    text
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
        let remedy = if rate.failed() == 0 && limit > 0.0 {
            let enough = (0.05_f64.ln() / (-limit).ln_1p()).ceil();
            format!("fly at least {enough} episodes")
        } else if rate.rate() < limit {
            "fly more episodes, or change the controller or the limit".to_string()
        } else {
            "change the controller or the limit".to_string()
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

fn ratio_text(ratio: &Ratio) -> String {
    let wins = ratio.win_rate.map_or(String::new(), |rate| {
        format!("  wins {:>5.1} %", 100.0 * rate.value)
    });
    let diverged: u64 = ratio.diverged.iter().sum();
    let note = if diverged > 0 {
        format!("  (a diverged episode counts as infinitely bad: {diverged} pairs)")
    } else {
        String::new()
    };
    match ratio.log_ratio {
        Some(Estimate {
            value,
            interval: Interval { lower, upper },
        }) => {
            let interval = format!("[{}, {}]", times(lower), times(upper));
            format!("{:>8} {interval:<19}{wins}{note}", times(value))
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
        "unmet_requirements": findings.unmet.iter().map(|(requirement, found)| json!({
            "controller": requirement.controller, "limit": requirement.failure_rate_upper_95, "found": rate(found),
        })).collect::<Vec<_>>(),
    })
}

/// JSON has no infinity: it is written as null, as in the Parquet tables' readers.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// What a campaign would do.
pub(crate) fn plan(campaign: &Campaign, gains: &GainSet) -> String {
    let mut text = String::new();
    let steps = f64::from(campaign.time.steps);
    let work =
        steps * f64::from(campaign.episodes) * (campaign.team * campaign.controllers.len()) as f64;
    line(
        &mut text,
        &format!("{}: {}", campaign.path.display(), campaign.name),
    );
    line(
        &mut text,
        &format!(
            "  {} episodes of {} UAVs over {} s in steps of {} s, seed {}",
            campaign.episodes,
            campaign.team,
            steps * campaign.time.step_s,
            campaign.time.step_s,
            campaign.seed
        ),
    );
    line(
        &mut text,
        &format!(
            "  controllers {}: {:.2e} UAV-steps, about {:.0} s on one core with 16 SIMD lanes (at 25 million a second)",
            campaign.controllers.join(", "),
            work,
            (work / 25e6).ceil()
        ),
    );
    for controller in &gains.controllers {
        for (role, channel) in ROLES.iter().zip(&controller.channels) {
            let level = channel
                .findings
                .as_ref()
                .and_then(|findings| findings.certificate.as_ref());
            let level = level.map_or(String::new(), |certificate| {
                format!(", certified rho {:.3}", certificate.rho)
            });
            line(
                &mut text,
                &format!(
                    "  gains of {} on {role}: {}{level}",
                    controller.name, controller.source
                ),
            );
        }
    }
    line(
        &mut text,
        &format!(
            "  drawn in the first {} episodes, as applied (lowest .. highest):",
            SHOWN_DRAWS.min(campaign.episodes)
        ),
    );
    for (name, low, high, count) in ranges(campaign) {
        let range = if low >= high {
            format!("{low:.6}")
        } else {
            format!("{low:.6} .. {high:.6}")
        };
        line(
            &mut text,
            &format!("    {name:<42} {range}   ({count} values)"),
        );
    }
    text
}

/// [`plan`] for programs.
pub(crate) fn plan_json(campaign: &Campaign) -> Value {
    json!({
        "name": campaign.name, "episodes": campaign.episodes, "team": campaign.team, "seed": campaign.seed,
        "steps": campaign.time.steps, "step_s": campaign.time.step_s, "controllers": campaign.controllers,
        "drawn": ranges(campaign).into_iter().map(|(name, low, high, count)| json!({
            "name": name, "lowest": low, "highest": high, "values": count,
        })).collect::<Vec<_>>(),
    })
}

/// The range of every quantity over the first episodes: name, lowest, highest, number of values.
fn ranges(campaign: &Campaign) -> Vec<(String, f64, f64, usize)> {
    let mut drawn: Vec<(String, Vec<f64>)> = Vec::new();
    let mut add =
        |name: String, values: &[f64]| match drawn.iter_mut().find(|(own, _)| *own == name) {
            Some((_, all)) => all.extend(values),
            None => drawn.push((name, values.to_vec())),
        };
    for episode in 0..SHOWN_DRAWS.min(campaign.episodes) {
        for agent in draw(campaign, episode).agents {
            add("mass_scale".into(), &[agent.mass_scale]);
            add("inertia_scale".into(), &[agent.inertia_scale]);
            add("kappa".into(), &[agent.kappa]);
            add("initial error".into(), &agent.error);
            add("initial error_rate".into(), &agent.error_rate);
            add("initial error_integral".into(), &agent.error_integral);
            for (k, (disturbance, values)) in campaign
                .disturbances
                .iter()
                .zip(&agent.disturbances)
                .enumerate()
            {
                for (parameter, values) in disturbance.kind.parameters().iter().zip(values) {
                    add(format!("disturbance[{k}] {}", parameter.name), values);
                }
            }
            for (k, (fault, draw)) in campaign.faults.iter().zip(&agent.faults).enumerate() {
                let struck = |values: &[f64]| -> Vec<f64> {
                    values
                        .iter()
                        .zip(&draw.strikes)
                        .filter(|(_, strikes)| **strikes)
                        .map(|(value, _)| *value)
                        .collect()
                };
                let kind = fault.kind.name();
                add(
                    format!("fault[{k}] {kind} occurs"),
                    &[f64::from(u8::from(draw.occurs()))],
                );
                if draw.occurs() {
                    add(format!("fault[{k}] {kind} onset_s"), &[draw.onset_s]);
                }
                for (parameter, values) in fault.kind.parameters().iter().zip(&draw.parameters) {
                    add(
                        format!("fault[{k}] {kind} {}", parameter.name),
                        &struck(values),
                    );
                }
            }
        }
    }
    drawn
        .into_iter()
        .filter(|(_, values)| !values.is_empty())
        .map(|(name, values)| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (name, low, high, values.len())
        })
        .collect()
}

/// The gains of a campaign and what is known about them.
pub(crate) fn gains(campaign: &Campaign, gains: &GainSet) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "{}: preset {}",
            campaign.path.display(),
            campaign.synthesis.preset
        ),
    );
    let same = campaign.synthesis.designs[0] == campaign.synthesis.designs[1];
    for controller in &gains.controllers {
        line(
            &mut text,
            &format!("\n{} ({})", controller.name, controller.source),
        );
        if same && controller.channels[0].gains == controller.channels[1].gains {
            line(&mut text, "  position and attitude channels");
            channel(
                &mut text,
                &controller.channels[0].gains,
                controller.channels[0].findings.as_ref(),
            );
        } else {
            for (role, name) in ROLES.iter().enumerate() {
                line(&mut text, &format!("  {name} channels"));
                let ChannelController {
                    gains, findings, ..
                } = &controller.channels[role];
                channel(&mut text, gains, findings.as_ref());
            }
        }
    }
    text
}

/// The gains of a preset's channel type and what is known about them.
pub(crate) fn synthesis(role: &str, synthesis: &ChannelSynthesis) -> String {
    let mut text = String::new();
    for name in [FTC, PID, PID_TUNED] {
        line(&mut text, &format!("{name}, {role} channels"));
        let (gains, findings) = built_in(synthesis, name);
        channel(&mut text, gains, Some(&findings));
    }
    text
}

fn channel(text: &mut String, gains: &ControllerGains, findings: Option<&gains::Findings>) {
    let numbers = |values: &[f64]| {
        values
            .iter()
            .map(|value| format!("{value:.5}"))
            .collect::<Vec<_>>()
            .join("  ")
    };
    line(text, &format!("    K  {}", numbers(&gains.k)));
    for (row, values) in gains.l.iter().enumerate() {
        line(
            text,
            &format!(
                "    {}  {}",
                if row == 0 { "L" } else { " " },
                numbers(values)
            ),
        );
    }
    let Some(findings) = findings else {
        return;
    };
    let poles = |poles: &[[f64; 2]]| {
        let pole = |[re, im]: &[f64; 2]| {
            if *im == 0.0 {
                format!("{re:.3}")
            } else {
                format!("{re:.3}{im:+.3}i")
            }
        };
        poles.iter().map(pole).collect::<Vec<_>>().join("  ")
    };
    line(
        text,
        &format!(
            "    poles of A + B K, 1/s  {}",
            poles(&findings.analysis.controller_poles)
        ),
    );
    line(
        text,
        &format!(
            "    poles of A + L C, 1/s  {}",
            poles(&findings.analysis.observer_poles)
        ),
    );
    let margins = &findings.analysis.margins;
    line(
        text,
        &format!(
            "    margins  Ms {:.3}, phase {:.1} deg, delay {:.2} ms at {:.1} rad/s",
            margins.sensitivity_peak,
            margins.phase_margin_deg,
            margins.delay_margin_ms,
            margins.crossover_rad_s
        ),
    );
    if let Some(certificate) = &findings.certificate {
        line(
            text,
            &format!(
                "    certified attenuation rho {:.4} (true H-infinity norm {:.4}); largest eigenvalue of (27) {:.2e}",
                certificate.rho, certificate.hinf_norm, certificate.max_eigenvalue
            ),
        );
    }
    for solved in &findings.solver {
        line(
            text,
            &format!(
                "    solver  {}: {} in {} iterations",
                solved.step, solved.status, solved.iterations
            ),
        );
    }
    for check in &findings.checks {
        let sign = if check.passed { "ok" } else { "FAILED" };
        line(
            text,
            &format!(
                "    check   {sign}  {}: {}: {:.3e}, must be below {:.3e}",
                check.step, check.name, check.value, check.limit
            ),
        );
    }
}

/// How a replayed episode went.
pub(crate) fn replay(replay: &Replay, episode: u32, controller: &str, path: &Path) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "episode {episode} under {controller}: RMS error and largest error from settle_s on"
        ),
    );
    for (agent, outcome) in replay.outcomes.iter().enumerate() {
        let ending = match (outcome.diverged, outcome.failed_step) {
            (true, step) => format!(
                "  diverged at {:.3} s",
                f64::from(step.unwrap_or(replay.campaign.time.steps)) * replay.campaign.time.step_s
            ),
            (false, Some(step)) => format!(
                "  exceeded max_error at {:.3} s",
                f64::from(step) * replay.campaign.time.step_s
            ),
            (false, None) => String::new(),
        };
        line(&mut text, &format!("  agent {agent}{ending}"));
        for (name, metrics) in UAV_CHANNELS.iter().zip(&outcome.channels) {
            line(
                &mut text,
                &format!(
                    "    {name:<6} {:>10.5}  {:>10.5}",
                    metrics.rmse, metrics.max_abs
                ),
            );
        }
    }
    if !replay.same_arithmetic {
        line(
            &mut text,
            "flown in f64: this processor lacks the run's lanes, so digits beyond single precision differ",
        );
    }
    line(
        &mut text,
        &format!(
            "written to {} ({} samples)",
            path.display(),
            replay.snapshots.len()
        ),
    );
    text
}

fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}
