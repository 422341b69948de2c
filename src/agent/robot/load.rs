//! Robots from their files.

use super::error::{self, RobotError};
use super::structure::Robot;
use super::table;
use super::urdf::{self, UrdfOptions};
use std::path::Path;

/// Where the shipped G1 is.
pub(crate) const G1_PATH: &str = "campaigns/robots/g1_12dof.toml";
/// The shipped G1.
pub(crate) const G1: &str = include_str!("../../../campaigns/robots/g1_12dof.toml");

/// The robots of the gallery, by their paths there.
const GALLERY: &[(&str, &str)] = &[
    ("gallery:/robots/g1_12dof.toml", G1),
    (
        "gallery:/robots/berkeley_humanoid.toml",
        include_str!("../../../campaigns/robots/berkeley_humanoid.toml"),
    ),
];

/// What a robot's file is.
enum Format {
    Table,
    Urdf,
}

impl Format {
    fn of(path: &Path) -> Result<Self, RobotError> {
        let is = |known: &str| {
            path.extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case(known))
        };
        if is("toml") {
            Ok(Self::Table)
        } else if is("urdf") {
            Ok(Self::Urdf)
        } else {
            Err(RobotError::Format {
                path: path.to_path_buf(),
            })
        }
    }
}

impl Robot {
    /// Reads a robot: a joint table (`.toml`) or a URDF (`.urdf`, with the default [`UrdfOptions`]).
    ///
    /// # Errors
    /// If the file is unreadable or is no such robot, with file, key, value, limit and remedy.
    pub fn load(path: &Path) -> Result<Self, RobotError> {
        Self::parse(&Self::text(path)?, path)
    }

    /// The text of a robot's file.
    ///
    /// # Errors
    /// If the file is unreadable, or neither a joint table nor a URDF by its name.
    pub fn text(path: &Path) -> Result<String, RobotError> {
        Format::of(path)?;
        let shipped = GALLERY.iter().find(|(own, _)| Path::new(own) == path);
        match shipped {
            Some((_, text)) => Ok((*text).to_string()),
            None => error::read(path),
        }
    }

    /// Checks the text of a robot's file; `path` says what it is, and is for messages.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, RobotError> {
        Self::parse_with(text, path, &UrdfOptions::default())
    }

    /// The same with what a URDF does not say; a joint table has no use for it.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn parse_with(text: &str, path: &Path, options: &UrdfOptions) -> Result<Self, RobotError> {
        match Format::of(path)? {
            Format::Table => table::parse(text, path),
            Format::Urdf => urdf::parse(text, path, options),
        }
    }

    /// The Unitree G1 with its upper body locked (campaigns/robots/g1_12dof.toml).
    ///
    /// # Errors
    /// Never, as the tests show: the table is part of the program.
    pub fn g1() -> Result<Self, RobotError> {
        table::parse(G1, Path::new(G1_PATH))
    }
}
