//! The text of a campaign file with the settings that are laid over it, and where each of its keys stands.

use super::error::{CampaignError, syntax};
use super::overlay::{Setting, SettingError};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text of a campaign file and what is laid over it.
///
/// Every key and value has a place: a range of bytes of the text or, behind its end, one for each setting.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    /// The file.
    pub(super) path: &'a Path,
    /// Its text.
    pub(super) text: &'a str,
    /// What is laid over it, in this order.
    pub(super) overlay: &'a [Setting],
    /// The number of episodes in the place of the file's, if there is one.
    pub(super) episodes: Option<u32>,
}

impl<'a> Source<'a> {
    /// The file's keys and values with the settings laid over them.
    pub(super) fn root(&self) -> Result<Spanned<DeValue<'a>>, CampaignError> {
        let parsed = DeTable::parse(self.text).map_err(|error| self.syntax(error))?;
        let mut root = Spanned::new(parsed.span(), DeValue::Table(parsed.into_inner()));
        for (setting, place) in self.settings() {
            let laid = setting.laid(root, &place);
            let laid = laid.map_err(|error| self.refused(setting, error))?;
            // A key has at least one step, so that the root is never removed itself.
            root = laid.unwrap_or_else(|| Spanned::new(place, DeValue::Table(DeTable::new())));
        }
        Ok(root)
    }

    /// The path of a file that is named relative to the campaign's folder.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    fn refused(&self, setting: &Setting, error: SettingError) -> CampaignError {
        CampaignError::Setting {
            path: self.path.to_path_buf(),
            setting: setting.to_string(),
            error,
        }
    }

    /// The settings with their places.
    fn settings(&self) -> impl Iterator<Item = (&'a Setting, Range<usize>)> + use<'a> {
        let mut end = self.text.len();
        self.overlay.iter().map(move |setting| {
            let start = end + 1;
            end = start + setting.written().len();
            (setting, start..end)
        })
    }

    /// What is wrong with the text or with a setting, in the words of a campaign's writer.
    pub(super) fn syntax(&self, mut error: toml::de::Error) -> CampaignError {
        let place = error.span().map_or(0, |span| span.start);
        error.set_input(Some(self.text));
        syntax(self.path, &error, self.setting_at(place))
    }

    /// A table that the file lacks.
    pub(super) fn missing(&self, table: &str) -> CampaignError {
        CampaignError::Syntax {
            path: self.path.to_path_buf(),
            message: format!("missing key or table `{table}`; add it"),
        }
    }

    /// The setting at a place behind the text.
    fn setting_at(&self, place: usize) -> Option<&'a Setting> {
        let mut all = self.settings();
        all.find(|(_, own)| own.contains(&place))
            .map(|(setting, _)| setting)
    }

    /// Where a key such as `fault[1].agents[0].std` stands: a line of the file, or a setting. The place of the
    /// innermost table or list around it if it is not there.
    pub(super) fn place_of(&self, key: &str) -> Option<String> {
        let root = self.root().ok()?;
        let mut here = root.get_ref();
        let mut place = None;
        for name in key.split(['.', '[', ']']).filter(|name| !name.is_empty()) {
            let found = match here {
                DeValue::Table(table) => table
                    .get_key_value(name)
                    .map(|(key, value)| (key.span(), value)),
                DeValue::Array(list) => name
                    .parse()
                    .ok()
                    .and_then(|index: usize| list.get(index))
                    .map(|value| (value.span(), value)),
                _ => None,
            };
            let Some((span, value)) = found else { break };
            (place, here) = (Some(span.start), value.get_ref());
        }
        match self.setting_at(place?) {
            Some(setting) => Some(format!("--set {setting}")),
            None => {
                let before = self.text.get(..place?)?;
                Some(format!("line {}", before.matches('\n').count() + 1))
            }
        }
    }
}
