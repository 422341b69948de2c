//! What can be wrong with a campaign file.

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
    /// A value out of its limits, or a contradiction.
    #[error("{}: {key} = {value}: {limit}; {remedy}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The key, with the tables around it.
        key: String,
        /// The value as it was understood.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to write instead.
        remedy: String,
    },
}

/// A parse error, with the nearest known key where a key is unknown.
pub(super) fn syntax(path: &Path, error: &toml::de::Error) -> CampaignError {
    let mut message = error.to_string().trim_end().to_string();
    if let Some(hint) = nearest_known(error.message()) {
        message.push_str(&format!("\ndid you mean `{hint}`?"));
    }
    CampaignError::Syntax {
        path: path.to_path_buf(),
        message,
    }
}

/// The expected name that is nearest to the unknown one, from a message of the form "unknown field `a`, expected one of
/// `b`, `c`".
fn nearest_known(message: &str) -> Option<&str> {
    if !message.starts_with("unknown field") && !message.starts_with("unknown variant") {
        return None;
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = quoted.next()?;
    quoted
        .map(|known| {
            (
                strsim::normalized_damerau_levenshtein(unknown, known),
                known,
            )
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(similarity, _)| *similarity >= 0.5)
        .map(|(_, known)| known)
}
