//! From a campaign to the gains of its controllers: synthesized, or read from a file and verified the same way.

use super::error::GainsError;
use super::file::{self, GainsFile};
use super::gain_set::{ChannelController, Findings, GainSet, SimulatedController, integrable};
use super::step::check_step;
use crate::agent::ChannelGroup;
use crate::campaign::{BUILT_IN, Campaign, PID, PID_TUNED};
use crate::synthesis::{ChannelSynthesis, ControllerGains, LoopAnalysis, synthesize};
use std::path::Path;

impl GainSet {
    /// Synthesizes, reads and verifies the gains of a campaign's controllers, and checks its step against them.
    ///
    /// # Errors
    /// If a synthesis fails, a file is unreadable or refused, or the step is too long for the gains.
    pub fn synthesize_or_load(campaign: &Campaign) -> Result<Self, GainsError> {
        let source = &campaign.synthesis;
        let is_built_in = |name: &String| BUILT_IN.contains(&name.as_str());
        let synthesized = if source.gains.is_none() && campaign.controllers.iter().any(is_built_in)
        {
            Some(synthesize_groups(campaign)?)
        } else {
            None
        };
        let mut controllers = Vec::new();
        for name in &campaign.controllers {
            let named = source.named.iter().find(|named| named.name == *name);
            let file = named
                .map(|named| (&named.gains, &named.controller))
                .or(source.gains.as_ref().map(|path| (path, name)));
            controllers.push(match (file, &synthesized) {
                (Some((path, controller)), _) => {
                    file::controller(campaign, name, path, controller, true)?
                }
                (None, Some(synthesized)) => from_synthesis(campaign, name, synthesized)?,
                (None, None) => {
                    let reason = format!("no gains for the controller {name:?}");
                    return Err(GainsError::File {
                        path: campaign.path.clone(),
                        reason,
                    });
                }
            });
        }
        let set = Self { controllers };
        check_step(&set, campaign)?;
        Ok(set)
    }

    /// Reads the gains of a run back; they were verified when it was simulated.
    ///
    /// # Errors
    /// If the file is unreadable or lacks a controller.
    pub fn read(campaign: &Campaign, path: &Path) -> Result<Self, GainsError> {
        let read = |name: &String| file::controller(campaign, name, path, name, false);
        Ok(Self {
            controllers: campaign
                .controllers
                .iter()
                .map(read)
                .collect::<Result<_, _>>()?,
        })
    }

    /// The gains as a file.
    #[must_use]
    pub fn to_file(&self, campaign: &Campaign) -> GainsFile {
        file::of(self, campaign)
    }
}

/// The gains of each channel group; equal designs are synthesized once.
fn synthesize_groups(campaign: &Campaign) -> Result<Vec<ChannelSynthesis>, GainsError> {
    let mut done: Vec<ChannelSynthesis> = Vec::new();
    for (group, design) in campaign
        .channel_groups()
        .iter()
        .zip(&campaign.synthesis.designs)
    {
        let known = done.iter().find(|known| known.design == *design).cloned();
        done.push(match known {
            Some(known) => known,
            None => synthesize(design).map_err(|source| GainsError::Synthesis {
                path: campaign.path.clone(),
                role: group.role.name(),
                source: Box::new(source),
            })?,
        });
    }
    Ok(done)
}

/// The gains of a built-in controller in a synthesis, and what was found about them.
#[must_use]
pub fn built_in<'a>(
    synthesis: &'a ChannelSynthesis,
    name: &str,
) -> (&'a ControllerGains, Findings) {
    let analysis = &synthesis.analysis;
    let bare = |analysis: &LoopAnalysis| Findings {
        analysis: analysis.clone(),
        certificate: None,
        checks: Vec::new(),
        solver: Vec::new(),
    };
    match name {
        PID => (&synthesis.pid, bare(&analysis.pid)),
        PID_TUNED => (&synthesis.pid_tuned, bare(&analysis.pid_tuned)),
        _ => {
            let findings = Findings {
                analysis: analysis.ftc.clone(),
                certificate: Some(synthesis.certificate.clone()),
                checks: synthesis.checks.clone(),
                solver: synthesis.solver.clone(),
            };
            (&synthesis.ftc, findings)
        }
    }
}

fn from_synthesis(
    campaign: &Campaign,
    name: &str,
    synthesized: &[ChannelSynthesis],
) -> Result<SimulatedController, GainsError> {
    let of_group = |(group, synthesis): (ChannelGroup, &ChannelSynthesis)| {
        let (gains, findings) = built_in(synthesis, name);
        let loop_gains =
            integrable(&synthesis.design, gains).map_err(|source| GainsError::Synthesis {
                path: campaign.path.clone(),
                role: group.role.name(),
                source: Box::new(source),
            })?;
        Ok::<_, GainsError>(ChannelController {
            gains: gains.clone(),
            loop_gains,
            findings: Some(findings),
        })
    };
    let groups = campaign.channel_groups().into_iter().zip(synthesized);
    Ok(SimulatedController {
        name: name.to_string(),
        source: "synthesized".into(),
        groups: groups.map(of_group).collect::<Result<_, _>>()?,
    })
}
