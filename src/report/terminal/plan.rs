//! What a campaign would do.

use super::drawn::{drawn, drawn_json};
use super::effort::{lasting, seconds, steps, table_seconds};
use crate::campaign::lints::cautions;
use crate::campaign::{Campaign, Detail, Fault, Goal, Stratum, StratumFaults};
use crate::controllers::{self, GainSet};
use crate::report::page::document::{Block, Document, Section};
use crate::report::page::text::text;
use crate::results::extent::Extent;
use crate::util::format::bytes;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Columns of a wrapped line.
const WIDTH: usize = 96;

/// What a campaign would do.
pub fn plan(campaign: &Campaign, gains: &[GainSet], extent: Extent) -> String {
    let mut lead = vec![
        format!(
            "{} episodes of {} over {} s in steps of {} s, seed {}",
            campaign.episodes,
            campaign.agents_in_words(),
            campaign.time.shown_s(campaign.time.steps),
            campaign.time.step_s,
            campaign.seed
        ),
        format!(
            "controllers {}: {:.2e} steps of {}, roughly {} on one core with 16 SIMD lanes",
            campaign.controllers.join(", "),
            steps(campaign),
            campaign.plural(),
            lasting(seconds(campaign))
        ),
    ];
    lead.push(room(campaign, extent));
    lead.extend(design(campaign).iter().map(|sentence| wrapped(sentence)));
    for (index, name) in campaign.controllers.iter().enumerate() {
        let of_groups = gains.iter().map(|gains| &gains.controllers[index]);
        let channels =
            of_groups.flat_map(|own| own.groups.iter().map(move |channel| (own, channel)));
        for (group, (controller, channel)) in campaign.channel_groups().iter().zip(channels) {
            let level = channel.certificate().map_or(String::new(), |certificate| {
                format!(", certified rho {:.3}", certificate.rho)
            });
            lead.push(format!(
                "gains of {name} on {}: {}{level}",
                group.name, controller.source
            ));
        }
    }
    let of_gains = controllers::cautions(campaign, gains);
    let cautions = cautions(campaign).into_iter().chain(of_gains);
    let cautions = cautions.map(|caution| Block::Text(wrapped(&format!("note: {caution}"))));
    text(&Document {
        title: campaign.path.display().to_string(),
        subtitle: campaign.name.clone(),
        lead,
        sections: vec![drawn(campaign), Section::new("", cautions.collect())],
        ..Document::default()
    })
}

/// How much room the results take in each detail, and how much longer they take for it.
fn room(campaign: &Campaign, extent: Extent) -> String {
    let of_detail = |(detail, size): (Detail, u64)| {
        let mark = if detail == campaign.detail {
            " (as asked)"
        } else {
            ""
        };
        format!(
            "{} and {} of one core in detail {:?}{mark}",
            bytes(size),
            lasting(table_seconds(size)),
            detail.word()
        )
    };
    let details = Detail::ALL.into_iter().zip(extent.tables);
    let details: Vec<String> = details.skip(1).map(of_detail).collect();
    wrapped(&format!(
        "large tables: about {}, none in \"summary\"; memory for the statistics: about {}",
        details.join(", "),
        bytes(extent.memory)
    ))
}

/// How the episodes are divided, drawn and ended, where that is not as usual.
fn design(campaign: &Campaign) -> Vec<String> {
    let mut sentences = Vec::new();
    strata(campaign, &mut sentences);
    if let Some(replicates) = campaign.sampling.replicates() {
        sentences.push(format!(
            "draws: {replicates} {} of {} episodes",
            campaign.sampling.design().replicates_noun(),
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

/// What is simulated in each stratum. Those of a fault alone, which has their name, are told together where they are of
/// one size.
fn strata(campaign: &Campaign, sentences: &mut Vec<String>) {
    let turn = campaign.strata.turn();
    let of_campaign: Vec<&Fault> = campaign.faults().map(|(_, fault)| fault).collect();
    let alone = |stratum: &Stratum| match &stratum.faults {
        StratumFaults::Certain(faults) => match faults.as_slice() {
            [] => false,
            // Faults of several groups that have one name.
            faults => faults
                .iter()
                .all(|&fault| of_campaign[fault].name == stratum.name),
        },
        StratumFaults::ByProbability => false,
    };
    let all = campaign.strata.all();
    for (index, stratum) in all.iter().enumerate() {
        let like = |other: &&Stratum| alone(other) && other.share == stratum.share;
        let share = stratum.share;
        if alone(stratum) {
            let names: Vec<&str> = all.iter().filter(like).map(|own| &*own.name).collect();
            if all[..index].iter().any(|other| like(&other)) {
                continue;
            }
            if let count @ 2.. = names.len() {
                sentences.push(format!(
                    "{count} strata of {share} of every {turn} episodes, in each one fault in {}: {}",
                    whom(&of_campaign),
                    names.join(", ")
                ));
                continue;
            }
        }
        let faults = match &stratum.faults {
            StratumFaults::ByProbability => "all faults, each with its own probability".to_string(),
            StratumFaults::Certain(faults) if faults.is_empty() => "no fault".to_string(),
            StratumFaults::Certain(faults) => {
                let faults: Vec<&Fault> = faults.iter().map(|&k| of_campaign[k]).collect();
                let mut names: Vec<&str> = faults.iter().map(|fault| &*fault.name).collect();
                names.dedup();
                format!("{} in {}", names.join(" + "), whom(&faults))
            }
        };
        sentences.push(format!(
            "stratum {:?}: {share} of every {turn} episodes, {faults}",
            stratum.name
        ));
    }
    let background = of_campaign.iter().filter(|fault| fault.background);
    let background: Vec<&str> = background.map(|fault| &*fault.name).collect();
    if !background.is_empty() && !all.is_empty() {
        sentences.push(format!(
            "in the background of all strata, each with its own probability: {}",
            background.join(", ")
        ));
    }
}

/// Who has faults that a stratum makes certain.
fn whom(faults: &[&Fault]) -> &'static str {
    if faults.iter().any(|fault| fault.spares_some()) {
        "every agent whose probability of it is not 0"
    } else {
        "every agent"
    }
}

/// A sentence in lines of moderate length: broken at commas, or where there are none between words.
fn wrapped(sentence: &str) -> String {
    let parts = sentence.split_inclusive(", ").flat_map(|part| {
        let whole = part.chars().count() < WIDTH / 2;
        part.split_inclusive(if whole { ", " } else { " " })
    });
    let length = |text: &str| text.trim_end().chars().count();
    let mut lines = vec![String::new()];
    for part in parts {
        match lines.last_mut() {
            Some(last) if last.chars().count() + length(part) <= WIDTH => last.push_str(part),
            _ => lines.push(part.to_string()),
        }
    }
    lines.join("\n")
}

/// [`plan`] for programs.
pub fn plan_json(campaign: &Campaign, gains: &[GainSet], extent: Extent) -> Value {
    let notes = [cautions(campaign), controllers::cautions(campaign, gains)].concat();
    let sizes = Detail::ALL.iter().zip(extent.tables);
    let sizes: BTreeMap<&str, u64> = sizes.map(|(own, size)| (own.word(), size)).collect();
    let times = sizes.iter().map(|(&own, &size)| (own, table_seconds(size)));
    let times: BTreeMap<&str, f64> = times.collect();
    json!({
        "name": campaign.name, "episodes": campaign.episodes, "team": campaign.agents(), "seed": campaign.seed,
        "groups": campaign.groups().iter().map(|group| json!({
            "name": *group.name, "agent": group.agent.noun(1), "team": group.team,
        })).collect::<Vec<_>>(),
        "strata": campaign.strata.all().iter().map(|stratum| json!({
            "name": *stratum.name, "share": stratum.share,
        })).collect::<Vec<_>>(),
        "design": design(campaign),
        "steps": campaign.time.steps, "step_s": campaign.time.step_s, "controllers": campaign.controllers,
        "drawn": drawn_json(campaign),
        "roughly_s": seconds(campaign),
        "large_tables_bytes": sizes, "large_tables_s": times, "detail": campaign.detail.word(), "memory_bytes": extent.memory,
        "notes": notes,
    })
}
