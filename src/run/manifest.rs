//! The manifest of a run: what it takes to do it again, and what it was done with.

use super::error::{MANIFEST, OutputError};
use super::integrity::{FileRecord, verify};
use crate::backend::cpu::Precision;
use crate::campaign::{Campaign, CampaignError, Setting};
use crate::results::RequirementResult;
use crate::simulation::cross_check::CrossCheck;
use crate::simulation::stopping::Stopped;
use crate::simulation::{Segment, Times};
use crate::util::json::pretty;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Everything about a run that its tables do not say.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Name of the campaign.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// Revision of the program's source, where it was built from a repository.
    pub git_revision: Option<String>,
    /// The campaign file, as it was named.
    pub campaign_path: String,
    /// BLAKE3 hash of the campaign text, and of the settings laid over it.
    pub campaign_blake3: String,
    /// The campaign text.
    pub campaign: String,
    /// The settings laid over it with `--set`, in their order; absent if there were none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overlay: Vec<Setting>,
    /// The text of the robot's file, where there are robots; of a campaign with `[[group]]` see `robots`.
    pub robot: Option<String>,
    /// Of a campaign with `[[group]]`, the text of the robot's file of each group of robots, by its name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub robots: BTreeMap<String, String>,
    /// Seed that was used: the campaign's, unless it was overridden.
    pub seed: u64,
    /// Episodes that were simulated.
    pub episodes: u32,
    /// Episodes that were asked for.
    pub episodes_asked: u32,
    /// What the campaign's `[stop]` knows at the end, and whether it ended the run.
    pub stopped: Option<Stopped>,
    /// What became of each `[[require]]`, in the campaign's order; empty in runs of older versions.
    #[serde(default)]
    pub requirements: Vec<RequirementResult>,
    /// The files that it counts, by name: those that are read again; none in runs of older versions.
    #[serde(default)]
    pub files: BTreeMap<String, FileRecord>,
    /// BLAKE3 hashes of the files that the campaign names, robots and gains, by their paths.
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    /// Why fewer were simulated than that, if so.
    pub interrupted: Option<String>,
    /// Number format of the episode loop.
    pub precision: Precision,
    /// What simulated them.
    #[serde(rename = "legs")]
    pub segments: Vec<Segment>,
    /// What there is to know beside: about the choice of the backend, and what the gains do not bear.
    pub notes: Vec<String>,
    /// How some episodes compare with the reference, if they were.
    pub cross_check: Option<CrossCheck>,
    /// Why they were not, if they should have been.
    pub cross_check_missing: Option<String>,
    /// Who does better, a sentence for each opponent of the first controller; empty in runs of older versions.
    #[serde(default)]
    pub verdict: Vec<String>,
    /// In what the first controller and each of the others are unlike, in sentences; empty in runs of older versions.
    #[serde(default)]
    pub unlike: Vec<String>,
    /// What the strata do to each controller, in sentences (`results::worst_fault`); empty without strata to compare.
    #[serde(default)]
    pub harm: Vec<String>,
    /// Wall-clock times.
    pub times: Times,
    /// BLAKE3 hash of the file of all this, but for the hash itself; none in runs of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

/// The source revision that this program was built from.
pub(crate) const GIT_REVISION: Option<&str> = option_env!("URTS_MC_GIT_REVISION");

/// The hash that tells one campaign text, with the settings laid over it, from another; that of the text alone if there
/// are no settings.
#[must_use]
pub fn campaign_hash(campaign: &Campaign) -> String {
    hash_of(&campaign.text, &campaign.overlay)
}

/// The same without the settings of `[output]`: what is written changes nothing in what is flown.
pub(super) fn flown_hash(campaign: &Campaign) -> String {
    let settings = campaign.overlay.iter();
    hash_of(
        &campaign.text,
        settings.filter(|own| own.table() != "output"),
    )
}

fn hash_of<'a>(text: &str, overlay: impl IntoIterator<Item = &'a Setting>) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    for setting in overlay {
        // No campaign text has this byte in it, so that no text looks like another with settings.
        hasher.update(b"\0");
        hasher.update(setting.to_string().as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

impl Manifest {
    /// Reads the manifest of a run's directory.
    ///
    /// # Errors
    /// If there is none or it is not one.
    pub fn read(dir: &Path) -> Result<Self, OutputError> {
        Self::parsed(dir).map(|(manifest, _)| manifest)
    }

    /// The manifest of a run's directory, and the text of its file.
    fn parsed(dir: &Path) -> Result<(Self, String), OutputError> {
        let no_run = |reason: String| OutputError::NoRun {
            path: dir.to_path_buf(),
            reason,
        };
        let text = std::fs::read_to_string(dir.join(MANIFEST))
            .map_err(|error| no_run(format!("{MANIFEST}: {error}")))?;
        let manifest = serde_json::from_str(&text);
        let manifest = manifest.map_err(|error| no_run(format!("{MANIFEST}: {error}")))?;
        Ok((manifest, text))
    }

    /// Reads the manifest of a run's directory, whose files have to be those that the run wrote.
    ///
    /// # Errors
    /// If there is none, it is not one, or its campaign or a file that it counts is missing or was changed.
    pub fn read_verified(dir: &Path) -> Result<Self, OutputError> {
        let (manifest, text) = Self::parsed(dir)?;
        let damaged = |reason: &str| OutputError::Damaged {
            path: dir.join(MANIFEST),
            reason: reason.to_string(),
        };
        if hash_of(&manifest.campaign, &manifest.overlay) != manifest.campaign_blake3 {
            return Err(damaged("the campaign in it was changed"));
        }
        if manifest
            .blake3
            .as_ref()
            .is_some_and(|own| !is_hash_of(own, &text))
        {
            return Err(damaged("its content was changed"));
        }
        verify(dir, &manifest.files)?;
        Ok(manifest)
    }

    /// The text of its file, with the file's own hash.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub(super) fn to_file(&self) -> Result<Vec<u8>, serde_json::Error> {
        let without = Self {
            blake3: Some(String::new()),
            ..self.clone()
        };
        let without = String::from_utf8_lossy(&pretty(&without)?).into_owned();
        let hash = blake3::hash(without.as_bytes()).to_hex();
        Ok(with_hash(&without, "", &hash).into_bytes())
    }

    /// The campaign that was simulated, with the run's seed and the number of episodes that was asked for.
    ///
    /// # Errors
    /// If this version does not read the campaign any more.
    pub fn campaign(&self) -> Result<Campaign, CampaignError> {
        let campaign = Campaign::parse_with_robots(
            &self.campaign,
            Path::new(&self.campaign_path),
            &self.overlay,
            &|group| match group {
                "" => self.robot.clone(),
                name => self.robots.get(name).cloned(),
            },
            // What a design draws belongs to the number of episodes that was asked for.
            Some(self.episodes_asked),
        )?;
        Ok(campaign.with_seed(self.seed))
    }
}

/// The text of a manifest with another hash in the place of its own, which is the last of its keys.
fn with_hash(text: &str, own: &str, other: &str) -> String {
    let entry = |hash: &str| format!("\"blake3\": \"{hash}\"");
    let (before, after) = text.rsplit_once(&entry(own)).unwrap_or((text, ""));
    format!("{before}{}{after}", entry(other))
}

/// Whether this is the hash of the text of a manifest.
fn is_hash_of(hash: &str, text: &str) -> bool {
    let without = with_hash(text, hash, "");
    *blake3::hash(without.as_bytes()).to_hex() == *hash
}
