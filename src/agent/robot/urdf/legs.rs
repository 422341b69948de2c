//! Which joints of a URDF are the legs, and what is held still.

use super::syntax::{Joint, JointKind, Urdf};
use super::tree::{Moving, Tree};
use crate::agent::robot::error::RobotError;
use crate::agent::robot::structure::LEG_JOINTS;
use nalgebra::Isometry3;

/// Joints that a note names before it counts the others.
const NAMED: usize = 6;

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
    let mut best: Option<(f64, Found)> = None;
    for carrier in tree.carriers() {
        if pelvis.is_some_and(|name| !tree.are_rigid(carrier, name)) {
            continue;
        }
        let rigid = tree.rigid(carrier)?;
        let mut legs = Vec::new();
        for moving in &rigid.moving {
            if let Some((joints, height_m)) = chain(tree, moving)? {
                legs.push((height_m, joints));
            }
        }
        legs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(first_m, first), (second_m, second), ..] = legs.as_slice() else {
            continue;
        };
        let height_m = first_m.max(*second_m);
        let moves = |joint: &&Joint| {
            let still = [JointKind::Fixed, JointKind::Floating].contains(&joint.kind);
            !still && !first.contains(&joint.name) && !second.contains(&joint.name)
        };
        let found = Found {
            pelvis: pelvis.map_or_else(|| tree.carrier_of(&first[0]), str::to_string),
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

/// The joints of a leg that begins with one, and how high its last joint is above the link that carries it at q = 0, m;
/// none if it is no chain of six revolute joints.
fn chain(tree: &Tree<'_>, hip: &Moving<'_>) -> Result<Option<(Vec<String>, f64)>, RobotError> {
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
    Ok(whole.then_some((names, frame.translation.z)))
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
