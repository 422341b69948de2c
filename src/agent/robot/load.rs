//! Robots from their files.

use super::check::Check;
use super::error::{self, RobotError};
use super::standing;
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

/// Whether a robot's file is a URDF by its name.
#[must_use]
pub(crate) fn is_urdf(path: &Path) -> bool {
    matches!(Format::of(path), Ok(Format::Urdf))
}

/// The robot of a table with another standing pose and other rotors, where they are given.
fn adapted(mut robot: Robot, path: &Path, options: &UrdfOptions) -> Result<Robot, RobotError> {
    let names = &table::NAMES;
    let check = Check { path, names };
    let joints = robot.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    for (joint, armature_kg_m2) in joints.zip(options.armature_kg_m2.iter().flatten()) {
        let key = format!("{} ({})", names.armature, joint.name);
        check.not_negative(&key, *armature_kg_m2, "an armature")?;
        joint.armature_kg_m2 = *armature_kg_m2;
    }
    if let Some(standing) = &options.standing {
        robot.standing_rad = standing::angles_rad(&check, &robot.legs, standing)?;
        robot.base_height_m = standing::height_m(&robot.legs, &robot.standing_rad);
        check.positive(
            "standing",
            robot.base_height_m,
            "the height of the pelvis above the soles",
        )?;
    }
    Ok(robot)
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

    /// The same with what a URDF does not say. Of a joint table, which says the rest itself, the standing pose and the
    /// inertias of the rotors are replaced where they are given.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn parse_with(text: &str, path: &Path, options: &UrdfOptions) -> Result<Self, RobotError> {
        match Format::of(path)? {
            Format::Table => adapted(table::parse(text, path)?, path, options),
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
