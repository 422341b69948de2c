//! From a campaign to the gains of its controllers: synthesized, or read from a file and verified the same way.

use super::error::GainsError;
use super::file::{self, GainsFile};
use super::gain_set::{ChannelController, Findings, GainSet, SimulatedController, integrable};
use super::step::check_step;
use crate::agent::ChannelGroup;
use crate::campaign::{
    AgentGroup, BUILT_IN, Campaign, PID, PID_PLACED, PID_TUNED, PidPlaced, PlacedPoles,
};
use crate::synthesis::{
    ChannelSynthesis, ControllerGains, LoopAnalysis, SynthesisError, placed_gains,
    poles_for_delay_margin, synthesize, verify,
};
use std::path::Path;

impl GainSet {
    /// Synthesizes, reads and verifies the gains of a campaign's controllers, a set of each group of agents.
    ///
    /// # Errors
    /// As [`GainSet::synthesize_or_load`].
    pub fn of_groups(campaign: &Campaign) -> Result<Vec<Self>, GainsError> {
        campaign
            .groups()
            .iter()
            .map(Self::synthesize_or_load)
            .collect()
    }

    /// Synthesizes, reads and verifies the gains of the controllers of a group of agents, and checks its step against
    /// them.
    ///
    /// # Errors
    /// If a synthesis fails, a file is unreadable or refused, or the step is too long for the gains.
    pub fn synthesize_or_load(group: &AgentGroup) -> Result<Self, GainsError> {
        let source = &group.synthesis;
        let is_built_in = |name: &String| BUILT_IN.contains(&name.as_str());
        let synthesized = if source.gains.is_none() && group.controllers.iter().any(is_built_in) {
            Some(synthesize_groups(group)?)
        } else {
            None
        };
        let mut controllers = Vec::new();
        for name in &group.controllers {
            let named = source.named.iter().find(|named| named.name == *name);
            let file = named
                .map(|named| (&named.gains, &named.controller))
                .or(source.gains.as_ref().map(|path| (path, name)));
            controllers.push(match (file, &synthesized) {
                (Some((path, controller)), _) => {
                    file::controller(group, name, path, controller, true)?
                }
                (None, Some(synthesized)) => from_synthesis(group, name, synthesized)?,
                (None, None) => {
                    let reason = format!("no gains for the controller {name:?}");
                    return Err(GainsError::File {
                        path: group.path.clone(),
                        reason,
                    });
                }
            });
        }
        let set = Self { controllers };
        check_step(&set, group)?;
        Ok(set)
    }

    /// Reads the gains of a run back, a set of each group of agents; they were verified when it was simulated.
    ///
    /// # Errors
    /// If the file is unreadable or lacks a controller.
    pub fn read(campaign: &Campaign, path: &Path) -> Result<Vec<Self>, GainsError> {
        let of_group = |group: &AgentGroup| {
            let read = |name: &String| file::controller(group, name, path, name, false);
            let controllers = group.controllers.iter().map(read);
            Ok(Self {
                controllers: controllers.collect::<Result<_, _>>()?,
            })
        };
        campaign.groups().iter().map(of_group).collect()
    }

    /// The gains of a campaign, a set of each group of agents, as a file.
    #[must_use]
    pub fn to_file(campaign: &Campaign, gains: &[Self]) -> GainsFile {
        file::of(gains, campaign)
    }
}

/// The gains of each channel group; equal designs are synthesized once.
fn synthesize_groups(group: &AgentGroup) -> Result<Vec<ChannelSynthesis>, GainsError> {
    let mut done: Vec<ChannelSynthesis> = Vec::new();
    for (channels, design) in group.channel_groups().iter().zip(&group.synthesis.designs) {
        let known = done.iter().find(|known| known.design == *design).cloned();
        done.push(match known {
            Some(known) => known,
            None => synthesize(design).map_err(|source| failed(group, channels, source))?,
        });
    }
    Ok(done)
}

fn failed(group: &AgentGroup, channels: &ChannelGroup, source: SynthesisError) -> GainsError {
    GainsError::Synthesis {
        path: group.path.clone(),
        channels: group.titled(channels.role.name()),
        source: Box::new(source),
    }
}

/// The gains of a built-in controller in a synthesis, and what was found about them.
#[must_use]
pub fn built_in(synthesis: &ChannelSynthesis, name: &str) -> (ControllerGains, Findings) {
    let analysis = &synthesis.analysis;
    let bare = |analysis: &LoopAnalysis| Findings {
        analysis: analysis.clone(),
        certificate: None,
        checks: Vec::new(),
        solver: Vec::new(),
    };
    match name {
        PID => (synthesis.pid.clone(), bare(&analysis.pid)),
        PID_TUNED => (synthesis.pid_tuned.clone(), bare(&analysis.pid_tuned)),
        _ => {
            let findings = Findings {
                analysis: analysis.ftc.clone(),
                certificate: Some(synthesis.certificate.clone()),
                checks: synthesis.checks.clone(),
                solver: synthesis.solver.clone(),
            };
            (synthesis.ftc.clone(), findings)
        }
    }
}

/// The gains of "pid-placed" on a channel group, and what was found about them.
fn placed(
    synthesis: &ChannelSynthesis,
    placed: &PidPlaced,
) -> Result<(ControllerGains, Findings), SynthesisError> {
    let design = &synthesis.design;
    let poles_rad_s = match &placed.poles {
        PlacedPoles::At(poles_rad_s) => *poles_rad_s,
        PlacedPoles::DelayMarginOf(name) => {
            let (_, of) = built_in(synthesis, name);
            let margin_ms = of.analysis.margins.delay_margin_ms;
            poles_for_delay_margin(design, margin_ms, placed.observer_rad_s)?
        }
    };
    let gains = placed_gains(poles_rad_s, placed.observer_rad_s);
    let verified = verify(design, &gains)?;
    let findings = Findings {
        analysis: verified.analysis,
        certificate: None,
        checks: verified.checks,
        solver: Vec::new(),
    };
    Ok((gains, findings))
}

fn from_synthesis(
    group: &AgentGroup,
    name: &str,
    synthesized: &[ChannelSynthesis],
) -> Result<SimulatedController, GainsError> {
    let of_channels = |(channels, synthesis): (ChannelGroup, &ChannelSynthesis)| {
        let failed = |source| failed(group, &channels, source);
        let (gains, findings) = match name {
            PID_PLACED => placed(synthesis, &group.synthesis.placed).map_err(failed)?,
            _ => built_in(synthesis, name),
        };
        let loop_gains = integrable(&synthesis.design, &gains);
        Ok::<_, GainsError>(ChannelController {
            gains,
            loop_gains: loop_gains.map_err(failed)?,
            findings: Some(findings),
        })
    };
    let groups = group.channel_groups().into_iter().zip(synthesized);
    Ok(SimulatedController {
        name: name.to_string(),
        source: "synthesized".into(),
        groups: groups.map(of_channels).collect::<Result<_, _>>()?,
    })
}
