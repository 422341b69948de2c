//! Forward dynamics of a leg in three parts: the bias, M = L' D L from the foot inwards, and its solution from the
//! pelvis outwards.

use super::link::{
    Turn, carried, composite, damped, first_moment, first_motion, joined, momentum, next_motion,
    second_motion, tip, turn, wrench,
};
use super::parameters::{Build, LEG_JOINTS, LegModel, Twist};
use crate::model::lanes::{Kernel, Lane};

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

// The parts of it in the order of the shader, where two joints work out bias and factors at the same time.
#[inline(always)]
fn accelerations<L: Lane>(
    twists: [Twist; LEG_JOINTS],
    model: &LegModel<L::Real>,
    q: &[L; LEG_JOINTS],
    rate: &[L; LEG_JOINTS],
    torque: &[L; LEG_JOINTS],
) -> [L; LEG_JOINTS] {
    let [j0, j1, j2, j3, j4, j5] = &model.joints;
    let turns = [
        turn(j0.offset, q[0]),
        turn(j1.offset, q[1]),
        turn(j2.offset, q[2]),
        turn(j3.offset, q[3]),
        turn(j4.offset, q[4]),
        turn(j5.offset, q[5]),
    ];
    let [c0, c1, c2, c3, c4, c5] = bias(twists, model, &turns, rate);
    let factors = factors(twists, model, &turns);
    let left = [
        damped(j0.damping, rate[0], torque[0]) - c0 - weight(model, turns[0]),
        damped(j1.damping, rate[1], torque[1]) - c1,
        damped(j2.damping, rate[2], torque[2]) - c2,
        damped(j3.damping, rate[3], torque[3]) - c3,
        damped(j4.damping, rate[4], torque[4]) - c4,
        damped(j5.damping, rate[5], torque[5]) - c5,
    ];
    solve(&factors, left)
}

/// What gravity, rates and their products take of the torques, but for the first link's own weight ([`weight`]).
// In one piece: unrolled arithmetic over six joints, whose order the shader keeps.
#[inline(always)]
fn bias<L: Lane>(
    twists: [Twist; LEG_JOINTS],
    model: &LegModel<L::Real>,
    turns: &[Turn<L>; LEG_JOINTS],
    rate: &[L; LEG_JOINTS],
) -> [L; LEG_JOINTS] {
    let [_, k1, k2, k3, k4, k5] = twists;
    let [_, j1, j2, j3, j4, j5] = &model.joints;
    let [t0, t1, t2, t3, t4, t5] = *turns;

    // Outwards: motion without joint accelerations, and the wrench that it takes.
    let motion = first_motion(model, t0, rate[0]);
    let motion = second_motion(k1, j1, t1, rate, &motion);
    let own_1 = wrench(j1, &motion);
    let motion = next_motion(k2, j2, t2, rate[2], &motion);
    let own_2 = wrench(j2, &motion);
    let motion = next_motion(k3, j3, t3, rate[3], &motion);
    let own_3 = wrench(j3, &motion);
    let motion = next_motion(k4, j4, t4, rate[4], &motion);
    let own_4 = wrench(j4, &motion);
    let motion = next_motion(k5, j5, t5, rate[5], &motion);

    // Inwards: what is beyond each joint.
    let load_5 = wrench(j5, &motion);
    let load_4 = joined(k5, j5, t5, &load_5, &own_4);
    let load_3 = joined(k4, j4, t4, &load_4, &own_3);
    let load_2 = joined(k3, j3, t3, &load_3, &own_2);
    let load_1 = joined(k2, j2, t2, &load_2, &own_1);
    let load_0 = carried(k1, j1, t1, &load_1);
    [load_0, load_1, load_2, load_3, load_4, load_5].map(|load| load.moment[2])
}

/// What the first link's own weight takes of the first torque.
#[inline(always)]
fn weight<L: Lane>(model: &LegModel<L::Real>, first: Turn<L>) -> L {
    first_moment(
        &model.joints[0],
        &first_motion(model, first, L::number(0.0)),
    )
}

/// M = L' D L: the rows of L below its diagonal, the reciprocals of D but for its first entry, and that.
struct Factors<L> {
    l5: [L; 5],
    l4: [L; 4],
    l3: [L; 3],
    l2: [L; 2],
    l1: [L; 1],
    d5: L,
    d4: L,
    d3: L,
    d2: L,
    d1: L,
    m00: L,
}

/// Composite bodies: a row of M is the momentum of those beyond at unit rate of a joint, carried to the joints before.
/// Each row is rid of the rows beyond, and scaled to a row of L.
// In one piece, as the bias.
#[inline(always)]
fn factors<L: Lane>(
    twists: [Twist; LEG_JOINTS],
    model: &LegModel<L::Real>,
    turns: &[Turn<L>; LEG_JOINTS],
) -> Factors<L> {
    let [_, k1, k2, k3, k4, k5] = twists;
    let [j0, j1, j2, j3, j4, j5] = &model.joints;
    let [_, t1, t2, t3, t4, t5] = *turns;
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

    let body_0 = composite(k1, j1, t1, &body_1, j0);
    let p = momentum(&body_0);
    let m00 = p.moment[2] + L::splat(j0.armature);
    let [m00] = less([m00], m50, &l5);
    let [m00] = less([m00], m40, &l4);
    let [m00] = less([m00], m30, &l3);
    let [m00] = less([m00], m20, &l2);
    let [m00] = less([m00], m10, &l1);

    Factors {
        l5,
        l4,
        l3,
        l2,
        l1,
        d5,
        d4,
        d3,
        d2,
        d1,
        m00,
    }
}

/// The accelerations under what the bias leaves of the torques.
#[inline(always)]
fn solve<L: Lane>(factors: &Factors<L>, left: [L; LEG_JOINTS]) -> [L; LEG_JOINTS] {
    let Factors {
        l5, l4, l3, l2, l1, ..
    } = factors;
    let Factors {
        d5,
        d4,
        d3,
        d2,
        d1,
        m00,
        ..
    } = *factors;
    let [b0, b1, b2, b3, b4, b5] = left;
    let [b0, b1, b2, b3, b4] = less([b0, b1, b2, b3, b4], b5, l5);
    let [b0, b1, b2, b3] = less([b0, b1, b2, b3], b4, l4);
    let [b0, b1, b2] = less([b0, b1, b2], b3, l3);
    let [b0, b1] = less([b0, b1], b2, l2);
    let [b0] = less([b0], b1, l1);
    // From the pelvis outwards.
    let a0 = b0 / m00;
    let a1 = remainder(b1 * d1, l1, &[a0]);
    let a2 = remainder(b2 * d2, l2, &[a0, a1]);
    let a3 = remainder(b3 * d3, l3, &[a0, a1, a2]);
    let a4 = remainder(b4 * d4, l4, &[a0, a1, a2, a3]);
    let a5 = remainder(b5 * d5, l5, &[a0, a1, a2, a3, a4]);
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
