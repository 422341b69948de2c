// Twin of src/model/plant/biped.rs: a leg of the biped of (4) with the feedforward law (9). One invocation answers for
// one joint; the first joint's works out the forward dynamics of the leg, from what all six have published.
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

// What a joint takes of them, as own.plant.
struct ChannelPlant {
    max_torque: f32,
}

fn channel_plant() -> ChannelPlant {
    return ChannelPlant(uniforms.plant.max_torque[own.channel / 4u][own.channel % 4u]);
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
    publish(stage, TORQUE, (command + force) * inverse_inertia);
    workgroupBarrier();
    // All have read what was demanded; each torque gives way to the acceleration of its joint.
    if CUT {
        publish(stage, DEMAND, excess);
    }
    if own.channel == 0u {
        leg_accelerate(stage);
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

// Replaces the torques that the joints have published by the accelerations of the joints.
fn leg_accelerate(stage: u32) {
    let acceleration = forward_dynamics(
        uniforms.plant.model,
        leg_seen(stage, POSITION),
        leg_seen(stage, VELOCITY),
        leg_seen(stage, TORQUE),
    );
    slot_set(slot(stage, TORQUE), 0u, own.agent, acceleration[0]);
    slot_set(slot(stage, TORQUE), 1u, own.agent, acceleration[1]);
    slot_set(slot(stage, TORQUE), 2u, own.agent, acceleration[2]);
    slot_set(slot(stage, TORQUE), 3u, own.agent, acceleration[3]);
    slot_set(slot(stage, TORQUE), 4u, own.agent, acceleration[4]);
    slot_set(slot(stage, TORQUE), 5u, own.agent, acceleration[5]);
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
