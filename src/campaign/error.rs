//! What can be wrong with a campaign file.

use super::overlay::{Setting, SettingError};
use crate::util::suggest::nearest;
use crate::util::text_file::quoted;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A campaign that cannot be run, and why.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); name an existing campaign file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Not TOML, or a key or type that the format does not know.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, column, what is wrong, and the nearest known key.
        message: String,
    },
    /// The robot's file holds no robot.
    #[error(transparent)]
    Robot(#[from] Box<crate::agent::robot::RobotError>),
    /// A setting that cannot be laid over the file.
    #[error("{}: --set {setting}: {error}", path.display())]
    Setting {
        /// The file.
        path: PathBuf,
        /// The setting, as it was written.
        setting: String,
        /// What is wrong with it.
        error: SettingError,
    },
    /// A value out of its limits, or a contradiction.
    #[error("{}: {key} = {value}: {limit}; {remedy}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The key, with the tables around it and its line, or the setting that it comes from.
        key: String,
        /// The value as it was understood.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to write instead.
        remedy: String,
    },
}

/// A parse error in the words of a campaign's writer, with what to do; `setting` brought in what is wrong, if it is not
/// the file's.
pub(super) fn syntax(
    path: &Path,
    error: &toml::de::Error,
    setting: Option<&Setting>,
) -> CampaignError {
    let message = error.message();
    let shown = error.to_string();
    let line = shown.trim_end().strip_suffix(message).unwrap_or_default();
    let missing = message.starts_with("missing field");
    let place = match setting {
        Some(setting) => format!("--set {setting}: "),
        // What the whole file lacks has no place in it.
        None if missing && error.span().is_none_or(|span| span.start == span.end) => String::new(),
        None => {
            let line = line.strip_prefix("TOML parse error at ").unwrap_or(line);
            line.to_string()
        }
    };
    let remedy = if let Some(hint) = nearest_known(message) {
        format!("; did you mean `{hint}`?")
    } else if message.starts_with("unknown") {
        "; remove it or take one of these".to_string()
    } else if missing {
        "; add it".to_string()
    } else if message.starts_with("duplicate") {
        "; keep one of the two".to_string()
    } else if message.starts_with("invalid length") {
        "; give exactly so many values".to_string()
    } else {
        String::new()
    };
    CampaignError::Syntax {
        path: path.to_path_buf(),
        message: format!("{}{}{remedy}", quoted(&place), plainly(message)),
    }
}

/// A message of the parser in the words of TOML rather than of Rust.
fn plainly(message: &str) -> String {
    [
        ("unknown field", "unknown key"),
        ("unknown variant", "unknown value"),
        ("missing field", "missing key or table"),
        ("type: map", "type: a table"),
        // A number that no whole number of the parser holds.
        (" as i128", ""),
        ("type: sequence", "type: a list"),
        ("expected a sequence", "expected a list"),
        ("expected f64", "expected a number without quotes or unit"),
        (
            "expected u32",
            "expected a whole number from 0 to 4294967295",
        ),
        (
            "expected u64",
            "expected a whole number from 0 to 18446744073709551615",
        ),
        ("expected usize", "expected a whole number from 0"),
    ]
    .into_iter()
    .fold(message.to_string(), |text, (rust, plain)| {
        text.replace(rust, plain)
    })
}

/// The expected name that is nearest to the unknown one, from a message of the form "unknown field `a`, expected one of
/// `b`, `c`".
fn nearest_known(message: &str) -> Option<&str> {
    if !message.starts_with("unknown field") && !message.starts_with("unknown variant") {
        return None;
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    nearest(quoted.next()?, quoted)
}
