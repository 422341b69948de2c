//! Which joints of a URDF are the legs, and what is held still.

use super::syntax::{Joint, JointKind, Urdf};
use super::tree::{Limb, Moving, Tree};
use crate::agent::robot::check::Check;
use crate::agent::robot::error::RobotError;
use crate::agent::robot::structure::LEG_JOINTS;
use nalgebra::{Isometry3, Point3};

/// Joints that a note names before it counts the others.
const NAMED: usize = 6;

/// How much lower than a leg nothing may hang, m: what does is the true leg.
const LOWER_M: f64 = 0.05;

/// Two legs among other limbs: the pelvis, and what has to be held at zero so that nothing else moves.
pub(super) struct Found {
    /// The link that carries both legs.
    pub(super) pelvis: String,
    /// Joints outside the legs that would move.
    pub(super) locked: Vec<String>,
}

/// The two legs of a robot that moves more than them: two chains of six revolute joints from one link (`pelvis`, if it
/// is named), of several the pair whose ends are lowest. None where there is no such pair.
///
/// # Errors
/// If a frame on the way is none.
pub(super) fn find(
    tree: &Tree<'_>,
    urdf: &Urdf,
    pelvis: Option<&str>,
) -> Result<Option<Found>, RobotError> {
    let limbs = tree.limbs()?;
    let lowest_m = limbs.first().map_or(f64::INFINITY, |limb| limb.height_m);
    let mut best: Option<(f64, Found)> = None;
    for carrier in tree.carriers() {
        if pelvis.is_some_and(|name| !tree.are_rigid(carrier, name)) {
            continue;
        }
        let rigid = tree.rigid(carrier)?;
        let mut legs = Vec::new();
        for moving in &rigid.moving {
            legs.extend(chain(tree, moving)?);
        }
        // Arms of six joints beside legs of another number are no legs: something hangs lower.
        if pelvis.is_none() {
            let frame = tree.at_zero(carrier)?;
            legs.retain(|leg| (frame * leg.end_m).z < lowest_m + LOWER_M);
        }
        legs.sort_by(|a, b| a.end_m.z.total_cmp(&b.end_m.z));
        let [first, second, ..] = legs.as_slice() else {
            continue;
        };
        let height_m = first.end_m.z.max(second.end_m.z);
        let (first, second) = (&first.joints, &second.joints);
        let moves = |joint: &&Joint| {
            let still = [JointKind::Fixed, JointKind::Floating].contains(&joint.kind);
            !still && !first.contains(&joint.name) && !second.contains(&joint.name)
        };
        let found = Found {
            pelvis: pelvis.map_or_else(|| both(tree, carrier, [first, second]), str::to_string),
            locked: urdf
                .joints
                .iter()
                .filter(moves)
                .map(|own| own.name.clone())
                .collect(),
        };
        if best
            .as_ref()
            .is_none_or(|(lowest_m, _)| height_m < *lowest_m)
        {
            best = Some((height_m, found));
        }
    }
    Ok(best.map(|(_, found)| found))
}

/// The link that carries both legs, or, where each has its own, the first of those that these are fixed to.
fn both(tree: &Tree<'_>, first: usize, legs: [&[String]; 2]) -> String {
    let [one, other] = legs.map(|joints| tree.carrier_of(&joints[0]));
    if one == other {
        return one;
    }
    tree.name(first).to_string()
}

/// Whether a joint begins a chain of six revolute ones.
///
/// # Errors
/// If a frame on the way is none.
pub(super) fn is_leg(tree: &Tree<'_>, hip: &Moving<'_>) -> Result<bool, RobotError> {
    Ok(chain(tree, hip)?.is_some())
}

/// Six revolute joints, one after the other.
struct Chain {
    /// Their names.
    joints: Vec<String>,
    /// Where the last one is at q = 0 in the frame of the link that carries the first, m.
    end_m: Point3<f64>,
}

/// The leg that begins with a joint; none if it is no chain of six revolute joints.
fn chain(tree: &Tree<'_>, hip: &Moving<'_>) -> Result<Option<Chain>, RobotError> {
    let mut names = Vec::new();
    let mut frame = Isometry3::identity();
    let mut next = Some(*hip);
    while let Some(moving) = next {
        let joint = moving.joint;
        if joint.kind != JointKind::Revolute || joint.mimic.is_some() {
            return Ok(None);
        }
        names.push(joint.name.clone());
        frame *= tree.placement(&moving)?;
        let rigid = tree.rigid(tree.child(&moving))?;
        next = match rigid.moving[..] {
            [] => None,
            [one] if names.len() < LEG_JOINTS => Some(one),
            _ => return Ok(None),
        };
    }
    let whole = names.len() == LEG_JOINTS;
    Ok(whole.then(|| Chain {
        joints: names,
        end_m: frame.translation.vector.into(),
    }))
}

/// Why there are no two legs: what is wrong with the first of the two limbs that hang lowest.
pub(super) fn none(check: &Check<'_>, limbs: &[Limb<'_>]) -> RobotError {
    let wrong = |limb: &Limb<'_>| {
        let joints = &limb.joints;
        let follows = joints.iter().find(|joint| joint.mimic.is_some());
        let other = joints
            .iter()
            .find(|joint| joint.kind != JointKind::Revolute);
        match (follows, other, joints.len()) {
            (Some(joint), ..) => Some(format!("{} follows another joint", joint.name)),
            (None, Some(joint), _) => Some(format!("{} is {}", joint.name, joint.kind.word())),
            (None, None, LEG_JOINTS) => None,
            (None, None, 0) => Some("nothing moves".to_string()),
            (None, None, count) => Some(format!("these are {count}")),
        }
    };
    let lowest = limbs.iter().take(2);
    let named = lowest.filter_map(|limb| Some((limb, wrong(limb)?))).next();
    let (limb, why) = match named {
        Some((limb, why)) => (Some(limb), why),
        None => (
            limbs.first(),
            "no other limb of the same link is one".to_string(),
        ),
    };
    let joints = limb.map_or(&[][..], |limb| &limb.joints);
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    check.invalid(
        "moving joints of a limb that hangs lowest",
        format!("{names:?}"),
        format!("a biped has two legs, each a chain of six revolute joints, on one link; {why}"),
        "lock joints that are too many, or name the pelvis if something else hangs lower than the legs",
    )
}

/// What is said of joints that are held at zero.
pub(super) fn held(locked: &[String]) -> String {
    let named: Vec<&str> = locked.iter().take(NAMED).map(String::as_str).collect();
    let more = match locked.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let are = if locked.len() == 1 {
        "joint outside the legs is"
    } else {
        "joints outside the legs are"
    };
    format!(
        "{} {are} held at zero, and what hangs there is part of the pelvis: {}{more}",
        locked.len(),
        named.join(", ")
    )
}

/// Whether a joint's name says that it is of the left leg, or of the right one; none where it does not say.
pub(super) fn side_by_name(name: &str) -> Option<bool> {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    let says = |long: &str, short: &str| name.contains(long) || words.contains(&short);
    match (says("left", "l"), says("right", "r")) {
        (true, false) => Some(true),
        (false, true) => Some(false),
        _ => None,
    }
}
