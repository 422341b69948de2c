//! A robot from a URDF: two legs of six revolute joints on a pelvis. Every other joint is fixed, and its link is part
//! of the one that carries it.

mod legs;
mod syntax;
mod tree;

use super::check::{Check, Names, Place, RawJoint};
use super::error::{self, RobotError};
use super::kinematics::{by_leg, leg_pose};
use super::structure::{Body, Foot, JOINTS, Joint, LEFT, LEG_JOINTS, Leg, RIGHT, Robot};
use nalgebra::{Isometry3, Vector3, Vector6};
use std::path::Path;
use syntax::Urdf;
use tree::{Moving, Tree};

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

/// What a URDF does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOptions {
    /// The link that is the pelvis (default: the child of a floating joint if there is one, else the root link).
    pub pelvis: Option<String>,
    /// The first joint of the left leg (default: the one with the larger y).
    pub left_hip: Option<String>,
    /// Moving joints outside the legs, held at zero.
    pub locked: Vec<String>,
    /// Inertia of each joint's rotor as seen from the joint, kg m^2 (default: that of the file, else 0.01).
    pub armature_kg_m2: Option<[f64; JOINTS]>,
    /// Left and right foot (default: both frames in the last link's origin, the sole parallel to the pelvis at q = 0).
    pub feet: Option<[Foot; 2]>,
    /// Standing pose, rad (default: zero, or the nearest angle that a joint can reach).
    pub standing_rad: Option<[f64; JOINTS]>,
    /// Nominal height of the pelvis frame above the ground, m (default: that above the soles in the standing pose).
    pub base_height_m: Option<f64>,
    /// Gravity in the world frame, m/s^2.
    pub gravity_m_s2: Vector3<f64>,
    /// Licence of the numbers.
    pub licence: String,
    /// Whose numbers they are.
    pub attribution: String,
}

impl Default for UrdfOptions {
    fn default() -> Self {
        Self {
            pelvis: None,
            left_hip: None,
            locked: Vec::new(),
            armature_kg_m2: None,
            feet: None,
            standing_rad: None,
            base_height_m: None,
            gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
            licence: String::new(),
            attribution: String::new(),
        }
    }
}

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
    if moves_more_than_legs(&tree, pelvis.as_deref())?
        && let Some(found) = legs::find(&tree, &urdf, pelvis.as_deref())?
    {
        let own = found.locked.iter().filter(|name| !locked.contains(name));
        notes.push(legs::held(&own.cloned().collect::<Vec<_>>()));
        locked = found.locked;
        pelvis = Some(found.pelvis);
    }
    let tree = Tree::new(&check, &urdf, &locked)?;
    let pelvis = tree.pelvis(pelvis.as_deref())?;
    let rigid = tree.rigid(pelvis)?;
    let [left, right] = hips(&check, &tree, &rigid.moving, options, &mut notes)?;
    let base = tree.body(pelvis, &rigid)?;
    let [left_armature, right_armature] = match &options.armature_kg_m2 {
        Some(all) => halves(all).map(Some),
        None => [None; 2],
    };
    let mut legs = [
        leg(&check, &tree, &left, left_armature)?,
        leg(&check, &tree, &right, right_armature)?,
    ];
    notes.extend(assumed(&urdf, &legs, options));
    if let Some(feet) = &options.feet {
        for (leg, foot) in legs.iter_mut().zip(feet) {
            check.foot("feet", foot)?;
            leg.foot = foot.clone();
        }
    }
    let standing_rad = options.standing_rad.unwrap_or_else(|| at_rest(&legs));
    check.standing("standing_rad", &legs, &standing_rad)?;
    if options.feet.is_none() && options.standing_rad.is_some() {
        level_soles(&mut legs, &standing_rad);
    }
    let height_m = height_m(&legs, &standing_rad);
    // A root frame on the ground (REP-120) is no pelvis: the link that carries the legs is.
    let carrier = tree.carrier_of(&left.joint.name);
    if options.pelvis.is_none() && height_m <= 0.0 && !tree.is_named(pelvis, &carrier) {
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
    let one_is_left = match options.left_hip.as_deref() {
        Some(name) if name == one.joint.name => true,
        Some(name) if name == other.joint.name => false,
        Some(name) => {
            return Err(check.invalid(
                "left_hip",
                format!("{name:?}"),
                format!(
                    "the legs begin with {:?} and {:?}",
                    one.joint.name, other.joint.name
                ),
                "name one of these",
            ));
        }
        None if y_one * y_other < 0.0 => y_one > y_other,
        None => {
            return Err(check.invalid(
                format!("origin y of ({}, {})", one.joint.name, other.joint.name),
                format!("[{y_one}, {y_other}]"),
                "the left leg begins at y > 0 of the pelvis and the right one at y < 0",
                "name the first joint of the left leg",
            ));
        }
    };
    let [left, right] = match one_is_left {
        true => [*one, *other],
        false => [*other, *one],
    };
    let named = [left, right].map(|hip| legs::side_by_name(&hip.joint.name));
    if options.left_hip.is_none() && named == [Some(false), Some(true)] {
        notes.push(format!(
            "the leg of {} is taken for the left one, for it begins at y > 0 of the pelvis, though its name says right: turn \
             the frame of the pelvis, or name the other one as left_hip",
            left.joint.name
        ));
    }
    Ok([left, right])
}

/// Whether the pelvis moves more than two joints, or none of its limbs is a leg.
fn moves_more_than_legs(tree: &Tree<'_>, pelvis: Option<&str>) -> Result<bool, RobotError> {
    match tree.pelvis(pelvis) {
        Ok(pelvis) => Ok(tree.rigid(pelvis)?.moving.len() != 2),
        // Something that moves carries it.
        Err(_) => Ok(true),
    }
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
    let rubbing = driven.filter(|(_, drive)| drive.friction != 0.0);
    let rubbing: Vec<String> = rubbing
        .map(|(name, drive)| format!("{name} {} N m", drive.friction))
        .collect();
    if !rubbing.is_empty() {
        notes.push(format!(
            "the model has no dry friction, that of the file is left out ({}); a [[disturbance]] of that size bounds what it \
             can do",
            rubbing.join(", ")
        ));
    }
    notes
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
    Ok(standing_on_its_sole(joints))
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
        rate_max: drive.limit.velocity,
        torque_max: drive.limit.effort,
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

/// A leg with the default foot: at q = 0 the sole is parallel to the pelvis.
fn standing_on_its_sole(joints: [Joint; LEG_JOINTS]) -> Leg {
    let foot = Foot {
        ankle_offset_m: Vector3::zeros(),
        sole: Isometry3::identity(),
        sole_corners_m: Vec::new(),
    };
    let mut leg = Leg { joints, foot };
    let last = leg_pose(&leg, &Vector6::zeros()).link(LEG_JOINTS - 1);
    leg.foot.sole.rotation = last.rotation.inverse();
    leg
}

/// Turns the soles so that they are parallel to the pelvis in the standing pose.
fn level_soles(legs: &mut [Leg; 2], standing_rad: &[f64; JOINTS]) {
    for (leg, q_rad) in legs.iter_mut().zip(by_leg(standing_rad)) {
        let last = leg_pose(leg, &q_rad).link(LEG_JOINTS - 1);
        leg.foot.sole.rotation = last.rotation.inverse();
    }
}

/// The pose nearest to zero that the joints can reach.
fn at_rest(legs: &[Leg; 2]) -> [f64; JOINTS] {
    std::array::from_fn(|i| {
        let joint = &legs[i / LEG_JOINTS].joints[i % LEG_JOINTS];
        0.0_f64.clamp(joint.q_min_rad, joint.q_max_rad)
    })
}

/// Height of the pelvis above the lower sole, m.
fn height_m(legs: &[Leg; 2], q_rad: &[f64; JOINTS]) -> f64 {
    let q = by_leg(q_rad);
    [LEFT, RIGHT]
        .map(|i| -leg_pose(&legs[i], &q[i]).sole().translation.z)
        .into_iter()
        .fold(f64::NEG_INFINITY, f64::max)
}

fn halves(all: &[f64; JOINTS]) -> [&[f64; LEG_JOINTS]; 2] {
    let (halves, _) = all.as_chunks();
    [&halves[LEFT], &halves[RIGHT]]
}
