//! How a replayed episode went, for people and for programs.

use super::attenuation;
use crate::campaign::AgentGroup;
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
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
    let time = replay.campaign.time;
    let settle_s = f64::from(time.settle_step) * time.step_s;
    let agents = 0..replay.outcomes.len();
    let cautions = replay.cautions().into_iter().map(Block::Text);
    let written = Block::Text(format!(
        "written to {} ({} samples), the figures to {} and {}",
        files.table.display(),
        replay.snapshots.len(),
        files.page.display(),
        files.picture.display()
    ));
    let explanation = attenuation::explanation(&replay.attenuations).into_iter();
    text(&Document {
        title: format!("episode {episode} under {controller}"),
        subtitle: format!("errors from {settle_s} s on"),
        sections: vec![
            Section::new("", agents.map(|agent| of_agent(replay, agent)).collect()),
            Section::new("", explanation.chain(cautions).chain([written]).collect()),
        ],
        ..Document::default()
    })
}

/// The errors of an agent, and how it ended.
fn of_agent(replay: &Replay, agent: usize) -> Block {
    let outcome = &replay.outcomes[agent];
    let (group, _) = replay.campaign.member(agent);
    let head = ["channel", "RMS", "largest"].map(String::from).into_iter();
    let mut grid = Grid {
        head: head
            .chain(attenuation::heads(&replay.attenuations))
            .collect(),
        rows: Vec::new(),
    };
    for (channel, (name, metrics)) in group.channels().iter().zip(&outcome.channels).enumerate() {
        let mut cells = vec![
            Cell::Text(format!("{name}, {}", group.unit(channel))),
            Cell::number(number(metrics.rmse)),
            Cell::number(number(metrics.max_abs)),
        ];
        cells.extend(attenuation::of_channel(
            &replay.attenuations,
            agent,
            channel,
        ));
        grid.rows.push(cells);
    }
    let title = match &*group.name {
        "" => format!("agent {agent}"),
        name => format!("agent {agent} ({name})"),
    };
    let ending = ending(replay, group, outcome).map(|ending| {
        Block::Grid(Grid {
            head: Vec::new(),
            rows: vec![vec![Cell::Verdict(false, ending)]],
        })
    });
    Block::Folded(
        title,
        ending.into_iter().chain([Block::Grid(grid)]).collect(),
    )
}

/// How an agent ended, if it failed, and when.
fn ending(replay: &Replay, group: &AgentGroup, outcome: &AgentOutcome) -> Option<String> {
    let failed = status(group, outcome);
    let limit = match (failed, outcome.failed_step) {
        (Status::Ok, _) => return None,
        (Status::Exceeded, Some(_)) => " max_error",
        (Status::Exceeded, None) => " max_rmse",
        (Status::Diverged, _) => "",
    };
    // What diverges has failed before it left the numbers, if there is a limit.
    let first = match failed {
        Status::Diverged => ", failed",
        Status::Ok | Status::Exceeded => "",
    };
    let time = failed_at_s(replay, outcome);
    let at = time.map_or(String::new(), |time| format!("{first} at {time:.3} s"));
    Some(format!("{}{limit}{at}", failed.word()))
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
        "differs": replay.differs,
        "agents": agents.enumerate().map(of_agent).collect::<Vec<_>>(),
    })
}
