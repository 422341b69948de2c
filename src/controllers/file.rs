//! gains.json: what a run writes, and what a campaign may take instead of a synthesis.

use super::error::GainsError;
use super::gain_set::{ChannelController, Findings, GainSet, SimulatedController, integrable};
use crate::agent::{ChannelGroup, ChannelRole};
use crate::campaign::Campaign;
use crate::synthesis::{ChannelDesign, ControllerGains, SynthesisError, verify};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The version of the format.
const FORMAT: u32 = 1;

/// gains.json.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainsFile {
    /// Version of the format.
    pub format: u32,
    /// Where the numbers are from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The designs that the gains belong to; not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub designs: Option<serde_json::Value>,
    /// The controllers by name.
    pub controllers: BTreeMap<String, ControllerFile>,
}

/// One controller of a gains.json.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerFile {
    /// Where the numbers are from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Gains of a UAV's position channels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<ControllerGains>,
    /// Gains of a UAV's attitude channels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attitude: Option<ControllerGains>,
    /// Gains of a biped's joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<ControllerGains>,
    /// What was found about them, by channel group; read back with a run, and found anew wherever gains are named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub findings: Option<serde_json::Value>,
}

impl ControllerFile {
    /// The gains of the channels of a role.
    fn of(&mut self, role: ChannelRole) -> &mut Option<ControllerGains> {
        match role {
            ChannelRole::Position => &mut self.position,
            ChannelRole::Attitude => &mut self.attitude,
            ChannelRole::Joints => &mut self.joints,
        }
    }
}

/// The gains of a campaign as a file.
pub(super) fn of(gains: &GainSet, campaign: &Campaign) -> GainsFile {
    let groups = campaign.channel_groups();
    let by_group = |values: Vec<serde_json::Value>| {
        let names = groups.iter().map(|group| group.role.name().to_string());
        serde_json::Value::Object(names.zip(values).collect())
    };
    let controllers = gains.controllers.iter().map(|controller| {
        let findings = controller.groups.iter().map(|group| json(&group.findings));
        let mut file = ControllerFile {
            source: Some(controller.source.clone()),
            position: None,
            attitude: None,
            joints: None,
            findings: Some(by_group(findings.collect())),
        };
        for (group, own) in groups.iter().zip(&controller.groups) {
            *file.of(group.role) = Some(own.gains.clone());
        }
        (controller.name.clone(), file)
    });
    GainsFile {
        format: FORMAT,
        source: None,
        designs: Some(by_group(
            campaign.synthesis.designs.iter().map(json).collect(),
        )),
        controllers: controllers.collect(),
    }
}

/// A value as JSON; these types have string keys and finite numbers, which always can be.
fn json(value: &impl Serialize) -> serde_json::Value {
    serde_json::to_value(value).unwrap_or_default()
}

/// Reads a gains.json.
fn read(path: &Path) -> Result<GainsFile, GainsError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| broken(path, format!("cannot be read ({error}); name a gains.json")))?;
    let file: GainsFile = serde_json::from_str(&text).map_err(|error| {
        broken(
            path,
            format!("{error}; write it as the gains.json of a run"),
        )
    })?;
    if file.format != FORMAT {
        let reason = format!(
            "format = {}: this program reads format {FORMAT}; run the campaign that made the file again",
            file.format
        );
        return Err(broken(path, reason));
    }
    Ok(file)
}

/// A file that cannot be used.
fn broken(path: &Path, reason: String) -> GainsError {
    GainsError::File {
        path: path.to_path_buf(),
        reason,
    }
}

/// A controller from a file; its gains are verified if `check`.
pub(super) fn controller(
    campaign: &Campaign,
    name: &str,
    path: &Path,
    controller: &str,
    check: bool,
) -> Result<SimulatedController, GainsError> {
    let mut file = read(path)?;
    let Some(mut found) = file.controllers.remove(controller) else {
        let known: Vec<&str> = file.controllers.keys().map(String::as_str).collect();
        let reason = format!(
            "controllers.{controller}: absent, the file has {}; add it or name one of these",
            known.join(", ")
        );
        return Err(broken(path, reason));
    };
    let written = found.findings.take();
    let mut of_group = |(group, design): (ChannelGroup, &ChannelDesign)| {
        let role = group.role.name();
        let gains = found.of(group.role).take().ok_or_else(|| {
            let reason = format!(
                "controllers.{controller}.{role}: absent; add it, or name gains that were made for {}",
                campaign.agent.plural()
            );
            broken(path, reason)
        })?;
        let refused = |source| GainsError::Refused {
            path: path.to_path_buf(),
            controller: controller.to_string(),
            role,
            source: Box::new(source),
        };
        let loop_gains = integrable(design, &gains).map_err(refused)?;
        let findings = if check {
            Some(verified(design, &gains).map_err(refused)?)
        } else {
            // A run that wrote them in another form is simulated all the same.
            let written = written.as_ref().and_then(|findings| findings.get(role));
            written.and_then(|findings| Findings::deserialize(findings).ok())
        };
        Ok::<_, GainsError>(ChannelController {
            gains,
            loop_gains,
            findings,
        })
    };
    let groups = campaign.channel_groups().into_iter();
    let groups: Vec<ChannelController> = groups
        .zip(&campaign.synthesis.designs)
        .map(&mut of_group)
        .collect::<Result<_, _>>()?;
    let states = |group: &ChannelController| group.loop_gains.states;
    if groups
        .windows(2)
        .any(|pair| states(&pair[0]) != states(&pair[1]))
    {
        let remedy = "give both fault estimates, or neither";
        let reason =
            format!("controllers.{controller}: the channel groups differ in kind; {remedy}");
        return Err(broken(path, reason));
    }
    Ok(SimulatedController {
        name: name.to_string(),
        source: format!("{} ({controller})", path.display()),
        groups,
    })
}

/// What the verification of gains from a file finds.
fn verified(design: &ChannelDesign, gains: &ControllerGains) -> Result<Findings, SynthesisError> {
    let verified = verify(design, gains)?;
    Ok(Findings {
        analysis: verified.analysis,
        certificate: verified.certificate,
        checks: verified.checks,
        solver: Vec::new(),
    })
}
