//! From a campaign to the gains of its controllers: synthesized, or read from a file and verified the same way.

use super::built_in::{built_in, failed, takes_synthesis};
use super::error::GainsError;
use super::file::{self, GainsFile};
use super::full_order::refuse_sensors;
use super::gain_set::GainSet;
use crate::campaign::{AgentGroup, Campaign};
use crate::synthesis::{ChannelSynthesis, synthesize};
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
    /// If a synthesis fails, a file is unreadable or refused, the step is too long for the gains, or channels share
    /// sensors, which episodes cannot simulate.
    pub fn synthesize_or_load(group: &AgentGroup) -> Result<Self, GainsError> {
        refuse_sensors(group)?;
        let source = &group.synthesis;
        let takes = |name: &String| takes_synthesis(&source.placed, name);
        let synthesized = if source.gains.is_none() && group.controllers.iter().any(takes) {
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
            controllers.push(match file {
                Some((path, controller)) => {
                    let text = file::text_of(path)?;
                    file::controller(group, name, (path, &text), controller, true)?
                }
                None => built_in(group, name, synthesized.as_deref().unwrap_or_default())?,
            });
        }
        let set = Self { controllers };
        set.check_step(group)?;
        Ok(set)
    }

    /// Reads the gains of a run back, a set of each group of agents; they were verified when it was simulated.
    ///
    /// # Errors
    /// If the file is unreadable or lacks a controller.
    pub fn read(campaign: &Campaign, path: &Path) -> Result<Vec<Self>, GainsError> {
        let text = file::text_of(path)?;
        let of_group = |group: &AgentGroup| {
            refuse_sensors(group)?;
            let read = |name: &String| file::controller(group, name, (path, &text), name, false);
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
