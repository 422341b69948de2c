//! From the text of a campaign file to a campaign.

use super::check::Check;
use super::common::Common;
use super::error::CampaignError;
use super::file::CampaignFile;
use super::gallery::of_gallery;
use super::group::GroupParts;
use super::overlay::Setting;
use super::requirement::{Compared, Requirement};
use super::source::Source;
use super::validate::validate;
use super::validated::Campaign;
use crate::util::text_file::read_text;
use serde::Deserialize;
use std::fmt::Display;
use std::io::{Error, ErrorKind};
use std::path::Path;
use toml::de::ValueDeserializer;

impl Campaign {
    /// Reads and checks a campaign file.
    ///
    /// # Errors
    /// The first thing that is wrong with it, with file, key, value, limit and remedy.
    pub fn load(path: &Path) -> Result<Self, CampaignError> {
        Self::load_with(path, &[])
    }

    /// The same with settings laid over the file, one after the other.
    ///
    /// # Errors
    /// As [`Campaign::load`]; what comes from a setting names it as its place.
    pub fn load_with(path: &Path, overlay: &[Setting]) -> Result<Self, CampaignError> {
        Self::load_asked(path, overlay, None)
    }

    /// The same with a number of episodes in the place of the file's, which is not looked at then.
    ///
    /// # Errors
    /// As [`Campaign::load_with`].
    pub fn load_asked(
        path: &Path,
        overlay: &[Setting],
        episodes: Option<u32>,
    ) -> Result<Self, CampaignError> {
        let parse = |text: &str, path: &Path| {
            Self::parse_with_robots(text, path, overlay, &|_| None, episodes)
        };
        let failed = |source| CampaignError::Read {
            path: path.to_path_buf(),
            source,
        };
        if let Some(found) = of_gallery(path) {
            let (path, text) =
                found.map_err(|reason| failed(Error::new(ErrorKind::NotFound, reason)))?;
            return parse(text, &path);
        }
        let text = read_text(path).map_err(failed)?;
        let campaign = parse(&text, path)?;
        campaign.require_files()?;
        Ok(campaign)
    }

    /// Refuses a campaign whose gains files are not there. A run's campaign is parsed again without this: its gains are
    /// in the run's own directory.
    fn require_files(&self) -> Result<(), CampaignError> {
        self.groups()
            .iter()
            .enumerate()
            .try_for_each(|(index, group)| {
                let prefix = match self.has_named_groups() {
                    true => format!("group[{index}]."),
                    false => String::new(),
                };
                group.require_files(&self.check(prefix))
            })
    }

    /// Checks the text of a campaign file; `path` is for messages and for the files that it names.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, CampaignError> {
        Self::parse_with(text, path, &[])
    }

    /// The same with settings laid over the text, one after the other.
    ///
    /// # Errors
    /// As [`Campaign::load_with`].
    pub fn parse_with(text: &str, path: &Path, overlay: &[Setting]) -> Result<Self, CampaignError> {
        Self::parse_with_robots(text, path, overlay, &|_| None, None)
    }

    /// The same with the text of the robot's file of each group, by its name, where that is at hand and the file may
    /// not be there; and with a number of episodes in the place of the file's.
    ///
    /// # Errors
    /// As [`Campaign::load_with`].
    pub fn parse_with_robots(
        text: &str,
        path: &Path,
        overlay: &[Setting],
        robots: &dyn Fn(&str) -> Option<String>,
        episodes: Option<u32>,
    ) -> Result<Self, CampaignError> {
        let source = Source {
            path,
            text,
            overlay,
            episodes,
        };
        let root = ValueDeserializer::from(source.root()?);
        let file = CampaignFile::deserialize(root).map_err(|error| source.syntax(error))?;
        validate(file, source, robots)
    }

    /// The same with another number of episodes than the file's.
    ///
    /// # Errors
    /// If the sampling design cannot divide so many into equal replicates, or the strata do not go round once.
    pub fn with_episodes(self, episodes: u32) -> Result<Self, CampaignError> {
        let check = self.check(String::new());
        check.divides("--episodes", self.sampling, episodes)?;
        check.goes_round("--episodes", &self.strata, episodes)?;
        Ok(self.with(|campaign| {
            campaign.episodes = episodes;
            campaign.episodes_given = Some(episodes);
        }))
    }

    /// The same with another seed than the file's.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        self.with(|campaign| campaign.seed = seed)
    }

    /// The limits that a text such as "rmse position p50 <= 1.05" sets on how a controller compares with another one.
    ///
    /// # Errors
    /// If there is no such measure, or no number of the campaign's episodes proves it.
    pub(crate) fn demanded(
        &self,
        controller: &str,
        compared: &Compared,
        text: &str,
    ) -> Result<Vec<Requirement>, CampaignError> {
        let check = self.check(String::new());
        check.demanded(text, controller, compared, self)
    }

    /// The JSON Schema of the campaign file.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(CampaignFile).to_value()
    }
}

impl Common {
    /// To refuse something after the campaign was read.
    fn check(&self, prefix: String) -> Check<'_> {
        let source = Source {
            path: &self.path,
            text: &self.text,
            overlay: &self.overlay,
            episodes: self.episodes_given,
        };
        Check::new(source, prefix)
    }

    /// Refuses the value of a key after the campaign was read, where only gains or a device can tell.
    pub(crate) fn invalid(
        &self,
        key: &str,
        value: impl Display,
        limit: &str,
        remedy: &str,
    ) -> CampaignError {
        self.check(String::new()).invalid(key, value, limit, remedy)
    }
}

impl GroupParts {
    /// Refuses gains files that are not there.
    fn require_files(&self, check: &Check<'_>) -> Result<(), CampaignError> {
        let own = self
            .synthesis
            .gains
            .iter()
            .map(|path| ("synthesis.gains".to_string(), path));
        let named = &self.synthesis.named;
        let of_named = named.iter().map(|named| {
            (
                format!("synthesis.named.{}.gains", named.name),
                &named.gains,
            )
        });
        match own.chain(of_named).find(|(_, path)| !path.is_file()) {
            Some((key, path)) => {
                let limit = if path.is_dir() {
                    "a directory, not a file"
                } else {
                    "no such file"
                };
                // As it was written: beside the campaign.
                let folder = self.path.parent().unwrap_or(Path::new(""));
                let name = path.strip_prefix(folder).unwrap_or(path);
                Err(check.invalid(
                    key,
                    format!("{:?}", name.display().to_string()),
                    limit,
                    "name a gains.json, relative to the campaign",
                ))
            }
            None => Ok(()),
        }
    }
}
