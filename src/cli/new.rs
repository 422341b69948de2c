//! `urts-mc new`: a campaign to begin with.

use super::console::print;
use super::exit::{Code, Failure};
use clap::{Args, ValueEnum};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use urts_mc::agent::robot::Robot;
use urts_mc::campaign::Campaign;
use urts_mc::campaign::gallery::{GALLERY, renamed};
use urts_mc::report::terminal;

#[derive(Debug, Args)]
pub(crate) struct NewArguments {
    /// Name of the campaign; its file is NAME.toml, here
    #[arg(required_unless_present = "list")]
    pub(crate) name: Option<String>,
    /// What flies or walks in it
    #[arg(long, value_enum, default_value = "uav")]
    pub(crate) kind: KindChoice,
    /// The campaign of the gallery that it is made from
    /// [default: smoke of a UAV, biped-turn of a biped]
    #[arg(
        long,
        value_name = "NAME",
        verbatim_doc_comment,
        conflicts_with = "kind"
    )]
    pub(crate) from: Option<String>,
    /// Show the campaigns of the gallery
    #[arg(long, conflicts_with_all = ["name", "from", "kind"])]
    pub(crate) list: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum KindChoice {
    Uav,
    Biped,
}

/// Writes a campaign of the gallery under another name into the folder where the program runs, with the robot's file
/// that it names; nothing is replaced.
pub(super) fn new_command(arguments: &NewArguments) -> Result<Code, Failure> {
    let Some(name) = arguments.name.as_deref().filter(|_| !arguments.list) else {
        print(&terminal::gallery(&listed()?))?;
        return Ok(Code::Done);
    };
    let usual = match arguments.kind {
        KindChoice::Uav => "smoke",
        KindChoice::Biped => "biped-turn",
    };
    let from = arguments.from.as_deref().unwrap_or(usual);
    let whole = Path::new("gallery:").join(from);
    // Says what the gallery has, if it has no such campaign.
    let campaign = Campaign::load(&whole)?;
    let text = renamed(&campaign.text, from, name);
    let file = format!("{name}.toml");
    // What the name or the robot's file would break is said before anything is written.
    Campaign::parse(&text, &whole)?;
    let robots = campaign
        .groups()
        .iter()
        .filter_map(|group| group.agent.file());
    let named = robots.filter_map(|robot| robot.path.strip_prefix("gallery:").ok());
    let mut written = vec![file.clone()];
    written.extend(named.map(|path| path.display().to_string()));
    for path in &written {
        if Path::new(path).exists() {
            return Err(Failure::usage(format!(
                "{path}: exists already; give another name, or move it away"
            )));
        }
    }
    for path in &written {
        let text = match *path == file {
            true => text.clone(),
            false => Robot::text(&Path::new("gallery:").join(path))
                .map_err(|error| Failure::usage(error.to_string()))?,
        };
        write_new(path, &text)?;
    }
    print(&format!(
        "written: {}\n\nurts-mc check {file}\nurts-mc run {file}\n",
        written.join(", ")
    ))?;
    Ok(Code::Done)
}

/// The gallery: each campaign's name, and what it is for.
fn listed() -> Result<Vec<(String, String)>, Failure> {
    let of_campaign = |(name, _): &(&str, &str)| {
        let campaign = Campaign::load(&Path::new("gallery:").join(name))?;
        Ok((format!("gallery:{name}"), campaign.description.clone()))
    };
    GALLERY.iter().map(of_campaign).collect()
}

/// Writes a file that is not there yet, with the folders that lead to it.
fn write_new(path: &str, text: &str) -> Result<(), Failure> {
    let path = Path::new(path);
    let written = path
        .parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| OpenOptions::new().write(true).create_new(true).open(path))
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| {
        Failure::usage(format!(
            "{}: cannot be written ({error}); run it in another folder",
            path.display()
        ))
    })
}
