//! What can be wrong with a robot file.

use crate::util::text_file::read_text;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file that is no robot, and why.
#[derive(Debug, Error)]
pub enum RobotError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); name an existing robot file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Neither a joint table nor a URDF by its name.
    #[error("{}: a robot file ends in .toml (joint table) or .urdf; rename it or name another", path.display())]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// Not TOML or XML, or a key or type that the format does not know.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The place if it is known, what is wrong and what to do.
        message: String,
    },
    /// A value out of its limits, or a structure that is no biped.
    #[error("{}: {key} = {value}: {limit}; {remedy}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The quantity and the link or joint that it belongs to.
        key: String,
        /// The value as it was understood.
        value: String,
        /// The limit that it breaks.
        limit: String,
        /// What to write instead.
        remedy: String,
    },
}

/// The text of a robot file.
pub(super) fn read(path: &Path) -> Result<String, RobotError> {
    read_text(path).map_err(|source| RobotError::Read {
        path: path.to_path_buf(),
        source,
    })
}
