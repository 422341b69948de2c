//! gains.json: what a run writes, and what a campaign may take instead of a synthesis.

use super::error::GainsError;
use super::gain_set::{ChannelController, Findings, GainSet, SimulatedController};
use crate::agent::{ChannelGroup, ChannelRole};
use crate::campaign::{AgentGroup, Campaign};
use crate::synthesis::{ChannelDesign, ControllerGains};
use crate::util::text_file::read_text;
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
    /// How they were searched, where they were; not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<serde_json::Value>,
    /// The designs of the campaign; not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub designs: Option<serde_json::Value>,
    /// The controllers by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub controllers: BTreeMap<String, ControllerFile>,
    /// Of a campaign with `[[group]]`, designs and controllers of each group of agents by its name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub groups: BTreeMap<String, GroupGains>,
}

/// The gains of one group of agents in a gains.json.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupGains {
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
    /// The designs that its gains belong to, by channel group, where they are not those of the campaign.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub designs: BTreeMap<String, ChannelDesign>,
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

/// The gains of a campaign, a set of each group of agents, as a file.
pub(super) fn of(gains: &[GainSet], campaign: &Campaign) -> GainsFile {
    let mut file = GainsFile {
        format: FORMAT,
        source: None,
        provenance: None,
        designs: None,
        controllers: BTreeMap::new(),
        groups: BTreeMap::new(),
    };
    for (group, gains) in campaign.groups().iter().zip(gains) {
        let own = of_group(gains, group);
        if group.name.is_empty() {
            (file.designs, file.controllers) = (own.designs, own.controllers);
        } else {
            file.groups.insert(group.name.to_string(), own);
        }
    }
    file
}

fn of_group(gains: &GainSet, group: &AgentGroup) -> GroupGains {
    let channels = group.channel_groups();
    let by_role = |values: Vec<serde_json::Value>| {
        let names = channels.iter().map(|own| own.role.name().to_string());
        serde_json::Value::Object(names.zip(values).collect())
    };
    let controllers = gains.controllers.iter().map(|controller| {
        let findings = controller.groups.iter().map(|own| json(&own.findings));
        let own = channels
            .iter()
            .zip(&controller.groups)
            .zip(&group.synthesis.designs);
        let own = own.filter(|((_, own), design)| own.design != **design);
        let designs = own.map(|((of, own), _)| (of.role.name().to_string(), own.design.clone()));
        let mut file = ControllerFile {
            source: Some(controller.source.clone()),
            designs: designs.collect(),
            position: None,
            attitude: None,
            joints: None,
            findings: Some(by_role(findings.collect())),
        };
        for (of, own) in channels.iter().zip(&controller.groups) {
            *file.of(of.role) = Some(own.gains.clone());
        }
        (controller.name.clone(), file)
    });
    GroupGains {
        designs: Some(by_role(group.synthesis.designs.iter().map(json).collect())),
        controllers: controllers.collect(),
    }
}

/// A value as JSON; these types have string keys and finite numbers, which always can be.
fn json(value: &impl Serialize) -> serde_json::Value {
    serde_json::to_value(value).unwrap_or_default()
}

/// The text of a gains.json.
pub(super) fn text_of(path: &Path) -> Result<String, GainsError> {
    read_text(path)
        .map_err(|error| broken(path, format!("cannot be read ({error}); name a gains.json")))
}

/// Reads a gains.json.
fn read(path: &Path, text: &str) -> Result<GainsFile, GainsError> {
    let file: GainsFile = serde_json::from_str(text).map_err(|error| {
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

/// A controller of a group of agents from a file and its text; its gains are verified if `check`.
pub(super) fn controller(
    group: &AgentGroup,
    name: &str,
    (path, text): (&Path, &str),
    controller: &str,
    check: bool,
) -> Result<SimulatedController, GainsError> {
    let mut file = read(path, text)?;
    let of_group = file.groups.remove(&*group.name);
    let mut controllers = of_group.map_or(file.controllers, |own| own.controllers);
    let Some(mut found) = controllers.remove(controller) else {
        let known: Vec<&str> = controllers.keys().map(String::as_str).collect();
        let reason = match known.as_slice() {
            [] if file.groups.is_empty() => {
                "controllers: absent, the file has no gains; name the gains.json of a run"
                    .to_string()
            }
            [] => format!(
                "controllers.{controller}: absent, the file has gains of the groups {} only; name the group so",
                file.groups.keys().cloned().collect::<Vec<_>>().join(", ")
            ),
            known => format!(
                "controllers.{controller}: absent, the file has {}; add it or name one of these",
                known.join(", ")
            ),
        };
        return Err(broken(path, reason));
    };
    let written = found.findings.take();
    let mut of_channels = |(channels, design): (ChannelGroup, &ChannelDesign)| {
        let role = channels.role.name();
        let gains = found.of(channels.role).take().ok_or_else(|| {
            let reason = format!(
                "controllers.{controller}.{role}: absent; add it, or name gains that were made for {}",
                group.agent.plural()
            );
            broken(path, reason)
        })?;
        let design = found.designs.get(role).unwrap_or(design);
        let refused = |source| GainsError::Refused {
            path: path.to_path_buf(),
            controller: controller.to_string(),
            channels: role.to_string(),
            source: Box::new(source),
        };
        let findings = if check {
            Some(Findings::of(design, &gains).map_err(refused)?)
        } else {
            // A run that wrote them in another form is simulated all the same.
            let written = written.as_ref().and_then(|findings| findings.get(role));
            written.and_then(|findings| Findings::deserialize(findings).ok())
        };
        ChannelController::new(design.clone(), gains, findings).map_err(refused)
    };
    let channels = group.channel_groups().into_iter();
    let groups: Vec<ChannelController> = channels
        .zip(&group.synthesis.designs)
        .map(&mut of_channels)
        .collect::<Result<_, _>>()?;
    let states = |own: &ChannelController| own.loop_gains.states;
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
