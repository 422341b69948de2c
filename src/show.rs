//! What the commands print.

mod attenuation;
mod caveats;
mod devices;
mod findings;
mod findings_json;
mod gains;
mod plan;
mod runs;
mod screening;
mod shortcomings;

pub(crate) use devices::devices;
pub(crate) use findings::findings;
pub(crate) use findings_json::findings_json;
pub(crate) use gains::{gains, synthesis};
pub(crate) use plan::{plan, plan_json};
pub(crate) use runs::{runs, runs_json};
pub(crate) use shortcomings::{shortcoming, unmet};

use std::fmt::Write;
use std::path::Path;
use urts_mc::replay::Replay;

/// How a replayed episode went.
pub(crate) fn replay(replay: &Replay, episode: u32, controller: &str, path: &Path) -> String {
    let mut text = String::new();
    let channels = replay.campaign.channels();
    let width = channels.iter().map(|name| name.len()).max().unwrap_or(0);
    line(
        &mut text,
        &format!(
            "episode {episode} under {controller}: RMS error and largest error from settle_s on{}",
            attenuation::heading(&replay.attenuations)
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
        for (channel, (name, metrics)) in channels.iter().zip(&outcome.channels).enumerate() {
            line(
                &mut text,
                &format!(
                    "    {name:<width$} {:>10.5}  {:>10.5}{}",
                    metrics.rmse,
                    metrics.max_abs,
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
                "flown in f64 on the CPU, so digits beyond single precision differ from the run's: {reason}"
            ),
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
