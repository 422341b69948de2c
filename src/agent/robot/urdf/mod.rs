//! A robot from a URDF: two legs of six revolute joints on a pelvis. Every other joint is fixed, and its link is part
//! of the one that carries it.

mod bodies;
mod feet;
mod legs;
mod options;
mod syntax;
mod tree;

use super::check::{Check, LARGEST, Names, Place, RawJoint};
use super::error::{self, RobotError};
use super::standing::height_m;
use super::structure::{Body, Foot, JOINTS, Joint, LEFT, LEG_JOINTS, Leg, RIGHT, Robot};
use nalgebra::{Isometry3, Vector3};
use std::path::Path;
use syntax::{Limit, Urdf};
use tree::{Moving, Tree};

pub use options::{Soles, Standing, UrdfOptions};

const NAMES: Names = Names {
    mass: "inertial mass",
    com: "inertial origin xyz",
    inertia: "inertial inertia",
    xyz: "origin xyz",
    rpy: "origin rpy",
    axis: "axis xyz",
    q_min: "limit lower",
    q_max: "limit upper",
    rate_max: "limit velocity",
    torque_max: "limit effort",
    armature: "armature_kg_m2",
    damping: "dynamics damping",
};

/// Inertia of a rotor as seen from its joint where nobody says it, kg m^2.
const DEFAULT_ARMATURE_KG_M2: f64 = 0.01;

/// Reads a URDF.
///
/// # Errors
/// If the file is unreadable or is no biped, with the link or joint, value, limit and remedy.
pub fn load(path: &Path, options: &UrdfOptions) -> Result<Robot, RobotError> {
    parse(&error::read(path)?, path, options)
}

/// Checks the text of a URDF; `path` is for messages.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, path: &Path, options: &UrdfOptions) -> Result<Robot, RobotError> {
    let urdf = syntax::read(text, path)?;
    let names = &NAMES;
    let check = Check { path, names };
    check.finite("gravity_m_s2", &options.gravity_m_s2.as_slice())?;
    let tree = Tree::new(&check, &urdf, &options.locked)?;
    let mut notes = Vec::new();
    let mut locked = options.locked.clone();
    let mut pelvis = options.pelvis.clone();
    // Arms, a waist, a head: what is no leg is held still.
    let moving = moving(&tree, pelvis.as_deref())?;
    if moving.is_none_or(|legs| legs < 2) {
        let found = legs::find(&tree, &urdf, pelvis.as_deref())?;
        if let Some(found) = found {
            let own = found.locked.iter().filter(|name| !locked.contains(name));
            let own: Vec<String> = own.cloned().collect();
            notes.push(legs::held(&own));
            locked.extend(own);
            pelvis = Some(found.pelvis);
        } else if pelvis.is_none() && moving.is_none() {
            return Err(legs::none(&check, &tree.limbs()?));
        }
    }
    let tree = Tree::new(&check, &urdf, &locked)?;
    let pelvis = tree.pelvis(pelvis.as_deref())?;
    let rigid = tree.rigid(pelvis)?;
    let [left, right] = hips(&check, &tree, &rigid.moving, options, &mut notes)?;
    let base = tree.trunk(pelvis, &rigid, &mut notes)?;
    let [left_armature, right_armature] = match &options.armature_kg_m2 {
        Some(all) => halves(all).map(Some),
        None => [None; 2],
    };
    let mut legs = [
        leg(&check, &tree, &left, left_armature)?,
        leg(&check, &tree, &right, right_armature)?,
    ];
    notes.extend(assumed(&urdf, &legs, options));
    let standing_rad = feet::set(&check, &tree, &mut legs, options)?;
    notes.extend(feet::assumed(options));
    let height_m = height_m(&legs, &standing_rad);
    // A root frame on the ground (REP-120) is no pelvis: the link that carries the legs is.
    let [carrier, other] = [left, right].map(|hip| tree.carrier_of(&hip.joint.name));
    if options.pelvis.is_none()
        && carrier == other
        && height_m <= 0.0
        && !tree.is_named(pelvis, &carrier)
    {
        let options = UrdfOptions {
            pelvis: Some(carrier.clone()),
            ..options.clone()
        };
        let mut robot = parse(text, path, &options)?;
        robot.notes.push(format!(
            "the root frame lies on the ground; the pelvis is {carrier}, which carries the legs"
        ));
        return Ok(robot);
    }
    let base_height_m = options.base_height_m.unwrap_or(height_m);
    check.positive(
        "base_height_m",
        base_height_m,
        "the height of the pelvis above the soles",
    )?;
    Ok(Robot {
        name: urdf.name.clone(),
        licence: options.licence.clone(),
        attribution: options.attribution.clone(),
        gravity_m_s2: options.gravity_m_s2,
        base,
        base_height_m,
        standing_rad,
        legs,
        notes,
    })
}

/// The first joint of the left and of the right leg.
fn hips<'a>(
    check: &Check<'_>,
    tree: &Tree<'a>,
    moving: &[Moving<'a>],
    options: &UrdfOptions,
    notes: &mut Vec<String>,
) -> Result<[Moving<'a>; 2], RobotError> {
    let [one, other] = moving else {
        let names: Vec<&str> = moving.iter().map(|hip| hip.joint.name.as_str()).collect();
        return Err(check.invalid(
            "moving joints on the pelvis",
            format!("{names:?}"),
            "a biped has two, the first of each leg",
            "name the pelvis link, and make every joint outside the legs fixed or lock it",
        ));
    };
    let y_of = |hip: &Moving<'_>| {
        let placement = tree.placement(hip)?;
        Ok::<f64, RobotError>(placement.translation.y)
    };
    let (y_one, y_other) = (y_of(one)?, y_of(other)?);
    let named = [one, other].map(|hip| legs::side_by_name(&hip.joint.name));
    let given = options.left_hip.is_some() || options.right_hip.is_some();
    let one_is_left = match (given, named) {
        (true, _) => is_left(check, [one, other], options)?,
        (false, _) if y_one * y_other < 0.0 => y_one > y_other,
        // Side by side they are not; their names may say it.
        (false, [Some(left), Some(other_left)]) if left != other_left => left,
        (false, _) => {
            return Err(check.invalid(
                format!("origin y of ({}, {})", one.joint.name, other.joint.name),
                format!("[{y_one}, {y_other}]"),
                "the left leg begins at y > 0 of the pelvis and the right one at y < 0",
                "name the first joint of the left leg as left_hip",
            ));
        }
    };
    let [left, right] = match one_is_left {
        true => [*one, *other],
        false => [*other, *one],
    };
    let named = [left, right].map(|hip| legs::side_by_name(&hip.joint.name));
    if !given && named == [Some(false), Some(true)] {
        notes.push(format!(
            "the leg of {} is taken for the left one, for it begins at y > 0 of the pelvis, though its name says right: turn \
             the frame of the pelvis, or name the other one as left_hip",
            left.joint.name
        ));
    }
    Ok([left, right])
}

/// Whether the first of two hips is the left one, where the options name one or both.
fn is_left(
    check: &Check<'_>,
    hips: [&Moving<'_>; 2],
    options: &UrdfOptions,
) -> Result<bool, RobotError> {
    let names = hips.map(|hip| hip.joint.name.as_str());
    let mut first_is_left = None;
    for (key, given, left) in [
        ("left_hip", &options.left_hip, true),
        ("right_hip", &options.right_hip, false),
    ] {
        let Some(name) = given else { continue };
        let Some(place) = names.iter().position(|own| own == name) else {
            return Err(check.invalid(
                key,
                format!("{name:?}"),
                format!("the legs begin with {:?} and {:?}", names[0], names[1]),
                "name one of these",
            ));
        };
        let says = (place == 0) == left;
        if first_is_left.is_some_and(|earlier| earlier != says) {
            return Err(check.invalid(
                key,
                format!("{name:?}"),
                "left_hip names the same joint",
                "name the other one, or leave one of the two keys out",
            ));
        }
        first_is_left = Some(says);
    }
    Ok(first_is_left.unwrap_or(true))
}

/// How many of the two joints that the pelvis moves begin a leg; none if it moves more or fewer than two.
fn moving(tree: &Tree<'_>, pelvis: Option<&str>) -> Result<Option<usize>, RobotError> {
    // Something that moves may carry it.
    let Ok(pelvis) = tree.pelvis(pelvis) else {
        return Ok(None);
    };
    let moving = tree.rigid(pelvis)?.moving;
    if moving.len() != 2 {
        return Ok(None);
    }
    let legs = moving.iter().map(|hip| legs::is_leg(tree, hip));
    let legs: Vec<bool> = legs.collect::<Result<_, _>>()?;
    Ok(Some(legs.into_iter().filter(|is_leg| *is_leg).count()))
}

/// What is assumed of the joints of the legs where the file does not say it, or says what the model has not.
fn assumed(urdf: &Urdf, legs: &[Leg; 2], options: &UrdfOptions) -> Vec<String> {
    let mut notes = Vec::new();
    let in_legs = |joint: &&syntax::Joint| {
        let mut own = legs.iter().flat_map(|leg| &leg.joints);
        own.any(|own| own.name == joint.name)
    };
    let driven = urdf.joints.iter().filter(in_legs);
    let driven = driven.filter_map(|joint| Some((&joint.name, joint.drive.as_ref().ok()?)));
    let unsaid = driven.clone().filter(|(_, drive)| drive.armature.is_none());
    let unsaid: Vec<&str> = unsaid.map(|(name, _)| name.as_str()).collect();
    if options.armature_kg_m2.is_none() && !unsaid.is_empty() {
        let which = match unsaid.len() {
            JOINTS => "no joint of the legs says the inertia of its rotor".to_string(),
            _ => format!(
                "the inertia of the rotor is not said of {}",
                unsaid.join(", ")
            ),
        };
        notes.push(format!(
            "{which} (<dynamics armature>): {DEFAULT_ARMATURE_KG_M2} kg m^2 is assumed of each; \
             agent.armature_kg_m2 gives another"
        ));
    }
    let none = driven.clone().filter(|(_, drive)| {
        let Limit {
            effort, velocity, ..
        } = drive.limit;
        effort.max(velocity) > LARGEST
    });
    let none: Vec<&str> = none.map(|(name, _)| name.as_str()).collect();
    if !none.is_empty() {
        notes.push(format!(
            "limits of effort and velocity above {LARGEST:e} are taken for none ({})",
            none.join(", ")
        ));
    }
    let rubbing = driven.filter(|(_, drive)| drive.friction != 0.0);
    let rubbing: Vec<String> = rubbing
        .map(|(name, drive)| format!("{name} {} N m", drive.friction))
        .collect();
    if !rubbing.is_empty() {
        notes.push(format!(
            "friction is no part of the controller's model, and that of the file is left out ({}): a [[disturbance]] of the \
             kind \"friction\" with such a coulomb brings it in",
            rubbing.join(", ")
        ));
    }
    notes
}

/// A limit, of those that are none the largest number; what is no number stays so.
fn finite(limit: f64) -> f64 {
    if limit > LARGEST { LARGEST } else { limit }
}

/// The leg that begins with a joint.
fn leg(
    check: &Check<'_>,
    tree: &Tree<'_>,
    hip: &Moving<'_>,
    armature: Option<&[f64; LEG_JOINTS]>,
) -> Result<Leg, RobotError> {
    let mut joints = Vec::with_capacity(LEG_JOINTS);
    let mut next = Some(*hip);
    while let Some(moving) = next {
        let name = moving.joint.name.as_str();
        let counted = |count: usize, of: &str| {
            check.invalid(
                format!("moving joints of the leg ({})", hip.joint.name),
                count,
                format!("a leg is one chain of six revolute joints; {of}"),
                "make the others fixed or lock them",
            )
        };
        if joints.len() == LEG_JOINTS {
            return Err(counted(
                joints.len() + 1,
                &format!("{name} is one too many"),
            ));
        }
        let armature = armature.map(|own| own[joints.len()]);
        let child = tree.child(&moving);
        let rigid = tree.rigid(child)?;
        next = match rigid.moving[..] {
            [] => None,
            [one] => Some(one),
            _ => {
                return Err(counted(
                    rigid.moving.len(),
                    &format!("this many follow {name}"),
                ));
            }
        };
        let body = tree.body(child, &rigid)?;
        joints.push(joint(check, tree, &moving, armature, body)?);
        if next.is_none() && joints.len() < LEG_JOINTS {
            return Err(counted(joints.len(), &format!("{name} is the last")));
        }
    }
    let joints = <[Joint; LEG_JOINTS]>::try_from(joints).map_err(|joints| {
        check.invalid("joints", joints.len(), "a leg has six", "add or lock some")
    })?;
    let foot = Foot {
        ankle_offset_m: Vector3::zeros(),
        sole: Isometry3::identity(),
        sole_corners_m: Vec::new(),
    };
    Ok(Leg { joints, foot })
}

fn joint(
    check: &Check<'_>,
    tree: &Tree<'_>,
    moving: &Moving<'_>,
    armature: Option<f64>,
    body: Body,
) -> Result<Joint, RobotError> {
    let urdf = moving.joint;
    let place = Place {
        prefix: "joint ",
        name: &urdf.name,
    };
    tree.revolute(urdf)?;
    let drive = urdf.drive.clone();
    let drive = drive.map_err(|message| syntax::syntax(check.path, message))?;
    let raw = RawJoint {
        xyz: urdf.origin.xyz,
        rpy: urdf.origin.rpy,
        axis: urdf.axis,
        q_min: drive.limit.lower,
        q_max: drive.limit.upper,
        // Beyond every limit of a number it is none; a note says so.
        rate_max: finite(drive.limit.velocity),
        torque_max: finite(drive.limit.effort),
        armature: armature
            .or(drive.armature)
            .unwrap_or(DEFAULT_ARMATURE_KG_M2),
        damping: drive.damping,
    };
    let joint = check.joint(place, &raw, body)?;
    Ok(Joint {
        placement: tree.placement(moving)?,
        ..joint
    })
}

fn halves(all: &[f64; JOINTS]) -> [&[f64; LEG_JOINTS]; 2] {
    let (halves, _) = all.as_chunks();
    [&halves[LEFT], &halves[RIGHT]]
}
