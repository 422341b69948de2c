// Twin of src/model/team.rs and src/model/agent.rs: a group of channels of a whole team. An invocation is one channel
// of one agent in one episode under one controller; a workgroup holds whole teams, whose members see each other through
// workgroup memory.

// Who this invocation is.
struct Own {
    // Its place in the workgroup.
    local: u32,
    // Its episode's place among those of the workgroup.
    lane: u32,
    agent: u32,
    // Its channel, counted from the group's first.
    channel: u32,
    // Where its words begin in the buffers; they are WORKGROUP apart.
    first_drawn: u32,
    first_stored: u32,
    // max_error and settled_error.
    limits: vec2<f32>,
    // What the channel takes of the constants of its plant.
    plant: ChannelPlant,
    // 1 / true inertia, before it changes.
    inverse_inertia: f32,
    kappa: f32,
    // u_fb as it is held by a sampled controller.
    held_feedback: f32,
    // The step of the agent's first fault that does not begin with the run; NEVER if there is none.
    first_fault: u32,
    // The next step at which what is held changes.
    next_change: u32,
    // The first step that failed; NEVER if none did.
    failed: u32,
}

var<private> own: Own;

// What a channel shows to others, in two halves that the stages use in turn: one barrier per stage is enough, since who
// writes to a half has passed the barrier after which the others had read it. Where commands leak, the last ones
// follow: they are written after the first barrier of a step and read before that of the next.
//
// An index for each dimension: where channel and agent are constants, so is all but the lane, and the check that an
// index is within its array is one for all of them.
var<workgroup> published: array<array<array<array<f32, LANES>, TEAM>, NC>, PUBLISHED>;

fn slot(stage: u32, what: u32) -> u32 {
    return (stage & 1u) * SHARED + what;
}

fn command_slot() -> u32 {
    return 2u * SHARED;
}

fn slot_get(slot: u32, channel: u32, agent: u32) -> f32 {
    return published[slot][channel][agent][own.lane];
}

fn slot_set(slot: u32, channel: u32, agent: u32, value: f32) {
    published[slot][channel][agent][own.lane] = value;
}

// What another channel of this agent has published at this stage.
fn seen(stage: u32, what: u32, channel: u32) -> f32 {
    return slot_get(slot(stage, what), channel, own.agent);
}

fn publish(stage: u32, what: u32, value: f32) {
    slot_set(slot(stage, what), own.channel, own.agent, value);
}

// x and x' of the channel at the state of a stage.
fn agent_motion(stage: u32, at: Reference) -> vec2<f32> {
    return reference(stage, at.row) + vec2(stepped_at(stage, 1u), stepped_at(stage, 2u));
}

// u_fb at the state of a stage of a step: a sampled controller holds it from one of its ticks to the next.
fn agent_feedback(stage: u32, step: u32) -> f32 {
    if HOLD_STEPS > 1u {
        if stage > 0u || !exogenous_inputs_ticks(step) {
            return own.held_feedback;
        }
    }
    return feedback(stage);
}

// The answer of the plant at the state of a stage.
fn agent_respond(stage: u32, at: Reference, step: u32) -> Response {
    let motion = agent_motion(stage, at);
    let position = motion.x;
    var inputs = Inputs(at, agent_feedback(stage, step), position, motion.y, disturbance);
    if COUPLED || NC > 1u || N_LEAKS > 0u {
        publish_channel(stage, inputs);
        workgroupBarrier();
    }
    if COUPLED {
        let team = team_sum(stage);
        if CENTROID {
            // The same with x counted from the centroid, where all sum up to zero: the others' are minus one's own.
            let from_centroid = fma(team, -TEAM_SHARE, position);
            inputs.force = fma(from_centroid * -own.kappa, from_centroid, disturbance);
        } else {
            // (10): c = kappa x o sum of the other agents' x.
            let others = team - position;
            inputs.force = fma(others * own.kappa, position, disturbance);
        }
    }
    if N_FRICTIONS > 0u {
        inputs.force = inputs.force + friction_force(motion.y);
    }
    if N_VORTICES > 0u && own.channel == HEIGHT {
        inputs.force = inputs.force + vortex_force(stage);
    }
    return respond(stage, inputs);
}

// The sum of x over the team, which the coupling needs.
fn team_sum(stage: u32) -> f32 {
    var sum = 0.0;
    for (var agent = 0u; agent < TEAM; agent++) {
        sum = sum + slot_get(slot(stage, POSITION), own.channel, agent);
    }
    return finite(sum);
}

// The sum of the team's last commands, of which some may leak into others.
fn team_commands() -> f32 {
    var sum = 0.0;
    if N_LEAKS > 0u {
        for (var agent = 0u; agent < TEAM; agent++) {
            sum = sum + slot_get(command_slot(), own.channel, agent);
        }
        sum = finite(sum);
    }
    return sum;
}

// A sum over a team, or an agent's place, made finite, so that an agent that diverged leaves those alone on whom it
// acts with a strength of zero.
fn finite(sum: f32) -> f32 {
    return select(select(FAR_AWAY, -FAR_AWAY, sum < 0.0), sum, lane_within(sum, FAR_AWAY));
}

// By how much x and x' are measured too large at the state of a stage, beside f2.
fn agent_distortion(stage: u32, at: Reference) -> vec2<f32> {
    if !DISTORTS {
        return vec2(0.0);
    }
    let motion = agent_motion(stage, at);
    return measure((stage + 1u) / 2u, motion) - motion;
}

// Keeps what the next step needs of the start of this one.
fn agent_remember(response: Response, at: Reference, step: u32) {
    own.held_feedback = agent_feedback(0u, step);
    exogenous_inputs_remember(step, response.sent, agent_motion(0u, at));
    if N_LEAKS > 0u {
        slot_set(command_slot(), own.channel, own.agent, last_command);
    }
}

fn agent_observe(response: Response, off: vec2<f32>, settled: bool, now: u32) {
    let estimates = fault_estimates();
    let f1 = response.error_acceleration - response.applied_feedback;
    let sample = Sample(
        stepped_start[1],
        stepped_start[2],
        response.command,
        response.excess,
        estimates.x - f1,
        estimates.y - (sensor_fault + off.y),
    );
    let limit = select(MAX, own.limits.x, settled);
    own.failed = min(own.failed, select(now, NEVER, lane_within(sample.error, limit)));
    metrics_take(sample, settled, own.limits.y, i32(now));
}

// Sets what is held over the coming step, if it differs from the last.
fn team_state_begin_step(step: u32) {
    if RESTLESS || step == own.next_change {
        team_state_hold(step);
    }
}

fn team_state_hold(step: u32) {
    exogenous_inputs_hold(step, team_commands());
    exogenous_inputs_evaluate(step, START);
    metrics_before_fault(own.first_fault, step);
    own.next_change = min(next_change(step), select(NEVER, own.first_fault, own.first_fault > step));
}

fn team_state_stage(stage: u32, at: Reference, settled: bool, step: u32) {
    let response = agent_respond(stage, at, step);
    let off = agent_distortion(stage, at);
    if stage == 0u {
        agent_observe(response, off, settled, step);
        if REMEMBERS {
            agent_remember(response, at, step);
        }
    }
    step_channel(stage, response.error_acceleration, sensor_fault, off, response.applied_feedback);
    if EXTRA_STATES > 0u {
        stepped_take(stage, EXTRA, response.extra_rate.x);
        stepped_take(stage, EXTRA + 1u, response.extra_rate.y);
    }
}

// Ends a step for what follows a law of its own.
fn team_state_end_step(step: u32) {
    for (var k = 0u; k < N_TURBULENCES; k++) {
        turbulence_advance(k, step);
    }
}

// The channel's reference `half` half steps after the span's first step.
fn reference_at(half: u32) -> Reference {
    let place = (((span.table_first + half) * TEAM + own.agent) * NC + own.channel) * ROWS;
    return Reference(table[place], place);
}

// Integrates from the span's first step up to its end.
fn team_state_advance() {
    var end = reference_at(0u);
    for (var step = span.first; step < span.until; step++) {
        team_state_begin_step(step);
        let start = end;
        let half = 2u * (step - span.first);
        let middle = reference_at(half + 1u);
        end = reference_at(half + 2u);
        team_state_stage(0u, start, step >= uniforms.settle_step, step);
        exogenous_inputs_evaluate(step, MIDDLE);
        team_state_stage(1u, middle, false, step);
        team_state_stage(2u, middle, false, step);
        exogenous_inputs_evaluate(step, END);
        team_state_stage(3u, end, false, step);
        team_state_end_step(step);
        if (step + 1u) % FLUSH_STEPS == 0u {
            metrics_flush();
        }
    }
}

// What the channel shows at the span's first step.
fn team_state_show() -> array<f32, SHOWN> {
    let response = agent_respond(0u, reference_at(0u), span.first);
    let off = agent_distortion(0u, reference_at(0u));
    let position = agent_motion(0u, reference_at(0u)).x;
    let estimates = fault_estimates();
    let f1 = response.error_acceleration - response.applied_feedback;
    return array(
        position - stepped_start[1],
        position,
        stepped_start[1],
        stepped_start[2],
        stepped_start[OBSERVER + 1u],
        f1,
        estimates.x,
        sensor_fault + off.y,
        estimates.y,
        response.command,
    );
}
