//! Joint angles from where a leg's ankle is to be, and how far a leg reaches.

use super::kinematics::leg_pose;
use super::structure::{LEG_JOINTS, Leg};
use nalgebra::{Isometry3, Vector3, Vector6};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest component of the pose error at a solution, m and rad.
pub const TOLERANCE: f64 = 1e-12;
/// The fourth joint of a leg.
pub const KNEE: usize = 3;

/// A knee that is bent less leaves the leg singular: the joint rates that move the foot along the leg exceed ten times
/// those of a bent one.
pub const STRAIGHT_RAD: f64 = 0.1;

/// Shares of its reach at which a leg is tried to stand.
const STANDING: [f64; 7] = [0.87, 0.84, 0.8, 0.75, 0.7, 0.6, 0.5];
/// A warm start takes three; one from far away some more.
const MAX_ITERATIONS: u32 = 50;
/// Largest turn of a joint in one iteration, rad: keeps a start from far away from overshooting.
const MAX_TURN_RAD: f64 = 0.5;
/// Bends of the knee from which a pose is looked for, rad.
const BENDS_RAD: [f64; 3] = [0.5, 1.0, 1.6];
/// Rounds over the joints in the search for the reach of a leg.
const SWEEPS: u32 = 40;
/// Cosine of the angle between two axes about which joints turn alike.
const ALIKE: f64 = 0.9;

/// Poses with a bent knee, to either side as far as its range allows: the joints that turn about the same axis share
/// the bend, so that the foot stays about level.
#[must_use]
pub fn bent(leg: &Leg) -> Vec<Vector6<f64>> {
    let axes = leg_pose(leg, &Vector6::zeros()).axes;
    let alike: Vec<f64> = axes.iter().map(|axis| axis.dot(&axes[KNEE])).collect();
    let knee = &leg.joints[KNEE];
    let bends = BENDS_RAD.iter().flat_map(|bend_rad| [*bend_rad, -bend_rad]);
    let possible = bends.filter(|bend| (knee.q_min_rad..=knee.q_max_rad).contains(bend));
    let pose = |bend_rad: f64| {
        let others = alike.iter().enumerate();
        let others = others.filter(|(joint, own)| *joint != KNEE && own.abs() > ALIKE);
        let mut joints = Vector6::zeros();
        joints[KNEE] = bend_rad;
        for (joint, own) in others {
            joints[joint] = -0.5 * bend_rad * own.signum();
        }
        joints
    };
    possible.map(pose).collect()
}

/// The joint angles that put a leg's ankle frame at `target` in the pelvis frame, rad, by Newton's method on the six
/// components of the pose error from `start_rad`; none where it finds none. The joints' ranges are not looked at.
#[must_use]
pub fn solve(leg: &Leg, target: &Isometry3<f64>, start_rad: Vector6<f64>) -> Option<Vector6<f64>> {
    let mut joints_rad = start_rad;
    for _ in 0..MAX_ITERATIONS {
        let pose = leg_pose(leg, &joints_rad);
        let at = pose.ankle();
        let shift = target.translation.vector - at.translation.vector;
        let turn = (target.rotation * at.rotation.inverse()).scaled_axis();
        let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        // Not-a-number is never within it.
        if error.iter().all(|part| part.abs() <= TOLERANCE) {
            return Some(joints_rad);
        }
        let step = pose.jacobian().lu().solve(&error)?;
        joints_rad += step * (MAX_TURN_RAD / step.amax()).min(1.0);
    }
    None
}

/// A pose within the joints' ranges that puts the sole level below the hip, the leg about as far out as people stand
/// with bent knees, or nearer where it must be, rad; of several, the one with the knee farther ahead.
#[must_use]
pub fn level_below_hip(leg: &Leg) -> Option<Vector6<f64>> {
    let below_m = leg_pose(leg, &Vector6::zeros()).ankle_m();
    let (hip_m, reach_m) = (leg.joints[0].placement.translation.vector, reach_m(leg));
    let rotation = leg.foot.sole.rotation.inverse();
    let ahead = |joints: &Vector6<f64>| leg_pose(leg, joints).origins_m[KNEE].x;
    STANDING.iter().find_map(|share| {
        let ankle_m = Vector3::new(hip_m.x, below_m.y, hip_m.z - share * reach_m);
        let target = Isometry3::from_parts(ankle_m.into(), rotation);
        let starts = bent(leg).into_iter();
        let found = starts.filter_map(|start_rad| solve(leg, &target, start_rad));
        let possible =
            found.filter(|joints| is_within(leg, joints) && joints[KNEE].abs() >= STRAIGHT_RAD);
        possible.max_by(|a, b| ahead(a).total_cmp(&ahead(b)))
    })
}

/// Whether every joint is within its range.
fn is_within(leg: &Leg, joints_rad: &Vector6<f64>) -> bool {
    let mut both = leg.joints.iter().zip(joints_rad.iter());
    both.all(|(joint, angle_rad)| (joint.q_min_rad..=joint.q_max_rad).contains(angle_rad))
}

/// How far from the hip the joints of a leg can put its ankle, m. The square of the distance is a sine of each joint's
/// angle, so that the best angle of one joint is known; they are improved in turn.
#[must_use]
pub fn reach_m(leg: &Leg) -> f64 {
    let hip = leg.joints[0].placement.translation.vector;
    let distance = |joints: &Vector6<f64>| (leg_pose(leg, joints).ankle_m() - hip).norm();
    let mut joints = Vector6::zeros();
    for joint in (0..SWEEPS).flat_map(|_| 0..LEG_JOINTS) {
        let square = |angle_rad: f64| {
            let mut tried = joints;
            tried[joint] = angle_rad;
            distance(&tried).powi(2)
        };
        let (at_zero, at_quarter, at_half) = (square(0.0), square(FRAC_PI_2), square(PI));
        let middle = f64::midpoint(at_zero, at_half);
        let best_rad = (at_quarter - middle).atan2(at_zero - middle);
        let (low, high) = (leg.joints[joint].q_min_rad, leg.joints[joint].q_max_rad);
        let within = [best_rad.clamp(low, high), low, high];
        let best = within
            .into_iter()
            .max_by(|a, b| square(*a).total_cmp(&square(*b)));
        joints[joint] = best.unwrap_or(best_rad);
    }
    distance(&joints)
}
