//! The fault-tolerant controllers of groups of channels that share sensors: synthesized and certified; the loop of an
//! episode does not have them.

use super::error::GainsError;
use crate::campaign::{AgentGroup, Campaign};
use crate::synthesis::{FullOrderSynthesis, synthesize_full_order};
use serde::Serialize;
use std::collections::BTreeMap;

/// Synthesizes the controllers of the channels of a group of agents that share sensors, by the names of their groups of
/// channels; empty if it has no `[sensors]`.
///
/// # Errors
/// If a synthesis fails.
pub fn full_order(
    group: &AgentGroup,
) -> Result<BTreeMap<&'static str, FullOrderSynthesis>, GainsError> {
    let synthesized = group.sensors.iter().map(|own| {
        let design = &group.synthesis.designs[own.place];
        let failed = |source| GainsError::Synthesis {
            path: group.path.clone(),
            channels: group.titled(own.name),
            source: Box::new(source),
        };
        let synthesis = synthesize_full_order(design, &own.sensors).map_err(failed)?;
        Ok((own.name, synthesis))
    });
    synthesized.collect()
}

/// The full-order controllers of a campaign as a file; no run reads it.
#[derive(Debug, Serialize)]
pub struct FullOrderFile<'a> {
    /// By group of channels.
    #[serde(skip_serializing_if = "Option::is_none")]
    full_order: Option<&'a BTreeMap<&'static str, FullOrderSynthesis>>,
    /// Of a campaign with `[[group]]`, by group of agents and by group of channels.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    groups: BTreeMap<&'a str, &'a BTreeMap<&'static str, FullOrderSynthesis>>,
}

impl<'a> FullOrderFile<'a> {
    /// Of what [`full_order`] found for each group of agents.
    #[must_use]
    pub fn of(
        campaign: &'a Campaign,
        found: &'a [BTreeMap<&'static str, FullOrderSynthesis>],
    ) -> Self {
        let named = campaign.groups().iter().zip(found);
        let named = named.filter(|(group, own)| !group.name.is_empty() && !own.is_empty());
        Self {
            full_order: found.first().filter(|_| !campaign.has_named_groups()),
            groups: named.map(|(group, own)| (&*group.name, own)).collect(),
        }
    }
}

/// Refuses to simulate channels that share sensors.
pub(super) fn refuse_sensors(group: &AgentGroup) -> Result<(), GainsError> {
    let Some(own) = group.sensors.first() else {
        return Ok(());
    };
    let channels = group.titled(own.name);
    let limit = format!(
        "the sensors of {channels} are synthesized for, but episodes cannot be simulated with them yet"
    );
    let remedy = "remove it; `urts-mc synthesize` shows the gains";
    Err(group.invalid("sensors", "given", &limit, remedy).into())
}
