// Twin of src/model/episode.rs, and the entry points: from draws to channels, and from their ends to outcomes.

struct Uniforms {
    // Philox key.
    seed: vec2<u32>,
    settle_step: u32,
    first_channel: u32,
    h: Step,
    plant: Plant,
    // max_error and settled_error of each channel.
    limits: array<vec4<f32>, NC>,
    // Of the kinds of channels in the group: under thrust those of position, then of attitude.
    gains: array<ChannelGains, KINDS>,
}

// A span of steps that one dispatch covers.
struct Span {
    first: u32,
    until: u32,
    // The row of the table that belongs to its first step.
    table_first: u32,
    // Where its output begins, in words.
    output_first: u32,
}

@group(0) @binding(0) var<uniform> uniforms: Uniforms;
@group(0) @binding(1) var<uniform> span: Span;
// What was drawn, `[block of episodes][word][channel][agent][episode]`; all controllers read the same.
@group(0) @binding(2) var<storage, read> draws: array<u32>;
// The state between two spans, `[block of episodes][word][channel][agent][episode]`.
@group(0) @binding(3) var<storage, read_write> state: array<u32>;
// Reference at half steps, `[half step][agent][channel][row]`.
@group(0) @binding(4) var<storage, read> table: array<vec4<f32>>;
// Outcomes, ordered as the state.
@group(0) @binding(5) var<storage, read_write> output: array<u32>;

fn drawn(word: u32) -> u32 {
    return draws[own.first_drawn + word * WORKGROUP];
}

fn drawn_number(word: u32) -> f32 {
    return bitcast<f32>(drawn(word));
}

fn stored(word: u32) -> u32 {
    return state[own.first_stored + word * WORKGROUP];
}

fn stored_number(word: u32) -> f32 {
    return bitcast<f32>(stored(word));
}

fn store(word: u32, value: u32) {
    state[own.first_stored + word * WORKGROUP] = value;
}

fn store_number(word: u32, value: f32) {
    store(word, bitcast<u32>(value));
}

// Finds out who this invocation is.
fn identify(local: u32, workgroup: u32) {
    own.local = local;
    own.lane = local % LANES;
    own.agent = local / LANES % TEAM;
    own.channel = local / (LANES * TEAM);
    own.first_drawn = workgroup * (DRAWN_WORDS * WORKGROUP) + local;
    own.first_stored = workgroup * (STORED_WORDS * WORKGROUP) + local;
    own.limits = uniforms.limits[own.channel].xy;
    own.plant = channel_plant();
    own.inverse_inertia = drawn_number(INVERSE_INERTIA);
    own.kappa = drawn_number(KAPPA);
    own.first_fault = drawn(FIRST_FAULT);
}

// Takes the state from where the last span left it.
fn resume() {
    own.failed = stored(FAILED);
    metrics_resume();
    stepped_start[0] = stored_number(CHANNEL);
    stepped_start[1] = stored_number(CHANNEL + 1u);
    stepped_start[2] = stored_number(CHANNEL + 2u);
    stepped_start[3] = stored_number(CHANNEL + 3u);
    stepped_start[4] = stored_number(CHANNEL + 4u);
    stepped_start[5] = stored_number(CHANNEL + 5u);
    stepped_start[6] = stored_number(CHANNEL + 6u);
    stepped_start[7] = stored_number(CHANNEL + 7u);
    stepped_start[8] = stored_number(CHANNEL + 8u);
    stepped_start[9] = stored_number(CHANNEL + 9u);
    if EXTRA_STATES > 0u {
        stepped_start[EXTRA] = stored_number(CHANNEL + EXTRA);
        stepped_start[EXTRA + 1u] = stored_number(CHANNEL + EXTRA + 1u);
    }
    exogenous_inputs_begin(span.first);
    if REMEMBERS {
        last_command = stored_number(MEMORY);
        last_measured = vec2(stored_number(MEMORY + 1u), stored_number(MEMORY + 2u));
        own.held_feedback = stored_number(MEMORY + 3u);
        last_sent = stored_number(MEMORY + 4u);
        last_arrived = stored_number(MEMORY + 5u);
    }
    if N_LEAKS > 0u {
        slot_set(command_slot(), own.channel, own.agent, last_command);
        workgroupBarrier();
    }
    team_state_hold(span.first);
}

// Leaves the state for the next span.
fn keep() {
    store(FAILED, own.failed);
    metrics_keep();
    store_number(CHANNEL, stepped_start[0]);
    store_number(CHANNEL + 1u, stepped_start[1]);
    store_number(CHANNEL + 2u, stepped_start[2]);
    store_number(CHANNEL + 3u, stepped_start[3]);
    store_number(CHANNEL + 4u, stepped_start[4]);
    store_number(CHANNEL + 5u, stepped_start[5]);
    store_number(CHANNEL + 6u, stepped_start[6]);
    store_number(CHANNEL + 7u, stepped_start[7]);
    store_number(CHANNEL + 8u, stepped_start[8]);
    store_number(CHANNEL + 9u, stepped_start[9]);
    if EXTRA_STATES > 0u {
        store_number(CHANNEL + EXTRA, stepped_start[EXTRA]);
        store_number(CHANNEL + EXTRA + 1u, stepped_start[EXTRA + 1u]);
    }
    if REMEMBERS {
        store_number(MEMORY, last_command);
        store_number(MEMORY + 1u, last_measured.x);
        store_number(MEMORY + 2u, last_measured.y);
        store_number(MEMORY + 3u, own.held_feedback);
        store_number(MEMORY + 4u, last_sent);
        store_number(MEMORY + 5u, last_arrived);
    }
}

// The initial state: errors as drawn, and what the observers start from.
@compute @workgroup_size(WORKGROUP)
fn start(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
) {
    identify(local, workgroup.x);
    own.failed = NEVER;
    outside = -1;
    outside_before_fault = -1;
    for (var k = 0u; k < N_SUMS; k++) {
        store_number(TOTALS + k, 0.0);
    }
    for (var k = 0u; k < 2u * N_TURBULENCES; k++) {
        store_number(TURBULENCE_STATE + k, turbulence_filter(k / 2u, 7u + k % 2u));
    }
    exogenous_inputs_begin(0u);
    exogenous_inputs_hold(0u, 0.0);
    exogenous_inputs_evaluate(0u, START);
    let integral = drawn_number(INTEGRAL);
    let error = drawn_number(ERROR);
    let rate = drawn_number(ERROR_RATE);
    stepped_start[0] = integral;
    stepped_start[1] = error;
    stepped_start[2] = rate;
    if OBSERVER_MEASURED {
        let off = agent_distortion(0u, reference_at(0u));
        let measured = channel_gains_measured(integral, error + off.x, rate + off.y, sensor_fault);
        stepped_start[OBSERVER] = measured.x;
        stepped_start[OBSERVER + 1u] = measured.y;
        stepped_start[OBSERVER + 2u] = measured.z;
    }
    keep();
}

// Integrates the span.
@compute @workgroup_size(WORKGROUP)
fn advance(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
) {
    identify(local, workgroup.x);
    resume();
    team_state_advance();
    keep();
}

// Shows every channel at the span's first step.
@compute @workgroup_size(WORKGROUP)
fn show(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
) {
    identify(local, workgroup.x);
    resume();
    let shown = team_state_show();
    let first = span.output_first + workgroup.x * (SHOWN * WORKGROUP) + local;
    for (var k = 0u; k < SHOWN; k++) {
        output[first + k * WORKGROUP] = bitcast<u32>(shown[k]);
    }
}

// Writes the outcome words: how the channel ended, and its metrics.
@compute @workgroup_size(WORKGROUP)
fn finish(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
) {
    identify(local, workgroup.x);
    resume();
    metrics_flush();
    var finite = true;
    for (var k = 0u; k < EXTRA; k++) {
        finite = finite && lane_within(stored_number(CHANNEL + k), MAX);
    }
    let first = workgroup.x * (OUTCOME_WORDS * WORKGROUP) + local;
    output[first] = own.failed;
    output[first + WORKGROUP] = select(0u, 1u, finite);
    output[first + 2u * WORKGROUP] = bitcast<u32>(outside);
    output[first + 3u * WORKGROUP] = bitcast<u32>(outside_before_fault);
    for (var k = 0u; k < N_EXTREMES; k++) {
        output[first + (4u + k) * WORKGROUP] = stored(LARGEST + k);
    }
    for (var k = 0u; k < N_SUMS; k++) {
        output[first + (4u + N_EXTREMES + k) * WORKGROUP] = stored(TOTALS + k);
    }
    output[first + (4u + N_EXTREMES + N_SUMS) * WORKGROUP] = drawn(EPISODE);
}
