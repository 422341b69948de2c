//! What the parts of a directory are parts of.

use super::super::integrity::inputs;
use super::super::manifest::{GIT_REVISION, flown_hash};
use crate::backend::cpu::Precision;
use crate::campaign::{Campaign, CampaignError, Setting};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// A run that is to be flown in parts, by whoever finds this beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// The campaign file, as it was named.
    pub(crate) campaign_path: String,
    /// BLAKE3 hash of the campaign text, and of the settings laid over it, but for those of what is written.
    pub(crate) campaign_blake3: String,
    /// The campaign text.
    pub(crate) campaign: String,
    /// The settings laid over it, in their order.
    pub(crate) overlay: Vec<Setting>,
    /// The text of the robot's file of each group of robots, by its name.
    pub(crate) robots: BTreeMap<String, String>,
    /// BLAKE3 hashes of the files that the campaign names, by their paths.
    pub(crate) inputs: BTreeMap<String, String>,
    /// BLAKE3 hash of the gains, which are in a file beside it.
    pub(crate) gains_blake3: String,
    /// Seed.
    pub(crate) seed: u64,
    /// Episodes that were asked for.
    pub(crate) episodes: u32,
    /// Number format of the episode loop.
    pub(crate) precision: Precision,
    /// Episodes of a part.
    pub(crate) part: u32,
}

impl Plan {
    /// Of a campaign, whose gains are not known yet.
    pub(crate) fn of(campaign: &Campaign, precision: Precision, part: u32) -> Self {
        Self {
            campaign_path: campaign.path.display().to_string(),
            campaign_blake3: flown_hash(campaign),
            campaign: campaign.text.clone(),
            overlay: campaign.overlay.clone(),
            robots: robots(campaign),
            inputs: inputs(campaign),
            gains_blake3: String::new(),
            seed: campaign.seed,
            episodes: campaign.episodes,
            precision,
            part,
        }
    }

    /// The campaign, with the seed and the episodes that were asked for.
    ///
    /// # Errors
    /// If this version does not read the campaign.
    pub(crate) fn campaign(&self) -> Result<Campaign, CampaignError> {
        let robot = |group: &str| self.robots.get(group).cloned();
        let path = Path::new(&self.campaign_path);
        let text = &self.campaign;
        let asked = Some(self.episodes);
        let campaign = Campaign::parse_with_robots(text, path, &self.overlay, &robot, asked)?;
        Ok(campaign.with_seed(self.seed))
    }

    /// What tells its episodes from those of others: the numbers of an episode depend on nothing else, but for the
    /// program and the engine.
    pub(crate) fn id(&self, campaign: &Campaign) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut add = |text: &str| {
            hasher.update(text.as_bytes());
            // No text has this byte in it.
            hasher.update(b"\0");
        };
        add(&self.campaign_blake3);
        for (group, robot) in &self.robots {
            add(group);
            add(robot);
        }
        add(&self.gains_blake3);
        add(&self.seed.to_string());
        add(&format!("{:?} {}", self.precision, self.part));
        // What a design draws belongs to the number of episodes that was asked for.
        if campaign.sampling.replicates().is_some() {
            add(&self.episodes.to_string());
        }
        hasher.finalize().to_hex().to_string()
    }

    /// In what another plan, of which there are parts, differs; gains are compared where both are known.
    pub(crate) fn difference(&self, other: &Self, campaign: &Campaign) -> Option<String> {
        let text = match self.campaign == other.campaign {
            true => "this campaign with other settings",
            false => "another campaign text",
        };
        let with_design = campaign.sampling.replicates().is_some();
        let gains = [&self.gains_blake3, &other.gains_blake3];
        let known = gains.iter().all(|own| !own.is_empty());
        let precision = format!("precision {:?}", other.precision).to_lowercase();
        let found = [
            (self.campaign_blake3 != other.campaign_blake3, text.into()),
            (self.seed != other.seed, format!("seed {}", other.seed)),
            (self.precision != other.precision, precision),
            (self.robots != other.robots, "another robot's file".into()),
            (
                with_design && self.episodes != other.episodes,
                format!("a design of {} episodes", other.episodes),
            ),
            (
                self.part != other.part,
                format!("parts of {} episodes", other.part),
            ),
            (known && gains[0] != gains[1], "other gains".into()),
        ];
        let mut differing = found.into_iter().filter(|(differs, _)| *differs);
        differing.next().map(|(_, what)| what)
    }
}

/// The program that simulates now.
pub(crate) fn program() -> String {
    let version = env!("CARGO_PKG_VERSION");
    match GIT_REVISION {
        Some(revision) => format!("urts-mc {version} ({revision})"),
        None => format!("urts-mc {version}"),
    }
}

/// The text of the robot's file of each group of robots, by the group's name.
fn robots(campaign: &Campaign) -> BTreeMap<String, String> {
    let groups = campaign.groups().iter();
    groups
        .filter_map(|group| Some((group.name.to_string(), group.agent.file()?.text.clone())))
        .collect()
}
