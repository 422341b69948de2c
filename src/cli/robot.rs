//! `urts-mc robot`: what was understood of a robot's file, and whether it can walk.

use super::console::{print, print_json};
use super::exit::{Code, Failure};
use clap::Args;
use std::path::{Path, PathBuf};
use urts_mc::agent::Agent;
use urts_mc::agent::robot::Robot;
use urts_mc::campaign::{Campaign, CampaignError, Setting};
use urts_mc::reference::Reference;
use urts_mc::reference::walk::Walk;
use urts_mc::report::{robot_picture, terminal};
use urts_mc::run::output_file::OutputFile;
use urts_mc::util::hidden::spelled_out;

#[derive(Debug, Args)]
pub(crate) struct RobotArguments {
    /// A joint table (.toml) or a URDF
    pub(crate) file: PathBuf,
    /// Set a key of a campaign's [agent] or [reference] to a TOML value, such as
    /// agent.pelvis=torso or reference.gait.step_length_m=0.1. Repeatable
    #[arg(long, value_name = "KEY=VALUE", verbatim_doc_comment)]
    pub(crate) set: Vec<Setting>,
    /// Write a picture of the legs
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) svg: Option<PathBuf>,
    /// Replace the file of --svg
    #[arg(long, requires = "svg")]
    pub(crate) overwrite: bool,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Reads a robot as a campaign of such robots would, and plans a walk of theirs.
pub(super) fn robot_command(arguments: &RobotArguments) -> Result<Code, Failure> {
    if let Some(svg) = arguments
        .svg
        .as_ref()
        .filter(|svg| svg.exists() && !arguments.overwrite)
    {
        return Err(Failure::usage(format!(
            "--svg {}: exists already; give another name, or --overwrite",
            svg.display()
        )));
    }
    let of_reference = |setting: &&Setting| setting.to_string().starts_with("reference");
    let of_agent: Vec<Setting> = arguments
        .set
        .iter()
        .filter(|own| !of_reference(own))
        .cloned()
        .collect();
    let standing = campaign(&arguments.file, "kind = \"sinusoid\"", &of_agent)?;
    let Some(Agent::Biped(biped)) = standing.groups().first().map(|group| &group.agent) else {
        return Err(Failure::usage(
            "--set agent.kind: a robot is a biped".into(),
        ));
    };
    let robot = &visible(&biped.robot);
    let walk = walk(arguments)?;
    if let Some(svg) = &arguments.svg {
        OutputFile::claim(svg)?.write(robot_picture(robot).as_bytes())?;
    }
    if arguments.json {
        print_json(&terminal::robot_json(robot, &walk))?;
    } else {
        print(&terminal::robot(robot, &walk))?;
    }
    Ok(Code::Done)
}

/// The same with all that its file says in characters that can be seen.
fn visible(robot: &Robot) -> Robot {
    let mut shown = robot.clone();
    let joints = shown.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let texts = [&mut shown.name, &mut shown.licence, &mut shown.attribution];
    let texts = texts.into_iter().chain(&mut shown.notes);
    for text in texts.chain(joints.map(|joint| &mut joint.name)) {
        *text = spelled_out(text);
    }
    shown
}

/// The walk along the line that is asked for, or why there is none and what to do.
fn walk(arguments: &RobotArguments) -> Result<Result<Walk, String>, Failure> {
    let line = "kind = \"walk\"\npoints_m = [[0.0, 0.0], [1.0, 0.0]]";
    let campaign = match campaign(&arguments.file, line, &arguments.set) {
        Ok(campaign) => campaign,
        // What no gait could be is a mistake of who asks; that the robot cannot walk it is an answer.
        Err(CampaignError::Invalid {
            key,
            value,
            limit,
            remedy,
            ..
        }) if key.starts_with("reference.") => {
            let wrong = match key.starts_with("reference.points_m") {
                true => String::new(),
                false => format!("{key} = {value}: "),
            };
            return Ok(Err(format!("{wrong}{limit}; {remedy}")));
        }
        Err(error) => return Err(error.into()),
    };
    match campaign.groups().first().map(|group| &group.reference) {
        Some(Reference::Walk(walks)) if !walks.is_empty() => Ok(Ok(Walk::clone(&walks[0].walk))),
        _ => Err(Failure::usage("--set reference.kind: a robot walks".into())),
    }
}

/// A campaign of one such robot, written as its users write one.
fn campaign(file: &Path, reference: &str, settings: &[Setting]) -> Result<Campaign, CampaignError> {
    let robot = toml::Value::String(file.display().to_string());
    let text = format!(
        "name = \"robot\"\nseed = 1\nepisodes = 1\n[time]\nduration_s = 1.0\nstep_s = 0.002\n[agent]\nkind = \"biped\"\nrobot = {robot}\n\
         [reference]\n{reference}\n[synthesis]\npreset = \"biped-paper\"\n"
    );
    Campaign::parse_with(&text, Path::new("urts-mc robot"), settings)
}
