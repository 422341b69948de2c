// Twin of src/model/plant/leg/dynamics.rs and src/model/plant/leg/link.rs: forward dynamics of a leg, (4). One
// invocation answers for a leg, or for the part of it that it is asked for.
//
// TWIST_1 to TWIST_5 are constants, PARALLEL, RIGHT or ANY: what is asked of a twist is decided when the shader is
// compiled.

// Constants of a joint and its link.
struct Joint {
    // What is added to q, armature, sine and cosine of the twist.
    angle: vec4<f32>,
    // Origin in the frame before; damping.
    lever: vec4<f32>,
    // Twice the lever.
    lever_twice: vec4<f32>,
    // First moments x, y; second moments xx, yy.
    moments: vec4<f32>,
    // Second moments xy, xz, yz.
    products: vec4<f32>,
}

struct LegModel {
    joints: array<Joint, 6>,
    // Acceleration of the resting pelvis, across and along the first axis; 1 / the last entry of M.
    pelvis: vec4<f32>,
}

// Sine and cosine of a joint's turn.
struct Turn {
    sine: f32,
    cosine: f32,
}

// How a link moves, in its own frame.
struct Motion {
    // Angular velocity w.
    angular: vec3<f32>,
    // w'.
    change: vec3<f32>,
    // Acceleration of the origin.
    origin: vec3<f32>,
    // Rows of U = [w']x + [w]x [w]x.
    spin_x: vec3<f32>,
    spin_y: vec3<f32>,
    spin_z: vec3<f32>,
}

// Force and moment about the origin of a frame.
struct Wrench {
    force: vec3<f32>,
    moment: vec3<f32>,
}

// Second moments: xx, yy, zz and xy, xz, yz.
struct Second {
    square: vec3<f32>,
    product: vec3<f32>,
}

// Moments of the mass from a link onwards that is not on the axis of its joint.
struct Composite {
    // h.
    first: vec3<f32>,
    // J.
    second: Second,
}

// What gravity, rates and their products take of the torques, but for the first link's own weight (`leg_weight`).
fn leg_bias(model: LegModel, turns: array<Turn, 6>, rate: array<f32, 6>) -> array<f32, 6> {
    let j1 = model.joints[1];
    let j2 = model.joints[2];
    let j3 = model.joints[3];
    let j4 = model.joints[4];
    let j5 = model.joints[5];
    let t0 = turns[0];
    let t1 = turns[1];
    let t2 = turns[2];
    let t3 = turns[3];
    let t4 = turns[4];
    let t5 = turns[5];

    // Outwards: motion without joint accelerations, and the wrench that it takes.
    let motion_0 = first_motion(model, t0, rate[0]);
    let motion_1 = second_motion(TWIST_1, j1, t1, rate[0], rate[1], motion_0);
    let own_1 = wrench(j1, motion_1);
    let motion_2 = next_motion(TWIST_2, j2, t2, rate[2], motion_1);
    let own_2 = wrench(j2, motion_2);
    let motion_3 = next_motion(TWIST_3, j3, t3, rate[3], motion_2);
    let own_3 = wrench(j3, motion_3);
    let motion_4 = next_motion(TWIST_4, j4, t4, rate[4], motion_3);
    let own_4 = wrench(j4, motion_4);
    let motion_5 = next_motion(TWIST_5, j5, t5, rate[5], motion_4);

    // Inwards: what is beyond each joint.
    let load_5 = wrench(j5, motion_5);
    let load_4 = joined(TWIST_5, j5, t5, load_5, own_4);
    let load_3 = joined(TWIST_4, j4, t4, load_4, own_3);
    let load_2 = joined(TWIST_3, j3, t3, load_3, own_2);
    let load_1 = joined(TWIST_2, j2, t2, load_2, own_1);
    let load_0 = carried(TWIST_1, j1, t1, load_1);
    return array(
        load_0.moment.z,
        load_1.moment.z,
        load_2.moment.z,
        load_3.moment.z,
        load_4.moment.z,
        load_5.moment.z,
    );
}

// What the first link's own weight takes of the first torque.
fn leg_weight(model: LegModel, first: Turn) -> f32 {
    return first_moment(model.joints[0], first_motion(model, first, 0.0));
}

// M = L' D L: the rows of L below its diagonal, the reciprocals of D but for its first entry, and that.
struct Factors {
    l54: f32,
    l5: vec4<f32>,
    l4: vec4<f32>,
    l3: vec3<f32>,
    l2: vec2<f32>,
    l1: f32,
    d5: f32,
    d4: f32,
    d3: f32,
    d2: f32,
    d1: f32,
    m0: f32,
}

// Composite bodies: a row of M is the momentum of those beyond at unit rate of a joint, carried to the joints before.
// Each row is rid of the rows beyond, and scaled to a row of L.
fn leg_factors(model: LegModel, turns: array<Turn, 6>) -> Factors {
    let j0 = model.joints[0];
    let j1 = model.joints[1];
    let j2 = model.joints[2];
    let j3 = model.joints[3];
    let j4 = model.joints[4];
    let j5 = model.joints[5];
    let t1 = turns[1];
    let t2 = turns[2];
    let t3 = turns[3];
    let t4 = turns[4];
    let t5 = turns[5];

    let body_5 = tip(j5);
    let p54 = carried(TWIST_5, j5, t5, momentum(body_5));
    let p53 = carried(TWIST_4, j4, t4, p54);
    let p52 = carried(TWIST_3, j3, t3, p53);
    let p51 = carried(TWIST_2, j2, t2, p52);
    let p50 = carried(TWIST_1, j1, t1, p51);
    let m54 = p54.moment.z;
    let m5 = vec4(p50.moment.z, p51.moment.z, p52.moment.z, p53.moment.z);
    let d5 = model.pelvis.z;
    let l54 = m54 * d5;
    let l5 = m5 * d5;

    let body_4 = composite(TWIST_5, j5, t5, body_5, j4);
    let p44 = momentum(body_4);
    let p43 = carried(TWIST_4, j4, t4, p44);
    let p42 = carried(TWIST_3, j3, t3, p43);
    let p41 = carried(TWIST_2, j2, t2, p42);
    let p40 = carried(TWIST_1, j1, t1, p41);
    var m44 = p44.moment.z + j4.angle.y;
    var m4 = vec4(p40.moment.z, p41.moment.z, p42.moment.z, p43.moment.z);
    m44 = fma(l54, -m54, m44);
    m4 = fma(l5, vec4(-m54), m4);
    let d4 = 1.0 / m44;
    let l4 = m4 * d4;

    let body_3 = composite(TWIST_4, j4, t4, body_4, j3);
    let p33 = momentum(body_3);
    let p32 = carried(TWIST_3, j3, t3, p33);
    let p31 = carried(TWIST_2, j2, t2, p32);
    let p30 = carried(TWIST_1, j1, t1, p31);
    var m3 = vec4(p30.moment.z, p31.moment.z, p32.moment.z, p33.moment.z + j3.angle.y);
    m3 = fma(l5, vec4(-m5.w), m3);
    m3 = fma(l4, vec4(-m4.w), m3);
    let d3 = 1.0 / m3.w;
    let l3 = m3.xyz * d3;

    let body_2 = composite(TWIST_3, j3, t3, body_3, j2);
    let p22 = momentum(body_2);
    let p21 = carried(TWIST_2, j2, t2, p22);
    let p20 = carried(TWIST_1, j1, t1, p21);
    var m2 = vec3(p20.moment.z, p21.moment.z, p22.moment.z + j2.angle.y);
    m2 = fma(l5.xyz, vec3(-m5.z), m2);
    m2 = fma(l4.xyz, vec3(-m4.z), m2);
    m2 = fma(l3, vec3(-m3.z), m2);
    let d2 = 1.0 / m2.z;
    let l2 = m2.xy * d2;

    let body_1 = composite(TWIST_2, j2, t2, body_2, j1);
    let p11 = momentum(body_1);
    let p10 = carried(TWIST_1, j1, t1, p11);
    var m1 = vec2(p10.moment.z, p11.moment.z + j1.angle.y);
    m1 = fma(l5.xy, vec2(-m5.y), m1);
    m1 = fma(l4.xy, vec2(-m4.y), m1);
    m1 = fma(l3.xy, vec2(-m3.y), m1);
    m1 = fma(l2, vec2(-m2.y), m1);
    let d1 = 1.0 / m1.y;
    let l1 = m1.x * d1;

    let body_0 = composite(TWIST_1, j1, t1, body_1, j0);
    let p00 = momentum(body_0);
    var m0 = p00.moment.z + j0.angle.y;
    m0 = fma(l5.x, -m5.x, m0);
    m0 = fma(l4.x, -m4.x, m0);
    m0 = fma(l3.x, -m3.x, m0);
    m0 = fma(l2.x, -m2.x, m0);
    m0 = fma(l1, -m1.x, m0);

    return Factors(l54, l5, l4, l3, l2, l1, d5, d4, d3, d2, d1, m0);
}

// The accelerations under what the bias leaves of the torques.
fn leg_solve(factors: Factors, left: array<f32, 6>) -> array<f32, 6> {
    let b5 = left[5];
    let b4 = fma(factors.l54, -b5, left[4]);
    var b3210 = vec4(left[0], left[1], left[2], left[3]);
    b3210 = fma(factors.l5, vec4(-b5), b3210);
    b3210 = fma(factors.l4, vec4(-b4), b3210);
    let b3 = b3210.w;
    let b210 = fma(factors.l3, vec3(-b3), b3210.xyz);
    let b2 = b210.z;
    let b10 = fma(factors.l2, vec2(-b2), b210.xy);
    let b1 = b10.y;
    let b0 = fma(factors.l1, -b1, b10.x);
    // From the pelvis outwards.
    let a0 = b0 / factors.m0;
    let a1 = fma(factors.l1, -a0, b1 * factors.d1);
    let a2 = fma(factors.l2.y, -a1, fma(factors.l2.x, -a0, b2 * factors.d2));
    let a3 = fma(factors.l3.z, -a2, fma(factors.l3.y, -a1, fma(factors.l3.x, -a0, b3 * factors.d3)));
    var a4 = fma(factors.l4.x, -a0, b4 * factors.d4);
    a4 = fma(factors.l4.y, -a1, a4);
    a4 = fma(factors.l4.z, -a2, a4);
    a4 = fma(factors.l4.w, -a3, a4);
    var a5 = fma(factors.l5.x, -a0, b5 * factors.d5);
    a5 = fma(factors.l5.y, -a1, a5);
    a5 = fma(factors.l5.z, -a2, a5);
    a5 = fma(factors.l5.w, -a3, a5);
    a5 = fma(factors.l54, -a4, a5);
    return array(a0, a1, a2, a3, a4, a5);
}

fn turn(offset: f32, q: f32) -> Turn {
    let both = sin_cos(q + offset);
    return Turn(both.x, both.y);
}

// What the joint's damping leaves of its torque.
fn damped(damping: f32, rate: f32, torque: f32) -> f32 {
    return fma(rate, -damping, torque);
}

// The first link turns about a fixed axis: only diagonal entries of its spin.
fn first_motion(model: LegModel, t: Turn, rate: f32) -> Motion {
    let across = model.pelvis.x;
    let along = model.pelvis.y;
    return Motion(
        vec3(0.0, 0.0, rate),
        vec3(0.0),
        vec3(t.cosine * across, -(t.sine * across), along),
        vec3(-(rate * rate), 0.0, 0.0),
        vec3(0.0, -(rate * rate), 0.0),
        vec3(0.0),
    );
}

// The bias that the first link adds at its own joint: its weight.
fn first_moment(joint: Joint, motion: Motion) -> f32 {
    return fma(joint.moments.x, motion.origin.y, -(joint.moments.y * motion.origin.x));
}

// `next_motion` after a first link, of which little moves.
fn second_motion(twist: u32, joint: Joint, t: Turn, first_rate: f32, rate: f32, before: Motion) -> Motion {
    if twist != RIGHT {
        return next_motion(twist, joint, t, rate, before);
    }
    let at_lever = vec3(fma(before.spin_x.x, joint.lever.x, before.origin.x), before.origin.yz);
    let origin = turned_back(t, untwisted(twist, joint, at_lever));
    // The axis of the first joint is y before the turn.
    let w = vec3(t.sine * first_rate, t.cosine * first_rate, rate);
    let dx = w.y * w.z;
    let dy = -(w.x * w.z);
    let xx = w.x * w.x;
    let xy = w.x * w.y;
    let zz = w.z * w.z;
    return Motion(
        w,
        vec3(dx, dy, 0.0),
        origin,
        vec3(-fma(w.y, w.y, zz), xy, 0.0),
        vec3(xy, -(xx + zz), 0.0),
        vec3(-(dy + dy), dx + dx, -fma(w.y, w.y, xx)),
    );
}

// The motion of a link from that of the one before, as long as its joint does not accelerate.
fn next_motion(twist: u32, joint: Joint, t: Turn, rate: f32, before: Motion) -> Motion {
    let origin = turned_back(t, untwisted(twist, joint, at_lever(twist, joint, before)));
    var w = turned_back(t, untwisted(twist, joint, before.angular));
    var d = turned_back(t, untwisted(twist, joint, before.change));
    d.x = fma(w.y, rate, d.x);
    d.y = fma(w.x, -rate, d.y);
    w.z = w.z + rate;
    let xx = w.x * w.x;
    let zz = w.z * w.z;
    return Motion(
        w,
        d,
        origin,
        vec3(-fma(w.y, w.y, zz), fma(w.x, w.y, -d.z), fma(w.x, w.z, d.y)),
        vec3(fma(w.x, w.y, d.z), -(xx + zz), fma(w.y, w.z, -d.x)),
        vec3(fma(w.x, w.z, -d.y), fma(w.y, w.z, d.x), -fma(w.y, w.y, xx)),
    );
}

// a + U p: the acceleration of the next joint's origin.
fn at_lever(twist: u32, joint: Joint, before: Motion) -> vec3<f32> {
    var a = before.origin;
    a = fma(vec3(before.spin_x.x, before.spin_y.x, before.spin_z.x), vec3(joint.lever.x), a);
    if twist == ANY {
        a = fma(vec3(before.spin_x.y, before.spin_y.y, before.spin_z.y), vec3(joint.lever.y), a);
    }
    if twist != PARALLEL {
        a = fma(vec3(before.spin_x.z, before.spin_y.z, before.spin_z.z), vec3(joint.lever.z), a);
    }
    return a;
}

// What it takes to move a link.
fn wrench(joint: Joint, motion: Motion) -> Wrench {
    let hx = joint.moments.x;
    let hy = joint.moments.y;
    let xx = joint.moments.z;
    let yy = joint.moments.w;
    let xy = joint.products.x;
    let xz = joint.products.y;
    let yz = joint.products.z;
    let ux = motion.spin_x;
    let uy = motion.spin_y;
    let uz = motion.spin_z;
    let a = motion.origin;
    let force = vec3(fma(ux.x, hx, ux.y * hy), fma(uy.x, hx, uy.y * hy), fma(uz.x, hx, uz.y * hy));
    var x = fma(uz.x, xy, uz.y * yy);
    x = fma(uy.x, -xz, x);
    x = fma(uz.z - uy.y, yz, x);
    x = fma(hy, a.z, x);
    var y = fma(ux.y, yz, -(uz.x * xx));
    y = fma(uz.y, -xy, y);
    y = fma(ux.x - uz.z, xz, y);
    y = fma(hx, -a.z, y);
    var z = fma(uy.x, xx, -(ux.y * yy));
    z = fma(uy.y - ux.x, xy, z);
    z = fma(uy.z, xz, z);
    z = fma(ux.z, -yz, z);
    z = fma(hx, a.y, z);
    z = fma(hy, -a.x, z);
    return Wrench(force, vec3(x, y, z));
}

// Rz(q) v.
fn turned(t: Turn, v: vec3<f32>) -> vec3<f32> {
    return vec3(fma(t.cosine, v.x, -(t.sine * v.y)), fma(t.sine, v.x, t.cosine * v.y), v.z);
}

// Rz(q)' v.
fn turned_back(t: Turn, v: vec3<f32>) -> vec3<f32> {
    return vec3(fma(t.cosine, v.x, t.sine * v.y), fma(t.cosine, v.y, -(t.sine * v.x)), v.z);
}

// Rx(twist) v.
fn twisted(twist: u32, joint: Joint, v: vec3<f32>) -> vec3<f32> {
    if twist == PARALLEL {
        return v;
    }
    if twist == RIGHT {
        return vec3(v.x, -v.z, v.y);
    }
    let sine = joint.angle.z;
    let cosine = joint.angle.w;
    return vec3(v.x, fma(cosine, v.y, -(sine * v.z)), fma(sine, v.y, cosine * v.z));
}

// Rx(twist)' v.
fn untwisted(twist: u32, joint: Joint, v: vec3<f32>) -> vec3<f32> {
    if twist == PARALLEL {
        return v;
    }
    if twist == RIGHT {
        return vec3(v.x, v.z, -v.y);
    }
    let sine = joint.angle.z;
    let cosine = joint.angle.w;
    return vec3(v.x, fma(cosine, v.y, sine * v.z), fma(cosine, v.z, -(sine * v.y)));
}

// The same wrench in the frame before.
fn carried(twist: u32, joint: Joint, t: Turn, wrench: Wrench) -> Wrench {
    let force = twisted(twist, joint, turned(t, wrench.force));
    let moment = twisted(twist, joint, turned(t, wrench.moment));
    return Wrench(force, levered(twist, joint, moment, force));
}

// The same wrench in the frame before, and what the link before takes itself.
fn joined(twist: u32, joint: Joint, t: Turn, wrench: Wrench, own: Wrench) -> Wrench {
    let beyond = carried(twist, joint, t, wrench);
    return Wrench(beyond.force + own.force, beyond.moment + own.moment);
}

// moment + p x force.
fn levered(twist: u32, joint: Joint, moment: vec3<f32>, f: vec3<f32>) -> vec3<f32> {
    var m = moment;
    m.y = fma(joint.lever.x, -f.z, m.y);
    m.z = fma(joint.lever.x, f.y, m.z);
    if twist == ANY {
        m.x = fma(joint.lever.y, f.z, m.x);
        m.z = fma(joint.lever.y, -f.x, m.z);
    }
    if twist != PARALLEL {
        m.x = fma(joint.lever.z, -f.y, m.x);
        m.y = fma(joint.lever.z, f.x, m.y);
    }
    return m;
}

// The last link.
fn tip(joint: Joint) -> Composite {
    return Composite(
        vec3(joint.moments.xy, 0.0),
        Second(vec3(joint.moments.zw, 0.0), joint.products.xyz),
    );
}

// The body beyond a joint, in the frame before, together with the link there. Without mass, its first moment is the
// same about every point.
fn composite(twist: u32, joint: Joint, t: Turn, beyond: Composite, own: Joint) -> Composite {
    let h = twisted(twist, joint, turned(t, beyond.first));
    let s = twisted_second(twist, joint, turned_second(t, beyond.second));
    var square = s.square + vec3(own.moments.zw, 0.0);
    var product = s.product + own.products.xyz;
    square.x = fma(h.x, joint.lever_twice.x, square.x);
    product.x = fma(h.y, joint.lever.x, product.x);
    product.y = fma(h.z, joint.lever.x, product.y);
    if twist == ANY {
        square.y = fma(h.y, joint.lever_twice.y, square.y);
        product.x = fma(h.x, joint.lever.y, product.x);
        product.z = fma(h.z, joint.lever.y, product.z);
    }
    if twist != PARALLEL {
        square.z = fma(h.z, joint.lever_twice.z, square.z);
        product.y = fma(h.x, joint.lever.z, product.y);
        product.z = fma(h.y, joint.lever.z, product.z);
    }
    return Composite(h + vec3(own.moments.xy, 0.0), Second(square, product));
}

// Rz(q) J Rz(q)'.
fn turned_second(t: Turn, s: Second) -> Second {
    let u = fma(t.cosine, s.square.x, -(t.sine * s.product.x));
    let v = fma(t.cosine, s.product.x, -(t.sine * s.square.y));
    let xx = fma(t.cosine, u, -(t.sine * v));
    return Second(
        vec3(xx, (s.square.x + s.square.y) - xx, s.square.z),
        vec3(
            fma(t.sine, u, t.cosine * v),
            fma(t.cosine, s.product.y, -(t.sine * s.product.z)),
            fma(t.sine, s.product.y, t.cosine * s.product.z),
        ),
    );
}

// Rx(twist) J Rx(twist)'.
fn twisted_second(twist: u32, joint: Joint, s: Second) -> Second {
    if twist == PARALLEL {
        return s;
    }
    if twist == RIGHT {
        return Second(s.square.xzy, vec3(-s.product.y, s.product.x, -s.product.z));
    }
    let sine = joint.angle.z;
    let cosine = joint.angle.w;
    let u = fma(cosine, s.square.y, -(sine * s.product.z));
    let v = fma(cosine, s.product.z, -(sine * s.square.z));
    let yy = fma(cosine, u, -(sine * v));
    return Second(
        vec3(s.square.x, yy, (s.square.y + s.square.z) - yy),
        vec3(
            fma(cosine, s.product.x, -(sine * s.product.y)),
            fma(sine, s.product.x, cosine * s.product.y),
            fma(sine, u, cosine * v),
        ),
    );
}

// Momentum of a body that turns at unit rate.
fn momentum(body: Composite) -> Wrench {
    let square = body.second.square;
    let product = body.second.product;
    return Wrench(vec3(-body.first.y, body.first.x, 0.0), vec3(-product.y, -product.z, square.x + square.y));
}
