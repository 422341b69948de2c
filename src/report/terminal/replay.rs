//! How a replayed episode went, for people and for programs.

use super::attenuation;
use super::style::{bad, heading};
use super::text::line;
use crate::campaign::AgentGroup;
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use crate::results::scores::{Status, status};
use crate::run::replay::Replay;
use crate::run::replay_files::ReplayFiles;
use crate::simulation::attenuation::{Attenuation, NotApplicable};
use crate::util::format::number;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// How a replayed episode went.
pub fn replay(
    replay: &Replay,
    (_, episode, controller): (&Path, u32, &str),
    files: &ReplayFiles,
) -> String {
    let campaign = &replay.campaign;
    let mut text = String::new();
    let names = |group: &AgentGroup| -> Vec<String> {
        let names = group.channels().iter().enumerate();
        names
            .map(|(channel, name)| format!("{name}, {}", group.unit(channel)))
            .collect()
    };
    let widths = campaign.groups().iter().flat_map(names);
    // At least as wide as its heading.
    let width = widths.map(|name| name.len()).max().unwrap_or(0).max(10);
    let settle_s = f64::from(campaign.time.settle_step) * campaign.time.step_s;
    let title = heading(&format!("episode {episode} under {controller}"));
    line(&mut text, &format!("{title}: errors from {settle_s} s on"));
    line(
        &mut text,
        &format!(
            "    {:<width$} {:>10}  {:>10}{}",
            "channel",
            "RMS",
            "largest",
            attenuation::heading(&replay.attenuations)
        ),
    );
    for (agent, outcome) in replay.outcomes.iter().enumerate() {
        let ending = ending(replay, agent, outcome);
        let (group, _) = campaign.member(agent);
        let of_group = match &*group.name {
            "" => String::new(),
            name => format!(" ({name})"),
        };
        line(&mut text, &format!("  agent {agent}{of_group}{ending}"));
        for (channel, (name, metrics)) in names(group).iter().zip(&outcome.channels).enumerate() {
            line(
                &mut text,
                &format!(
                    "    {name:<width$} {:>10}  {:>10}{}",
                    number(metrics.rmse),
                    number(metrics.max_abs),
                    attenuation::of_channel(&replay.attenuations, agent, channel)
                ),
            );
        }
    }
    text.push_str(&attenuation::explanation(&replay.attenuations));
    if let Some(reason) = &replay.stand_in {
        line(
            &mut text,
            &format!(
                "simulated in f64 on the CPU, so digits beyond single precision differ from the run's: {reason}"
            ),
        );
    }
    line(
        &mut text,
        &format!(
            "written to {} ({} samples), the figures to {} and {}",
            files.table.display(),
            replay.snapshots.len(),
            files.page.display(),
            files.picture.display()
        ),
    );
    text
}

/// How an agent ended, if it failed, and when.
fn ending(replay: &Replay, agent: usize, outcome: &AgentOutcome) -> String {
    match status(replay.campaign.member(agent).0, outcome) {
        Status::Ok => String::new(),
        failed => {
            let limit = match (failed, outcome.failed_step) {
                (Status::Exceeded, Some(_)) => " max_error",
                (Status::Exceeded, None) => " max_rmse",
                _ => "",
            };
            let time = failed_at_s(replay, outcome);
            // What diverges has failed before it left the numbers, if there is a limit.
            let first = match failed {
                Status::Diverged => ", failed",
                Status::Ok | Status::Exceeded => "",
            };
            let at = time.map_or(String::new(), |time| format!("{first} at {time:.3} s"));
            format!("  {}{limit}{at}", bad(failed.word()))
        }
    }
}

/// When an agent broke max_error or left the numbers, s.
fn failed_at_s(replay: &Replay, outcome: &AgentOutcome) -> Option<f64> {
    let time = &replay.campaign.time;
    let step = outcome
        .failed_step
        .or(outcome.diverged.then_some(time.steps))?;
    Some(f64::from(step) * time.step_s)
}

/// What (24) says about a channel.
type Found = Result<Attenuation, NotApplicable>;

/// [`replay`] for programs.
pub fn replay_json(
    replay: &Replay,
    (run, episode, controller): (&Path, u32, &str),
    files: &ReplayFiles,
) -> Value {
    let campaign = &replay.campaign;
    let agents = replay.outcomes.iter().zip(&replay.attenuations);
    let of_agent = |(agent, (outcome, found)): (usize, (&AgentOutcome, &Vec<Found>))| {
        let (group, _) = campaign.member(agent);
        let channels = group.channels().iter().zip(&outcome.channels);
        let of_channel = |((name, metrics), attenuation): (
            (&Arc<str>, &ChannelOutcome),
            &Found,
        )| {
            json!({
                "channel": **name,
                "rmse": metrics.rmse,
                "max_abs": metrics.max_abs,
                "attenuation": attenuation.as_ref().ok().map(|found| json!({
                    "level": found.level(), "certified": found.certified, "holds": found.holds(),
                })),
                "attenuation_not_applicable": attenuation.as_ref().err().map(ToString::to_string),
            })
        };
        json!({
            "agent": agent,
            "status": status(group, outcome).word(),
            "failed_at_s": failed_at_s(replay, outcome),
            "channels": channels.zip(found).map(of_channel).collect::<Vec<_>>(),
        })
    };
    json!({
        "run": run.display().to_string(), "episode": episode, "controller": controller,
        "file": files.table.display().to_string(), "samples": replay.snapshots.len(),
        "figures": [files.page.display().to_string(), files.picture.display().to_string()],
        "stand_in": replay.stand_in,
        "agents": agents.enumerate().map(of_agent).collect::<Vec<_>>(),
    })
}
