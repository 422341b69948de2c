// Twin of src/model/plant/biped.rs: a leg of the biped of (4) with the feedforward law (9). One invocation answers for
// one joint. From what all six have published, the first joint's works out the bias of the leg while the fourth's
// factors its mass matrix, and then solves: two that are no neighbours, so that they run at the same time.
//
// The table holds three rows of each joint, five where limits cut:
//   0     r, r', r'', M(r) r'' + H(r, r')
//   1, 2  the joint's row of M(r); J'f of the ground
//   3, 4  the joint's row of M(r)^-1

// Constants of the plant.
struct Leg {
    model: LegModel,
    // Of the joints: four and two.
    max_torque: array<vec4<f32>, 2>,
}

alias Plant = Leg;

// Whose invocations work out the bias of a leg, and factor and solve. Groups of 32 and of 64 invocations hold joints
// that follow each other, so these lie in different ones (for teams of 1, 2 and 4).
const BIASING_JOINT = 0u;
const SOLVING_JOINT = 3u;

// What a joint takes of them, as own.plant.
struct ChannelPlant {
    max_torque: f32,
    // What is added to q, and the damping.
    offset: f32,
    damping: f32,
}

fn channel_plant() -> ChannelPlant {
    return ChannelPlant(
        uniforms.plant.max_torque[own.channel / 4u][own.channel % 4u],
        uniforms.plant.model.joints[own.channel].angle.x,
        uniforms.plant.model.joints[own.channel].lever.w,
    );
}

// The reference of the joint and its rate: (r, r').
fn reference(stage: u32, row: vec4<f32>) -> vec2<f32> {
    return row.xy;
}

// Shows the other joints of the leg what they need of this one.
fn publish_channel(stage: u32, inputs: Inputs) {
    publish(stage, POSITION, inputs.position);
    publish(stage, VELOCITY, inputs.velocity);
    publish(stage, DEMAND, inputs.feedback);
    let own_turn = turn(own.plant.offset, inputs.position);
    publish(stage, SINE, own_turn.sine);
    publish(stage, COSINE, own_turn.cosine);
}

// A joint's row of a matrix, from the first of its two rows of the table on.
fn matrix_row(at: Reference, first: u32) -> array<f32, 6> {
    let near = table[at.place + first];
    let far = table[at.place + first + 1u];
    return array(near.x, near.y, near.z, near.w, far.x, far.y);
}

// base + row factors; the joints have published the factors.
fn plus_product(stage: u32, base: f32, row: array<f32, 6>, factors: u32) -> f32 {
    var sum = fma(seen(stage, factors, 0u), row[0], base);
    sum = fma(seen(stage, factors, 1u), row[1], sum);
    sum = fma(seen(stage, factors, 2u), row[2], sum);
    sum = fma(seen(stage, factors, 3u), row[3], sum);
    sum = fma(seen(stage, factors, 4u), row[4], sum);
    return fma(seen(stage, factors, 5u), row[5], sum);
}

fn respond(stage: u32, inputs: Inputs) -> Response {
    let at = inputs.reference;
    // (9): M(r) (r'' + u_fb) + H(r, r').
    let demanded = plus_product(stage, at.row.w, matrix_row(at, 1u), DEMAND);
    let limit = own.plant.max_torque;
    let limited = clamp(demanded, -limit, limit);
    let excess = demanded - limited;
    let sent = select(demanded, limited, CUT);
    let command = actuator_command(sent);
    // The true robot is the modelled one times a number, so a torque divided by that does the same to the model.
    let force = fma(ground, table[at.place + 2u].z, inputs.force);
    let torque = (command + force) * inverse_inertia;
    publish(stage, TORQUE, damped(own.plant.damping, inputs.velocity, torque));
    var factors: Factors;
    if own.channel == BIASING_JOINT {
        leg_publish(stage, BIAS, leg_bias(uniforms.plant.model, leg_turns(stage), leg_seen(stage, VELOCITY)));
    }
    if own.channel == SOLVING_JOINT {
        factors = leg_factors(uniforms.plant.model, leg_turns(stage));
    }
    workgroupBarrier();
    // All have read what was demanded; each torque gives way to the acceleration of its joint.
    if CUT {
        publish(stage, DEMAND, excess);
    }
    if own.channel == SOLVING_JOINT {
        leg_publish(stage, TORQUE, leg_solve(factors, leg_left(stage)));
    }
    workgroupBarrier();
    var applied_feedback = inputs.feedback;
    if CUT {
        // The feedback that would have demanded what the limits left.
        applied_feedback = inputs.feedback - plus_product(stage, 0.0, matrix_row(at, 3u), DEMAND);
    }
    let acceleration = seen(stage, TORQUE, own.channel);
    return Response(acceleration - at.row.z, applied_feedback, sent, command, excess, vec2(0.0));
}

// What the bias leaves of the torques.
fn leg_left(stage: u32) -> array<f32, 6> {
    let torque = leg_seen(stage, TORQUE);
    let bias = leg_seen(stage, BIAS);
    let first = Turn(seen(stage, SINE, 0u), seen(stage, COSINE, 0u));
    return array(
        torque[0] - bias[0] - leg_weight(uniforms.plant.model, first),
        torque[1] - bias[1],
        torque[2] - bias[2],
        torque[3] - bias[3],
        torque[4] - bias[4],
        torque[5] - bias[5],
    );
}

// The turns of all joints of the leg.
fn leg_turns(stage: u32) -> array<Turn, 6> {
    let sine = leg_seen(stage, SINE);
    let cosine = leg_seen(stage, COSINE);
    return array(
        Turn(sine[0], cosine[0]),
        Turn(sine[1], cosine[1]),
        Turn(sine[2], cosine[2]),
        Turn(sine[3], cosine[3]),
        Turn(sine[4], cosine[4]),
        Turn(sine[5], cosine[5]),
    );
}

// Publishes for all joints of the leg.
fn leg_publish(stage: u32, what: u32, values: array<f32, 6>) {
    slot_set(slot(stage, what), 0u, own.agent, values[0]);
    slot_set(slot(stage, what), 1u, own.agent, values[1]);
    slot_set(slot(stage, what), 2u, own.agent, values[2]);
    slot_set(slot(stage, what), 3u, own.agent, values[3]);
    slot_set(slot(stage, what), 4u, own.agent, values[4]);
    slot_set(slot(stage, what), 5u, own.agent, values[5]);
}

// What all joints of the leg have published.
fn leg_seen(stage: u32, what: u32) -> array<f32, 6> {
    return array(
        seen(stage, what, 0u),
        seen(stage, what, 1u),
        seen(stage, what, 2u),
        seen(stage, what, 3u),
        seen(stage, what, 4u),
        seen(stage, what, 5u),
    );
}
