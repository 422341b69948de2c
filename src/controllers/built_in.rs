//! The controllers that need no file: where the gains of each come from.

use super::error::GainsError;
use super::file;
use super::gain_set::{ChannelController, Findings, SimulatedController};
use crate::agent::ChannelGroup;
use crate::campaign::{
    AgentGroup, FTC, FTC_TUNED, PID, PID_PLACED, PID_ROBUST_OBSERVER, PID_TUNED, PidPlaced,
    PlacedPoles,
};
use crate::synthesis::{
    ChannelDesign, ChannelSynthesis, ControllerGains, LoopAnalysis, PLACED_RAD_S, SynthesisError,
    placed_gains, poles_for_delay_margin,
};
use std::path::Path;

/// What a built-in controller is, in a few words; none of one that comes from a file.
#[must_use]
pub fn spelled_out(name: &str) -> Option<&'static str> {
    Some(match name {
        FTC => "the paper's fault-tolerant controller",
        FTC_TUNED => "the same structure, tuned with the budget and limits of pid-tuned",
        PID => "the paper's PID read plainly: hardly any integral action",
        PID_PLACED => "PID whose error has a triple pole",
        PID_TUNED => "PID tuned within ftc's margins, noise gains and commands",
        PID_ROBUST_OBSERVER => "pid with an observer that distrusts the velocity sensor",
        _ => return None,
    })
}

/// A row of [`TUNED`].
macro_rules! tuned {
    ($preset:literal, $controller:literal) => {
        [
            $preset,
            $controller,
            concat!("campaigns/gains/", $preset, "-", $controller, ".json"),
            include_str!(concat!(
                "../../campaigns/gains/",
                $preset,
                "-",
                $controller,
                ".json"
            )),
        ]
    };
}

/// The gains that `urts-mc tune` found for the campaigns of the presets: preset, controller, file and its text.
const TUNED: &[[&str; 4]] = &[
    tuned!("uav-paper", "pid-tuned"),
    tuned!("uav-paper", "ftc-tuned"),
    tuned!("uav-physical", "pid-tuned"),
    tuned!("uav-physical", "ftc-tuned"),
    tuned!("biped-paper", "pid-tuned"),
    tuned!("biped-paper", "ftc-tuned"),
];

/// Whether the gains of a built-in controller are made of a synthesis.
pub(super) fn takes_synthesis(placed: &PidPlaced, name: &str) -> bool {
    match name {
        FTC | PID | PID_ROBUST_OBSERVER => true,
        PID_PLACED => matches!(placed.poles, PlacedPoles::DelayMarginOf(_)),
        _ => false,
    }
}

/// The fault-tolerant controller of a synthesis, and what was found about it.
#[must_use]
pub fn fault_tolerant(synthesis: &ChannelSynthesis) -> (ControllerGains, Findings) {
    let findings = Findings {
        analysis: synthesis.analysis.ftc.clone(),
        certificate: Some(synthesis.certificate.clone()),
        checks: synthesis.checks.clone(),
        solver: synthesis.solver.clone(),
    };
    (synthesis.ftc.clone(), findings)
}

/// The gains of a controller of a synthesis on one channel type, and what was found about them; none of a controller
/// that is not synthesized.
#[must_use]
pub fn synthesized(
    synthesis: &ChannelSynthesis,
    name: &str,
) -> Option<(ControllerGains, Findings)> {
    let analysis = &synthesis.analysis;
    let pid = |gains: &ControllerGains, analysis: &LoopAnalysis| {
        let findings = Findings {
            analysis: analysis.clone(),
            certificate: None,
            checks: Vec::new(),
            solver: Vec::new(),
        };
        (gains.clone(), findings)
    };
    Some(match name {
        FTC => fault_tolerant(synthesis),
        PID => pid(&synthesis.pid, &analysis.pid),
        PID_ROBUST_OBSERVER => pid(
            &synthesis.pid_robust_observer,
            &analysis.pid_robust_observer,
        ),
        _ => return None,
    })
}

/// A built-in controller of a group of agents; `syntheses` are those of its channel groups, where it takes them.
///
/// # Errors
/// If its gains do not pass, or a delay margin cannot be reached.
pub(super) fn built_in(
    group: &AgentGroup,
    name: &str,
    syntheses: &[ChannelSynthesis],
) -> Result<SimulatedController, GainsError> {
    let preset = group.synthesis.preset.as_str();
    let tuned = TUNED
        .iter()
        .find(|[of, own, ..]| *of == preset && *own == name);
    if let Some([_, controller, path, text]) = tuned {
        return file::controller(group, name, (Path::new(path), text), controller, true);
    }
    let channels = group.channel_groups().into_iter().enumerate();
    let of_channels = channels.map(|(index, channels)| {
        let design = &group.synthesis.designs[index];
        let synthesis = syntheses.get(index);
        let (gains, findings) = match (name, synthesis.and_then(|own| synthesized(own, name))) {
            (_, Some(found)) => found,
            (PID_PLACED, None) => placed(group, &channels, design, synthesis)?,
            _ => {
                let reason = format!("no gains for the controller {name:?}");
                let path = group.path.clone();
                return Err(GainsError::File { path, reason });
            }
        };
        let failed = |source| failed(group, &channels, source);
        ChannelController::new(design.clone(), gains, Some(findings)).map_err(failed)
    });
    Ok(SimulatedController {
        name: name.to_string(),
        source: "synthesized".into(),
        groups: of_channels.collect::<Result<_, _>>()?,
    })
}

/// The gains of "pid-placed" on a channel group, and what was found about them.
fn placed(
    group: &AgentGroup,
    channels: &ChannelGroup,
    design: &ChannelDesign,
    synthesis: Option<&ChannelSynthesis>,
) -> Result<(ControllerGains, Findings), GainsError> {
    let PidPlaced {
        poles,
        observer_rad_s,
    } = &group.synthesis.placed;
    let poles_rad_s = match poles {
        PlacedPoles::At(poles_rad_s) => *poles_rad_s,
        PlacedPoles::DelayMarginOf(name) => {
            let of = synthesis.and_then(|synthesis| synthesized(synthesis, name));
            let margin_ms = of.map_or(f64::NAN, |(_, of)| of.analysis.margins.delay_margin_ms);
            let found = poles_for_delay_margin(margin_ms, *observer_rad_s);
            found.ok_or_else(|| {
                let [slowest, fastest] = PLACED_RAD_S;
                let limit = format!(
                    "on {} this is {margin_ms:.2} ms, which no PID with a triple pole between {slowest} and {fastest} rad/s has",
                    group.titled(channels.role.name())
                );
                let key = "synthesis.pid-placed.delay_margin_of";
                group.invalid(key, format!("{name:?}"), &limit, "give poles_rad_s instead")
            })?
        }
    };
    let gains = placed_gains(poles_rad_s, *observer_rad_s);
    let findings =
        Findings::of(design, &gains).map_err(|source| failed(group, channels, source))?;
    Ok((gains, findings))
}

/// A synthesis that failed on a channel group.
pub(super) fn failed(
    group: &AgentGroup,
    channels: &ChannelGroup,
    source: SynthesisError,
) -> GainsError {
    GainsError::Synthesis {
        path: group.path.clone(),
        channels: group.titled(channels.role.name()),
        source: Box::new(source),
    }
}
