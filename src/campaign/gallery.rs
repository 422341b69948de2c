//! The shipped campaigns, which are part of the program: `gallery:smoke` names one wherever there is no file.

use crate::util::suggest::did_you_mean;
use std::path::{Path, PathBuf};

/// The folder that stands for the gallery in paths.
const FOLDER: &str = "gallery:";

macro_rules! gallery {
    ($($name:literal,)*) => {
        /// Every shipped campaign: name and text, those to begin with first.
        pub const GALLERY: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../campaigns/", $name, ".toml"))),)*
        ];
    };
}

gallery! {
    "smoke",
    "uav-paper",
    "uav-physical",
    "waypoints",
    "uav-faults",
    "uav-attack",
    "uav-dead-zone",
    "uav-digital",
    "no-fault",
    "biped-paper",
    "biped-turn",
    "biped-faults",
    "biped-ground-reaction",
    "biped-berkeley",
    "mixed-teams",
    "scenario-a",
    "scenario-b",
    "scenario-biped",
    "paper-robots",
    "bench-uav",
    "bench-biped",
}

/// The campaign that a path names in the gallery: its place there and its text; none of a path that names a file.
///
/// # Errors
/// If the gallery has no such campaign: what it has, and the nearest name.
pub(super) fn of_gallery(path: &Path) -> Option<Result<(PathBuf, &'static str), String>> {
    let name = path.to_str()?.strip_prefix(FOLDER)?;
    let name = name.trim_start_matches('/');
    let known = GALLERY.iter().find(|(own, _)| *own == name);
    let Some((name, text)) = known else {
        let names = GALLERY.iter().map(|(own, _)| *own);
        let remedy = did_you_mean(name, names, "urts-mc new --list shows them");
        return Some(Err(format!(
            "the gallery has no campaign {name:?}; {remedy}"
        )));
    };
    Some(Ok((Path::new(FOLDER).join(name), text)))
}

/// The text of a gallery's campaign as a file of another name begins: with a remark on where it comes from.
#[must_use]
pub fn renamed(text: &str, from: &str, name: &str) -> String {
    let own = text.replacen(&format!("name = {from:?}"), &format!("name = {name:?}"), 1);
    format!(
        "# Made from gallery:{from}. `urts-mc check {name}.toml` says what would be drawn, `urts-mc run {name}.toml` flies it.\n{own}"
    )
}
