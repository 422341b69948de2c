//! What a campaign would do.

use super::line;
use serde_json::{Value, json};
use urts_mc::campaign::{Agent, Campaign, Goal, StratumFaults};
use urts_mc::draw::draw;
use urts_mc::gains::GainSet;

/// Episodes that `check` draws to show real ranges.
const SHOWN_DRAWS: u32 = 200;

/// What a campaign would do.
pub(crate) fn plan(campaign: &Campaign, gains: &GainSet) -> String {
    let mut text = String::new();
    let steps = f64::from(campaign.time.steps);
    let agents = campaign.agent.plural();
    // As the benchmarks found.
    let rate = match campaign.agent {
        Agent::Uav(_) => 25.0,
        Agent::Biped(_) => 4.0,
    };
    let work =
        steps * f64::from(campaign.episodes) * (campaign.team * campaign.controllers.len()) as f64;
    line(
        &mut text,
        &format!("{}: {}", campaign.path.display(), campaign.name),
    );
    line(
        &mut text,
        &format!(
            "  {} episodes of {} {} over {} s in steps of {} s, seed {}",
            campaign.episodes,
            campaign.team,
            campaign.agent.noun(campaign.team),
            steps * campaign.time.step_s,
            campaign.time.step_s,
            campaign.seed
        ),
    );
    line(
        &mut text,
        &format!(
            "  controllers {}: {:.2e} steps of {agents}, about {:.0} s on one core with 16 SIMD lanes (at {rate} million a second)",
            campaign.controllers.join(", "),
            work,
            (work / (1e6 * rate)).ceil()
        ),
    );
    for sentence in design(campaign) {
        line(&mut text, &format!("  {sentence}"));
    }
    for controller in &gains.controllers {
        for (group, channel) in campaign.channel_groups().iter().zip(&controller.groups) {
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
                    "  gains of {} on {}: {}{level}",
                    controller.name,
                    group.role.name(),
                    controller.source
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

/// How the episodes are divided, drawn and ended, where that is not as usual.
fn design(campaign: &Campaign) -> Vec<String> {
    let mut sentences = Vec::new();
    let strata = &campaign.strata;
    for stratum in strata.all() {
        let faults = match &stratum.faults {
            StratumFaults::Drawn => "all faults, each with its own probability".to_string(),
            StratumFaults::Certain(faults) if faults.is_empty() => "no fault".to_string(),
            StratumFaults::Certain(faults) => {
                let names = faults.iter().filter_map(|&k| campaign.faults.get(k));
                let names: Vec<&str> = names.map(|fault| &*fault.name).collect();
                format!("{} in every agent", names.join(" + "))
            }
        };
        sentences.push(format!(
            "stratum {:?}: {} of every {} episodes, {faults}",
            stratum.name,
            stratum.share,
            strata.turn()
        ));
    }
    if let Some(replicates) = campaign.sampling.replicates() {
        sentences.push(format!(
            "sampling: {:?}, {replicates} replicates of {} episodes",
            campaign.sampling.design(),
            campaign.episodes / replicates.max(1)
        ));
    }
    if let Some(stop) = &campaign.stop {
        let goal = |goal: &Goal| match goal {
            Goal::Below(limit) => format!("is below {limit}"),
            Goal::Above(limit) => format!("is above {limit}"),
            Goal::HalfWidth(width) => format!("is known to within {width} either way"),
        };
        let goals: Vec<String> = stop.goals.iter().map(goal).collect();
        sentences.push(format!(
            "stops early once it is {} % sure that the failure rate of {} {}; it looks every {} episodes",
            100.0 * stop.confidence,
            campaign.controllers[stop.controller],
            goals.join(" or "),
            stop.every
        ));
    }
    sentences
}

/// [`plan`] for programs.
pub(crate) fn plan_json(campaign: &Campaign) -> Value {
    json!({
        "name": campaign.name, "episodes": campaign.episodes, "team": campaign.team, "seed": campaign.seed,
        "strata": campaign.strata.all().iter().map(|stratum| json!({
            "name": *stratum.name, "share": stratum.share,
        })).collect::<Vec<_>>(),
        "design": design(campaign),
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
            if let Agent::Uav(_) = campaign.agent {
                add("inertia_scale".into(), &[agent.inertia_scale]);
            }
            add("kappa".into(), &[agent.kappa]);
            if campaign.control.delay_s.is_some() {
                add("control delay_s".into(), &[agent.control_delay_s]);
            }
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
                    if fault.duration_s.is_some() {
                        add(format!("fault[{k}] {kind} duration_s"), &[draw.duration_s]);
                    }
                    if fault.ramp_s.is_some() {
                        add(format!("fault[{k}] {kind} ramp_s"), &[draw.ramp_s]);
                    }
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
