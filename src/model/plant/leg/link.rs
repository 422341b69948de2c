//! One link of a leg: how it moves, what that takes, and how wrenches and bodies come to the frame before.
//!
//! From the frame before there is a lever p, a twist about x and the joint's turn about z: a vector v of the link is
//! Rx(twist) Rz(q) v there.

use super::parameters::{Joint, LEG_JOINTS, LegModel, Twist};
use crate::model::lanes::Lane;

type Vector<L> = [L; 3];

/// Sine and cosine of a joint's turn.
#[derive(Clone, Copy)]
pub(super) struct Turn<L> {
    sine: L,
    cosine: L,
}

/// How a link moves, in its own frame.
#[derive(Clone, Copy)]
pub(super) struct Motion<L> {
    /// Angular velocity w.
    angular: Vector<L>,
    /// w'.
    change: Vector<L>,
    /// Acceleration of the origin.
    origin: Vector<L>,
    /// U = [w']x + [w]x [w]x.
    spin: [[L; 3]; 3],
}

/// Force and moment about the origin of a frame.
#[derive(Clone, Copy)]
pub(super) struct Wrench<L> {
    pub(super) force: Vector<L>,
    pub(super) moment: Vector<L>,
}

/// Moments of the mass from a link onwards that is not on the axis of its joint.
#[derive(Clone, Copy)]
pub(super) struct Composite<L> {
    /// h.
    first: Vector<L>,
    /// J: xx, yy, xy, xz, yz, zz.
    second: [L; 6],
}

#[inline(always)]
pub(super) fn turn<L: Lane>(offset: L::Real, q: L) -> Turn<L> {
    let (sine, cosine) = (q + L::splat(offset)).sin_cos();
    Turn { sine, cosine }
}

/// What the joint's damping leaves of its torque.
#[inline(always)]
pub(super) fn damped<L: Lane>(damping: L::Real, rate: L, torque: L) -> L {
    rate.mul_add(-L::splat(damping), torque)
}

/// The first link turns about a fixed axis: only diagonal entries of its spin.
#[inline(always)]
pub(super) fn first_motion<L: Lane>(model: &LegModel<L::Real>, t: Turn<L>, rate: L) -> Motion<L> {
    let zero = L::number(0.0);
    let [across, along] = [L::splat(model.lift[0]), L::splat(model.lift[1])];
    let inward = -(rate * rate);
    Motion {
        angular: [zero, zero, rate],
        change: [zero; 3],
        origin: [t.cosine * across, -(t.sine * across), along],
        spin: [[inward, zero, zero], [zero, inward, zero], [zero; 3]],
    }
}

/// The bias that the first link adds at its own joint: its weight.
#[inline(always)]
pub(super) fn first_moment<L: Lane>(joint: &Joint<L::Real>, motion: &Motion<L>) -> L {
    let [hx, hy] = [L::splat(joint.first[0]), L::splat(joint.first[1])];
    hx.mul_add(motion.origin[1], -(hy * motion.origin[0]))
}

/// [`next_motion`] after a first link, of which little moves.
#[inline(always)]
pub(super) fn second_motion<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    t: Turn<L>,
    rate: &[L; LEG_JOINTS],
    before: &Motion<L>,
) -> Motion<L> {
    if twist != Twist::Right {
        return next_motion(twist, joint, t, rate[1], before);
    }
    let zero = L::number(0.0);
    let inward = before.spin[0][0];
    let [ax, ay, az] = before.origin;
    let ax = inward.mul_add(L::splat(joint.lever[0]), ax);
    let origin = turned_back(t, untwisted(twist, joint, [ax, ay, az]));
    // The axis of the first joint is y before the turn.
    let [wx, wy, wz] = [t.sine * rate[0], t.cosine * rate[0], rate[1]];
    let [dx, dy] = [wy * wz, -(wx * wz)];
    let xx = wx * wx;
    let xy = wx * wy;
    let zz = wz * wz;
    Motion {
        angular: [wx, wy, wz],
        change: [dx, dy, zero],
        origin,
        spin: [
            [-(wy.mul_add(wy, zz)), xy, zero],
            [xy, -(xx + zz), zero],
            [-(dy + dy), dx + dx, -(wy.mul_add(wy, xx))],
        ],
    }
}

/// The motion of a link from that of the one before, as long as its joint does not accelerate.
#[inline(always)]
pub(super) fn next_motion<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    t: Turn<L>,
    rate: L,
    before: &Motion<L>,
) -> Motion<L> {
    let origin = at_lever(twist, joint, before);
    let origin = turned_back(t, untwisted(twist, joint, origin));
    let [wx, wy, wz] = turned_back(t, untwisted(twist, joint, before.angular));
    let [dx, dy, dz] = turned_back(t, untwisted(twist, joint, before.change));
    let dx = wy.mul_add(rate, dx);
    let dy = wx.mul_add(-rate, dy);
    let wz = wz + rate;
    let xx = wx * wx;
    let zz = wz * wz;
    Motion {
        angular: [wx, wy, wz],
        change: [dx, dy, dz],
        origin,
        spin: [
            [
                -(wy.mul_add(wy, zz)),
                wx.mul_add(wy, -dz),
                wx.mul_add(wz, dy),
            ],
            [wx.mul_add(wy, dz), -(xx + zz), wy.mul_add(wz, -dx)],
            [
                wx.mul_add(wz, -dy),
                wy.mul_add(wz, dx),
                -(wy.mul_add(wy, xx)),
            ],
        ],
    }
}

/// a + U p: the acceleration of the next joint's origin.
#[inline(always)]
fn at_lever<L: Lane>(twist: Twist, joint: &Joint<L::Real>, before: &Motion<L>) -> Vector<L> {
    let [ux, uy, uz] = &before.spin;
    let mut a = before.origin;
    let x = L::splat(joint.lever[0]);
    a = [
        ux[0].mul_add(x, a[0]),
        uy[0].mul_add(x, a[1]),
        uz[0].mul_add(x, a[2]),
    ];
    if twist == Twist::Any {
        let y = L::splat(joint.lever[1]);
        a = [
            ux[1].mul_add(y, a[0]),
            uy[1].mul_add(y, a[1]),
            uz[1].mul_add(y, a[2]),
        ];
    }
    if twist != Twist::Parallel {
        let z = L::splat(joint.lever[2]);
        a = [
            ux[2].mul_add(z, a[0]),
            uy[2].mul_add(z, a[1]),
            uz[2].mul_add(z, a[2]),
        ];
    }
    a
}

/// What it takes to move a link.
#[inline(always)]
pub(super) fn wrench<L: Lane>(joint: &Joint<L::Real>, motion: &Motion<L>) -> Wrench<L> {
    let [hx, hy] = [L::splat(joint.first[0]), L::splat(joint.first[1])];
    let [xx, yy, xy, xz, yz] = [
        L::splat(joint.second[0]),
        L::splat(joint.second[1]),
        L::splat(joint.second[2]),
        L::splat(joint.second[3]),
        L::splat(joint.second[4]),
    ];
    let [ux, uy, uz] = &motion.spin;
    let [ax, ay, az] = motion.origin;
    let force = [
        ux[0].mul_add(hx, ux[1] * hy),
        uy[0].mul_add(hx, uy[1] * hy),
        uz[0].mul_add(hx, uz[1] * hy),
    ];
    let x = uz[0].mul_add(xy, uz[1] * yy);
    let x = uy[0].mul_add(-xz, x);
    let x = (uz[2] - uy[1]).mul_add(yz, x);
    let x = hy.mul_add(az, x);
    let y = ux[1].mul_add(yz, -(uz[0] * xx));
    let y = uz[1].mul_add(-xy, y);
    let y = (ux[0] - uz[2]).mul_add(xz, y);
    let y = hx.mul_add(-az, y);
    let z = uy[0].mul_add(xx, -(ux[1] * yy));
    let z = (uy[1] - ux[0]).mul_add(xy, z);
    let z = uy[2].mul_add(xz, z);
    let z = ux[2].mul_add(-yz, z);
    let z = hx.mul_add(ay, z);
    let z = hy.mul_add(-ax, z);
    Wrench {
        force,
        moment: [x, y, z],
    }
}

/// Rz(q) v.
#[inline(always)]
fn turned<L: Lane>(t: Turn<L>, [x, y, z]: Vector<L>) -> Vector<L> {
    [
        t.cosine.mul_add(x, -(t.sine * y)),
        t.sine.mul_add(x, t.cosine * y),
        z,
    ]
}

/// Rz(q)' v.
#[inline(always)]
fn turned_back<L: Lane>(t: Turn<L>, [x, y, z]: Vector<L>) -> Vector<L> {
    [
        t.cosine.mul_add(x, t.sine * y),
        t.cosine.mul_add(y, -(t.sine * x)),
        z,
    ]
}

/// Rx(twist) v.
#[inline(always)]
fn twisted<L: Lane>(twist: Twist, joint: &Joint<L::Real>, [x, y, z]: Vector<L>) -> Vector<L> {
    match twist {
        Twist::Parallel => [x, y, z],
        Twist::Right => [x, -z, y],
        Twist::Any => {
            let [sine, cosine] = [L::splat(joint.twist[0]), L::splat(joint.twist[1])];
            [
                x,
                cosine.mul_add(y, -(sine * z)),
                sine.mul_add(y, cosine * z),
            ]
        }
    }
}

/// Rx(twist)' v.
#[inline(always)]
fn untwisted<L: Lane>(twist: Twist, joint: &Joint<L::Real>, [x, y, z]: Vector<L>) -> Vector<L> {
    match twist {
        Twist::Parallel => [x, y, z],
        Twist::Right => [x, z, -y],
        Twist::Any => {
            let [sine, cosine] = [L::splat(joint.twist[0]), L::splat(joint.twist[1])];
            [
                x,
                cosine.mul_add(y, sine * z),
                cosine.mul_add(z, -(sine * y)),
            ]
        }
    }
}

/// The same wrench in the frame before.
#[inline(always)]
pub(super) fn carried<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    t: Turn<L>,
    wrench: &Wrench<L>,
) -> Wrench<L> {
    let force = twisted(twist, joint, turned(t, wrench.force));
    let moment = twisted(twist, joint, turned(t, wrench.moment));
    Wrench {
        force,
        moment: levered(twist, joint, moment, force),
    }
}

/// The same wrench in the frame before, and what the link before takes itself.
#[inline(always)]
pub(super) fn joined<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    t: Turn<L>,
    wrench: &Wrench<L>,
    own: &Wrench<L>,
) -> Wrench<L> {
    let Wrench { force, moment } = carried(twist, joint, t, wrench);
    Wrench {
        force: plus(force, own.force),
        moment: plus(moment, own.moment),
    }
}

#[inline(always)]
fn plus<L: Lane>([ax, ay, az]: Vector<L>, [bx, by, bz]: Vector<L>) -> Vector<L> {
    [ax + bx, ay + by, az + bz]
}

/// moment + p x force.
#[inline(always)]
fn levered<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    [mut mx, mut my, mut mz]: Vector<L>,
    [fx, fy, fz]: Vector<L>,
) -> Vector<L> {
    let x = L::splat(joint.lever[0]);
    my = x.mul_add(-fz, my);
    mz = x.mul_add(fy, mz);
    if twist == Twist::Any {
        let y = L::splat(joint.lever[1]);
        mx = y.mul_add(fz, mx);
        mz = y.mul_add(-fx, mz);
    }
    if twist != Twist::Parallel {
        let z = L::splat(joint.lever[2]);
        mx = z.mul_add(-fy, mx);
        my = z.mul_add(fx, my);
    }
    [mx, my, mz]
}

/// The last link.
#[inline(always)]
pub(super) fn tip<L: Lane>(joint: &Joint<L::Real>) -> Composite<L> {
    let [hx, hy] = [L::splat(joint.first[0]), L::splat(joint.first[1])];
    let [xx, yy, xy, xz, yz] = [
        L::splat(joint.second[0]),
        L::splat(joint.second[1]),
        L::splat(joint.second[2]),
        L::splat(joint.second[3]),
        L::splat(joint.second[4]),
    ];
    let zero = L::number(0.0);
    Composite {
        first: [hx, hy, zero],
        second: [xx, yy, xy, xz, yz, zero],
    }
}

/// The body beyond a joint, in the frame before, together with the link there. Without mass, its first moment is the
/// same about every point.
#[inline(always)]
pub(super) fn composite<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    t: Turn<L>,
    beyond: &Composite<L>,
    own: &Joint<L::Real>,
) -> Composite<L> {
    let [hx, hy, hz] = twisted(twist, joint, turned(t, beyond.first));
    let [xx, yy, xy, xz, yz, zz] = twisted_second(twist, joint, turned_second(t, beyond.second));
    let [x, x_twice] = [L::splat(joint.lever[0]), L::splat(joint.lever_twice[0])];
    let xx = hx.mul_add(x_twice, xx + L::splat(own.second[0]));
    let mut yy = yy + L::splat(own.second[1]);
    let mut xy = hy.mul_add(x, xy + L::splat(own.second[2]));
    let mut xz = hz.mul_add(x, xz + L::splat(own.second[3]));
    let mut yz = yz + L::splat(own.second[4]);
    let mut zz = zz;
    if twist == Twist::Any {
        let [y, y_twice] = [L::splat(joint.lever[1]), L::splat(joint.lever_twice[1])];
        yy = hy.mul_add(y_twice, yy);
        xy = hx.mul_add(y, xy);
        yz = hz.mul_add(y, yz);
    }
    if twist != Twist::Parallel {
        let [z, z_twice] = [L::splat(joint.lever[2]), L::splat(joint.lever_twice[2])];
        zz = hz.mul_add(z_twice, zz);
        xz = hx.mul_add(z, xz);
        yz = hy.mul_add(z, yz);
    }
    Composite {
        first: [hx + L::splat(own.first[0]), hy + L::splat(own.first[1]), hz],
        second: [xx, yy, xy, xz, yz, zz],
    }
}

/// Rz(q) J Rz(q)'.
#[inline(always)]
fn turned_second<L: Lane>(t: Turn<L>, [xx, yy, xy, xz, yz, zz]: [L; 6]) -> [L; 6] {
    let u = t.cosine.mul_add(xx, -(t.sine * xy));
    let v = t.cosine.mul_add(xy, -(t.sine * yy));
    let turned_xx = t.cosine.mul_add(u, -(t.sine * v));
    [
        turned_xx,
        (xx + yy) - turned_xx,
        t.sine.mul_add(u, t.cosine * v),
        t.cosine.mul_add(xz, -(t.sine * yz)),
        t.sine.mul_add(xz, t.cosine * yz),
        zz,
    ]
}

/// Rx(twist) J Rx(twist)'.
#[inline(always)]
fn twisted_second<L: Lane>(
    twist: Twist,
    joint: &Joint<L::Real>,
    [xx, yy, xy, xz, yz, zz]: [L; 6],
) -> [L; 6] {
    match twist {
        Twist::Parallel => [xx, yy, xy, xz, yz, zz],
        Twist::Right => [xx, zz, -xz, xy, -yz, yy],
        Twist::Any => {
            let [sine, cosine] = [L::splat(joint.twist[0]), L::splat(joint.twist[1])];
            let u = cosine.mul_add(yy, -(sine * yz));
            let v = cosine.mul_add(yz, -(sine * zz));
            let twisted_yy = cosine.mul_add(u, -(sine * v));
            [
                xx,
                twisted_yy,
                cosine.mul_add(xy, -(sine * xz)),
                sine.mul_add(xy, cosine * xz),
                sine.mul_add(u, cosine * v),
                (yy + zz) - twisted_yy,
            ]
        }
    }
}

/// Momentum of a body that turns at unit rate.
#[inline(always)]
pub(super) fn momentum<L: Lane>(body: &Composite<L>) -> Wrench<L> {
    let [hx, hy, _] = body.first;
    let [xx, yy, _, xz, yz, _] = body.second;
    Wrench {
        force: [-hy, hx, L::number(0.0)],
        moment: [-xz, -yz, xx + yy],
    }
}
