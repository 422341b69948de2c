// Appended to the joined shaders: where a probe's inputs come from and its results go to. PROBE_FIRST, PROBE_TAKEN,
// PROBE_GIVEN, PROBE_IMAGE, `load_metrics`, `leave_metrics` and `probe_body` are generated.

var<private> probe_case: u32;

fn taken(k: u32) -> u32 {
    return draws[PROBE_FIRST + probe_case * PROBE_TAKEN + k];
}

fn taken_number(k: u32) -> f32 {
    return bitcast<f32>(taken(k));
}

fn give(k: u32, value: u32) {
    output[probe_case * PROBE_GIVEN + k] = value;
}

fn give_number(k: u32, value: f32) {
    give(k, bitcast<u32>(value));
}

// Input number `k` of the function that is probed.
fn asked(k: u32) -> u32 {
    return taken(PROBE_IMAGE + k);
}

fn number(k: u32) -> f32 {
    return taken_number(PROBE_IMAGE + k);
}

fn numbers(k: u32) -> vec4<f32> {
    return vec4(number(k), number(k + 1u), number(k + 2u), number(k + 3u));
}

// A reference: its first row is an input of the function, what follows is in the table.
fn asked_reference() -> Reference {
    return Reference(numbers(0u), reference_at(0u).place);
}

// Result number `k` of the function that is probed.
fn answer(k: u32, value: u32) {
    give(PROBE_IMAGE + k, value);
}

fn answer_number(k: u32, value: f32) {
    give_number(PROBE_IMAGE + k, value);
}

fn answer_response(response: Response) {
    answer_number(0u, response.error_acceleration);
    answer_number(1u, response.applied_feedback);
    answer_number(2u, response.sent);
    answer_number(3u, response.command);
    answer_number(4u, response.excess);
    answer_number(5u, response.extra_rate.x);
    answer_number(6u, response.extra_rate.y);
}

// The private state, from the image of it that the probe is given.
fn load() {
    for (var k = 0u; k < STATES; k++) {
        stepped_start[k] = taken_number(k);
        stepped_point[k] = taken_number(STATES + k);
        stepped_sum[k] = taken_number(2u * STATES + k);
    }
    disturbance = taken_number(36u);
    sensor_fault = taken_number(37u);
    command_gain = taken_number(38u);
    command_bias = taken_number(39u);
    held_sensor = taken_number(40u);
    outside = bitcast<i32>(taken(41u));
    outside_before_fault = bitcast<i32>(taken(42u));
    own.failed = taken(43u);
    own.next_change = taken(44u);
    exogenous_inputs_begin(0u);
    held_disturbance = taken_number(45u);
    scale = taken_number(46u);
    frozen = taken_number(47u);
    inverse_inertia = taken_number(48u);
    actuator = Actuator(taken_number(49u), taken_number(50u), taken_number(51u), taken_number(52u), taken_number(61u));
    last_command = taken_number(53u);
    own.held_feedback = taken_number(54u);
    slew = taken_number(55u);
    blocked = taken_number(56u);
    last_sent = taken_number(57u);
    last_arrived = taken_number(58u);
    last_measured = vec2(taken_number(59u), taken_number(60u));
    load_metrics(62u);
    var at = 62u + N_EXTREMES + N_SUMS;
    for (var k = 0u; k < N_WAVES; k++) {
        waves[k].phase = taken(at);
        waves[k].held = taken_number(at + 1u);
        at += 2u;
    }
    for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) {
        pasts[k] = Past(
            taken_number(at),
            vec2(taken_number(at + 1u), taken_number(at + 2u)),
            vec2(taken_number(at + 3u), taken_number(at + 4u)),
        );
        at += 5u;
    }
    if N_LEAKS > 0u {
        slot_set(command_slot(), own.channel, own.agent, last_command);
        workgroupBarrier();
    }
}

// The image of the private state.
fn leave() {
    for (var k = 0u; k < STATES; k++) {
        give_number(k, stepped_start[k]);
        give_number(STATES + k, stepped_point[k]);
        give_number(2u * STATES + k, stepped_sum[k]);
    }
    give_number(36u, disturbance);
    give_number(37u, sensor_fault);
    give_number(38u, command_gain);
    give_number(39u, command_bias);
    give_number(40u, held_sensor);
    give(41u, bitcast<u32>(outside));
    give(42u, bitcast<u32>(outside_before_fault));
    give(43u, own.failed);
    give(44u, own.next_change);
    give_number(45u, held_disturbance);
    give_number(46u, scale);
    give_number(47u, frozen);
    give_number(48u, inverse_inertia);
    give_number(49u, actuator.gain);
    give_number(50u, actuator.bias);
    give_number(51u, actuator.low);
    give_number(52u, actuator.high);
    give_number(53u, last_command);
    give_number(54u, own.held_feedback);
    give_number(55u, slew);
    give_number(56u, blocked);
    give_number(57u, last_sent);
    give_number(58u, last_arrived);
    give_number(59u, last_measured.x);
    give_number(60u, last_measured.y);
    give_number(61u, actuator.dead_zone);
    leave_metrics(62u);
    var at = 62u + N_EXTREMES + N_SUMS;
    for (var k = 0u; k < N_WAVES; k++) {
        give(at, waves[k].phase);
        give_number(at + 1u, waves[k].held);
        at += 2u;
    }
    for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) {
        give_number(at, pasts[k].plays);
        give_number(at + 1u, pasts[k].start.x);
        give_number(at + 2u, pasts[k].start.y);
        give_number(at + 3u, pasts[k].end.x);
        give_number(at + 4u, pasts[k].end.y);
        at += 5u;
    }
}

// A scene is an episode of the workgroup; a workgroup probes one stage.
@compute @workgroup_size(WORKGROUP)
fn probe(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
) {
    probe_case = workgroup.x * WORKGROUP + local;
    identify(local, workgroup.x);
    probe_body(workgroup.x % 4u, (workgroup.x * LANES + own.lane) * 7u % 1000u);
}
