//! Settings laid over a campaign file: `key=value` as `--set` takes them.

use crate::util::suggest::did_you_mean;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A change of one key of a campaign file.
///
/// - `fault.0.magnitude=0.4` sets a key, whether the file has it or not; tables on the way to it are made.
/// - `fault.0.magnitude=` removes a key; so does `fault.0=` an entry of a list, and `stop=` a whole table.
/// - `fault.+={ .. }` appends an entry to a list, and so does the first number that is not taken.
///
/// The key is written as in error messages, `fault[0].magnitude`, or with dots alone. The value is TOML; a word or path
/// that is not TOML is taken as a string: `sampling.design=sobol`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Setting {
    /// The whole of it, as it was written.
    written: String,
    /// The key, one step into a table or list after the other; at least one.
    steps: Vec<Step>,
    /// Where the value begins in what was written.
    value: usize,
}

/// A step from a table or list to what is in it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Step {
    /// A name, a number, or `+` for the entry after the last.
    name: String,
    /// How many bytes of the setting lead to it, itself included.
    end: usize,
}

/// What is wrong with a setting.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{limit}; {remedy}")]
pub struct SettingError {
    /// The limit that it breaks.
    pub limit: String,
    /// What to write instead.
    pub remedy: String,
}

impl SettingError {
    fn new(limit: impl Into<String>, remedy: impl Into<String>) -> Self {
        let (limit, remedy) = (limit.into(), remedy.into());
        Self { limit, remedy }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written)
    }
}

impl From<Setting> for String {
    fn from(setting: Setting) -> Self {
        setting.written
    }
}

impl TryFrom<String> for Setting {
    type Error = SettingError;

    fn try_from(written: String) -> Result<Self, SettingError> {
        let Some((key, _)) = written.split_once('=') else {
            return Err(SettingError::new(
                "a setting is a key and its value",
                "write key=value, or key= to remove the key",
            ));
        };
        let setting = Self {
            steps: steps(key)?,
            value: key.len() + 1,
            written,
        };
        setting.value()?;
        Ok(setting)
    }
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(written: &str) -> Result<Self, SettingError> {
        written.to_string().try_into()
    }
}

/// The steps of a key: names and numbers with dots between, numbers in brackets too.
fn steps(key: &str) -> Result<Vec<Step>, SettingError> {
    let wrong = || {
        SettingError::new(
            format!("{key:?} is not a key"),
            "write names and numbers with dots between, such as fault.0.magnitude; numbers count from 0, + appends",
        )
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let mut steps = Vec::new();
    let mut end = 0;
    for part in key.split('.') {
        // After the first bracket come numbers, each with its closing bracket.
        for (k, piece) in part.split('[').enumerate() {
            let piece_end = end + piece.len();
            let name = match k {
                0 => Some(piece),
                _ => piece.strip_suffix(']').filter(|name| is_entry(name)),
            };
            let name = name.map(str::trim).ok_or_else(wrong)?;
            if name != "+" && (name.is_empty() || !name.chars().all(plain)) {
                return Err(wrong());
            }
            steps.push(Step {
                name: name.to_string(),
                end: piece_end,
            });
            end = piece_end + 1;
        }
    }
    Ok(steps)
}

/// Whether a step can only lead to an entry of a list.
fn is_entry(name: &str) -> bool {
    name == "+" || (!name.is_empty() && name.chars().all(|c| c.is_ascii_digit()))
}

/// Whether a text is a word or path that nobody takes for a number, so that its quotes may be left out.
fn is_word(text: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
    let is_path = ["/", "./", "../"]
        .iter()
        .any(|begin| text.starts_with(begin));
    let begins = is_path || text.starts_with(|c: char| c.is_ascii_alphabetic());
    begins && text.chars().all(plain)
}

impl Setting {
    /// The setting as it was written.
    pub(super) fn written(&self) -> &str {
        &self.written
    }

    /// The table or key at the top of the file that it changes.
    pub(crate) fn table(&self) -> &str {
        self.steps.first().map_or("", |step| &step.name)
    }

    /// The value; none removes the key.
    fn value(&self) -> Result<Option<DeValue<'_>>, SettingError> {
        let text = self.written[self.value..].trim();
        match DeValue::parse(text) {
            _ if text.is_empty() => Ok(None),
            Ok(value) => Ok(Some(value.into_inner())),
            Err(_) if is_word(text) => Ok(Some(DeValue::String(Cow::Borrowed(text)))),
            Err(error) => Err(SettingError::new(
                format!("{text:?} is not a TOML value ({})", error.message()),
                "write a number, true, [1, 2], [\"a\", \"b\"], { a = \"table\" } or \"text\" in double quotes; put the whole setting in single quotes for the shell",
            )),
        }
    }

    /// The beginning of the key, as far as a number of steps.
    fn so_far(&self, steps: usize) -> &str {
        let end = steps.checked_sub(1).map_or(0, |last| self.steps[last].end);
        &self.written[..end]
    }

    /// Lays this setting over a file's root; what is new gets the position `place`.
    pub(super) fn laid<'a>(
        &'a self,
        root: Spanned<DeValue<'a>>,
        place: &Range<usize>,
    ) -> Result<Option<Spanned<DeValue<'a>>>, SettingError> {
        let value = self.value()?.map(|value| placed(value, place));
        self.laid_at(0, Some(root), value, place)
    }

    /// Lays a value over what the first `k` steps of the key lead to, `None` if there is nothing.
    fn laid_at<'a>(
        &'a self,
        k: usize,
        here: Option<Spanned<DeValue<'a>>>,
        value: Option<Spanned<DeValue<'a>>>,
        place: &Range<usize>,
    ) -> Result<Option<Spanned<DeValue<'a>>>, SettingError> {
        let Some(step) = self.steps.get(k) else {
            return Ok(value);
        };
        let name = step.name.as_str();
        let here = here.unwrap_or_else(|| {
            let empty = match is_entry(name) {
                true => DeValue::Array(DeArray::new()),
                false => DeValue::Table(DeTable::new()),
            };
            Spanned::new(place.clone(), empty)
        });
        let span = here.span();
        let changed = match here.into_inner() {
            DeValue::Table(mut table) if name != "+" => {
                let (key, old) = table.remove_entry(name).unzip();
                if old.is_none() && value.is_none() {
                    return Err(self.no_key(k, &table));
                }
                if let Some(new) = self.laid_at(k + 1, old, value, place)? {
                    let here = Spanned::new(place.clone(), Cow::Borrowed(name));
                    let key = key.filter(|_| k + 1 < self.steps.len()).unwrap_or(here);
                    table.insert(key, new);
                }
                DeValue::Table(table)
            }
            DeValue::Array(list) => {
                let mut list: Vec<_> = list.into_iter().collect();
                let index = match name {
                    "+" => Some(list.len()),
                    number => number.parse().ok(),
                };
                // The entry after the last is there to be made, not to be removed.
                let entries = list.len() + usize::from(value.is_some());
                let Some(index) = index.filter(|&index| index < entries) else {
                    return Err(self.no_entry(k, list.len()));
                };
                let old = (index < list.len()).then(|| list.remove(index));
                if let Some(new) = self.laid_at(k + 1, old, value, place)? {
                    list.insert(index, new);
                }
                DeValue::Array(list.into_iter().collect())
            }
            other => return Err(self.no_way(k, &other)),
        };
        Ok(Some(Spanned::new(span, changed)))
    }

    /// What `k` steps lead to, in an error.
    fn shown(&self, k: usize) -> String {
        match k {
            0 => "the file".to_string(),
            _ => self.so_far(k).to_string(),
        }
    }

    /// Step `k` leads to nothing that could be removed.
    fn no_key(&self, k: usize, table: &DeTable<'_>) -> SettingError {
        let name = self.steps[k].name.as_str();
        let known = table.keys().map(|key| key.get_ref().as_ref());
        let limit = format!("there is no {} to be removed", self.so_far(k + 1));
        SettingError::new(limit, did_you_mean(name, known, "leave it out"))
    }

    /// Step `k` leads to none of the entries of a list.
    fn no_entry(&self, k: usize, entries: usize) -> SettingError {
        let list = self.so_far(k);
        let some = match entries {
            0 => "it is empty".to_string(),
            1 => format!("its only entry is {list}.0"),
            _ => format!("its entries are {list}.0 to {list}.{}", entries - 1),
        };
        let limit = format!("the list {list} has no entry {}", self.steps[k].name);
        SettingError::new(limit, format!("{some}; {list}.+ appends one"))
    }

    /// Step `k` leads into something that is neither table nor list, or behind the end of a table.
    fn no_way(&self, k: usize, here: &DeValue<'_>) -> SettingError {
        let what = self.shown(k);
        match here {
            DeValue::Table(_) => SettingError::new(
                format!("{what} is a table, and + appends to a list"),
                "name a key of it",
            ),
            single => {
                let kind = single.type_str();
                SettingError::new(
                    format!("{what} is of type {kind}, which has no keys"),
                    format!("set {what} itself, to a table or a list"),
                )
            }
        }
    }
}

/// A value of a setting, with all that is in it, at the place of that setting.
fn placed<'a>(value: DeValue<'a>, place: &Range<usize>) -> Spanned<DeValue<'a>> {
    let inner = |value: Spanned<DeValue<'a>>| placed(value.into_inner(), place);
    let value = match value {
        DeValue::Array(list) => DeValue::Array(list.into_iter().map(inner).collect()),
        DeValue::Table(table) => {
            let entries = table.into_iter().map(|(key, value)| {
                let key = Spanned::new(place.clone(), key.into_inner());
                (key, inner(value))
            });
            DeValue::Table(entries.collect())
        }
        single => single,
    };
    Spanned::new(place.clone(), value)
}
