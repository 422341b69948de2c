//! Forward dynamics of a robot's leg, (4): six revolute joints in a chain, on a pelvis that stands still.
//!
//! q'' = M(q)^-1 (tau - H(q, q')): the bias H by the recursive Newton-Euler method, M by that of composite bodies, then
//! M = L' D L from the foot upwards (Featherstone, Rigid Body Dynamics Algorithms, chapters 5, 6 and 8). With six joints
//! this is less work than the articulated-body method.
//!
//! Three choices make it cheap; `frames` computes the constants once, in double precision.
//! - The z axis of a link's frame is its joint's axis, and all constant turns about z go into the angles: from a link to the
//!   next there is a lever, a twist about x, and the joint's turn about z. In legs, neighbouring axes are parallel or at
//!   right angles, and a right twist only renames coordinates.
//! - Mass on a joint's axis may as well belong to the link before. Moved there (the base parameters of Gautier and Khalil),
//!   it leaves the links without mass, first moment along z, and second moment zz.
//! - Inertia is the second moments J = int r r' dm. With the spin U = `[w']x + [w]x [w]x` of a link and the acceleration a of
//!   its origin, its points accelerate by a + U r: its force is U h, its moment h x a + int r x U r dm.

mod frames;
mod link;
mod uniforms;

use crate::model::lanes::{Kernel, Lane};
use link::{
    carried, composite, damped, first_moment, first_motion, joined, momentum, next_motion,
    second_motion, tip, turn, wrench,
};
use nalgebra::{Matrix3, Rotation3, Vector3};

pub use uniforms::LegUniforms;

/// Joints of a leg.
pub const LEG_JOINTS: usize = 6;

/// A joint and the link that it carries, in the frames of the robot's description.
#[derive(Debug, Clone, PartialEq)]
pub struct LegJoint {
    /// Orientation of the link's frame in that of the link before (of the pelvis, for the first) at q = 0.
    pub rotation: Rotation3<f64>,
    /// Origin of the link's frame in that of the link before, m.
    pub translation_m: Vector3<f64>,
    /// Axis of the joint in the link's frame, of any length but zero.
    pub axis: Vector3<f64>,
    /// Mass of the link, kg.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_m: Vector3<f64>,
    /// Inertia about the centre of mass in the link's frame, kg m^2.
    pub inertia_kg_m2: Matrix3<f64>,
    /// What the rotor adds to the diagonal of M, kg m^2.
    pub armature_kg_m2: f64,
    /// Viscous damping of the joint, N m s/rad.
    pub damping_n_m_s: f64,
}

impl From<&crate::agent::robot::Joint> for LegJoint {
    fn from(joint: &crate::agent::robot::Joint) -> Self {
        Self {
            rotation: joint.placement.rotation.to_rotation_matrix(),
            translation_m: joint.placement.translation.vector,
            axis: joint.axis.into_inner(),
            mass_kg: joint.body.mass_kg,
            com_m: joint.body.com_m,
            inertia_kg_m2: joint.body.inertia_kg_m2,
            armature_kg_m2: joint.armature_kg_m2,
            damping_n_m_s: joint.damping_n_m_s,
        }
    }
}

/// A leg in the precision of the loop.
#[derive(Debug, Clone, Copy)]
pub struct LegModel<R> {
    pub(crate) joints: [Joint<R>; LEG_JOINTS],
    /// Acceleration of the resting pelvis, against gravity: across and along the first axis.
    pub(crate) lift: [R; 2],
    /// 1 / the last entry of M, which is constant.
    pub(crate) tip_inverse: R,
    pub(crate) build: Build,
}

/// Constants of a joint and its link.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint<R> {
    /// What is added to q.
    pub(crate) offset: R,
    /// Armature.
    pub(crate) armature: R,
    /// Damping.
    pub(crate) damping: R,
    /// Sine and cosine of the twist.
    pub(crate) twist: [R; 2],
    /// Origin in the frame before.
    pub(crate) lever: [R; 3],
    /// Twice the lever.
    pub(crate) lever_twice: [R; 3],
    /// First moments x, y.
    pub(crate) first: [R; 2],
    /// Second moments xx, yy, xy, xz, yz.
    pub(crate) second: [R; 5],
}

/// How an axis lies to the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Twist {
    /// Parallel, with the lever along x.
    Parallel,
    /// At a right angle, with no lever along y.
    Right,
    /// Neither.
    Any,
}

/// Which kind of leg it is: the loop is compiled for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Build {
    /// Hip pitch at the pelvis: the axes of knee and ankle pitch are parallel, all others at right angles.
    PitchFirst,
    /// Hip pitch next to the knee: the three pitch axes are parallel, all others at right angles.
    PitchLast,
    /// Anything else.
    Any,
}

impl Build {
    /// The twist of each joint; that of the first is of no account.
    pub(crate) const fn twists(self) -> [Twist; LEG_JOINTS] {
        use Twist::{Any, Parallel, Right};
        match self {
            Self::PitchFirst => [Right, Right, Right, Right, Parallel, Right],
            Self::PitchLast => [Right, Right, Right, Parallel, Parallel, Right],
            Self::Any => [Any; LEG_JOINTS],
        }
    }
}

/// q'', rad/s^2, of a leg under `torque`, N m, at the angles `q`, rad, and their rates `rate`, rad/s.
#[inline(always)]
pub fn forward_dynamics<L: Lane>(
    model: &LegModel<L::Real>,
    q: &[L; LEG_JOINTS],
    rate: &[L; LEG_JOINTS],
    torque: &[L; LEG_JOINTS],
) -> [L; LEG_JOINTS] {
    L::dispatch(ForwardDynamics::<L> {
        model,
        q,
        rate,
        torque,
    })
}

/// [`forward_dynamics`] as a kernel, so that it is compiled once per lane type and not into every stage of every loop.
struct ForwardDynamics<'a, L: Lane> {
    model: &'a LegModel<L::Real>,
    q: &'a [L; LEG_JOINTS],
    rate: &'a [L; LEG_JOINTS],
    torque: &'a [L; LEG_JOINTS],
}

impl<L: Lane> Kernel for ForwardDynamics<'_, L> {
    type Output = [L; LEG_JOINTS];
    #[inline(always)]
    fn run(self) -> Self::Output {
        let Self {
            model,
            q,
            rate,
            torque,
        } = self;
        match model.build {
            Build::PitchFirst => {
                accelerations::<L>(const { Build::PitchFirst.twists() }, model, q, rate, torque)
            }
            Build::PitchLast => {
                accelerations::<L>(const { Build::PitchLast.twists() }, model, q, rate, torque)
            }
            Build::Any => accelerations::<L>(const { Build::Any.twists() }, model, q, rate, torque),
        }
    }
}

#[inline(always)]
fn accelerations<L: Lane>(
    twists: [Twist; LEG_JOINTS],
    model: &LegModel<L::Real>,
    q: &[L; LEG_JOINTS],
    rate: &[L; LEG_JOINTS],
    torque: &[L; LEG_JOINTS],
) -> [L; LEG_JOINTS] {
    let [_, k1, k2, k3, k4, k5] = twists;
    let [j0, j1, j2, j3, j4, j5] = &model.joints;

    // Outwards: motion without joint accelerations, and the wrench that it takes.
    let t0 = turn(j0, q[0]);
    let motion = first_motion(model, t0, rate[0]);
    let own_0 = first_moment(j0, &motion);
    let t1 = turn(j1, q[1]);
    let motion = second_motion(k1, j1, t1, rate, &motion);
    let own_1 = wrench(j1, &motion);
    let t2 = turn(j2, q[2]);
    let motion = next_motion(k2, j2, t2, rate[2], &motion);
    let own_2 = wrench(j2, &motion);
    let t3 = turn(j3, q[3]);
    let motion = next_motion(k3, j3, t3, rate[3], &motion);
    let own_3 = wrench(j3, &motion);
    let t4 = turn(j4, q[4]);
    let motion = next_motion(k4, j4, t4, rate[4], &motion);
    let own_4 = wrench(j4, &motion);
    let t5 = turn(j5, q[5]);
    let motion = next_motion(k5, j5, t5, rate[5], &motion);

    // Inwards: what damping and bias leave of the torques.
    let load_5 = wrench(j5, &motion);
    let load_4 = joined(k5, j5, t5, &load_5, &own_4);
    let load_3 = joined(k4, j4, t4, &load_4, &own_3);
    let load_2 = joined(k3, j3, t3, &load_3, &own_2);
    let load_1 = joined(k2, j2, t2, &load_2, &own_1);
    let load_0 = carried(k1, j1, t1, &load_1);
    let b5 = damped(j5, rate[5], torque[5]) - load_5.moment[2];
    let b4 = damped(j4, rate[4], torque[4]) - load_4.moment[2];
    let b3 = damped(j3, rate[3], torque[3]) - load_3.moment[2];
    let b2 = damped(j2, rate[2], torque[2]) - load_2.moment[2];
    let b1 = damped(j1, rate[1], torque[1]) - load_1.moment[2];
    let b0 = damped(j0, rate[0], torque[0]) - load_0.moment[2] - own_0;

    // Composite bodies: a row of M is the momentum of those beyond at unit rate of a joint, carried to the joints before.
    // With M = L' D L, each row is rid of the rows beyond, scaled to a row of L, and taken off the right side.
    let one = L::number(1.0);
    let body_5 = tip(j5);
    let p = carried(k5, j5, t5, &momentum(&body_5));
    let m54 = p.moment[2];
    let p = carried(k4, j4, t4, &p);
    let m53 = p.moment[2];
    let p = carried(k3, j3, t3, &p);
    let m52 = p.moment[2];
    let p = carried(k2, j2, t2, &p);
    let m51 = p.moment[2];
    let p = carried(k1, j1, t1, &p);
    let m50 = p.moment[2];
    let d5 = L::splat(model.tip_inverse);
    let l5 = scaled([m50, m51, m52, m53, m54], d5);
    let [b0, b1, b2, b3, b4] = less([b0, b1, b2, b3, b4], b5, &l5);

    let body_4 = composite(k5, j5, t5, &body_5, j4);
    let p = momentum(&body_4);
    let m44 = p.moment[2] + L::splat(j4.armature);
    let p = carried(k4, j4, t4, &p);
    let m43 = p.moment[2];
    let p = carried(k3, j3, t3, &p);
    let m42 = p.moment[2];
    let p = carried(k2, j2, t2, &p);
    let m41 = p.moment[2];
    let p = carried(k1, j1, t1, &p);
    let m40 = p.moment[2];
    let [m40, m41, m42, m43, m44] = less([m40, m41, m42, m43, m44], m54, &l5);
    let d4 = one / m44;
    let l4 = scaled([m40, m41, m42, m43], d4);
    let [b0, b1, b2, b3] = less([b0, b1, b2, b3], b4, &l4);

    let body_3 = composite(k4, j4, t4, &body_4, j3);
    let p = momentum(&body_3);
    let m33 = p.moment[2] + L::splat(j3.armature);
    let p = carried(k3, j3, t3, &p);
    let m32 = p.moment[2];
    let p = carried(k2, j2, t2, &p);
    let m31 = p.moment[2];
    let p = carried(k1, j1, t1, &p);
    let m30 = p.moment[2];
    let [m30, m31, m32, m33] = less([m30, m31, m32, m33], m53, &l5);
    let [m30, m31, m32, m33] = less([m30, m31, m32, m33], m43, &l4);
    let d3 = one / m33;
    let l3 = scaled([m30, m31, m32], d3);
    let [b0, b1, b2] = less([b0, b1, b2], b3, &l3);

    let body_2 = composite(k3, j3, t3, &body_3, j2);
    let p = momentum(&body_2);
    let m22 = p.moment[2] + L::splat(j2.armature);
    let p = carried(k2, j2, t2, &p);
    let m21 = p.moment[2];
    let p = carried(k1, j1, t1, &p);
    let m20 = p.moment[2];
    let [m20, m21, m22] = less([m20, m21, m22], m52, &l5);
    let [m20, m21, m22] = less([m20, m21, m22], m42, &l4);
    let [m20, m21, m22] = less([m20, m21, m22], m32, &l3);
    let d2 = one / m22;
    let l2 = scaled([m20, m21], d2);
    let [b0, b1] = less([b0, b1], b2, &l2);

    let body_1 = composite(k2, j2, t2, &body_2, j1);
    let p = momentum(&body_1);
    let m11 = p.moment[2] + L::splat(j1.armature);
    let p = carried(k1, j1, t1, &p);
    let m10 = p.moment[2];
    let [m10, m11] = less([m10, m11], m51, &l5);
    let [m10, m11] = less([m10, m11], m41, &l4);
    let [m10, m11] = less([m10, m11], m31, &l3);
    let [m10, m11] = less([m10, m11], m21, &l2);
    let d1 = one / m11;
    let l1 = scaled([m10], d1);
    let [b0] = less([b0], b1, &l1);

    let body_0 = composite(k1, j1, t1, &body_1, j0);
    let p = momentum(&body_0);
    let m00 = p.moment[2] + L::splat(j0.armature);
    let [m00] = less([m00], m50, &l5);
    let [m00] = less([m00], m40, &l4);
    let [m00] = less([m00], m30, &l3);
    let [m00] = less([m00], m20, &l2);
    let [m00] = less([m00], m10, &l1);

    // From the pelvis outwards.
    let a0 = b0 / m00;
    let a1 = remainder(b1 * d1, &l1, &[a0]);
    let a2 = remainder(b2 * d2, &l2, &[a0, a1]);
    let a3 = remainder(b3 * d3, &l3, &[a0, a1, a2]);
    let a4 = remainder(b4 * d4, &l4, &[a0, a1, a2, a3]);
    let a5 = remainder(b5 * d5, &l5, &[a0, a1, a2, a3, a4]);
    [a0, a1, a2, a3, a4, a5]
}

/// factor row.
#[inline(always)]
fn scaled<L: Lane, const N: usize>(row: [L; N], factor: L) -> [L; N] {
    row.map(|entry| entry * factor)
}

/// row - factor other, as far as the row goes.
#[inline(always)]
fn less<L: Lane, const N: usize, const M: usize>(
    mut row: [L; N],
    factor: L,
    other: &[L; M],
) -> [L; N] {
    for i in 0..N {
        row[i] = other[i].mul_add(-factor, row[i]);
    }
    row
}

/// from - row known.
#[inline(always)]
fn remainder<L: Lane, const N: usize>(from: L, row: &[L; N], known: &[L; N]) -> L {
    let mut left = from;
    for i in 0..N {
        left = row[i].mul_add(-known[i], left);
    }
    left
}
