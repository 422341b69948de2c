// Twin of src/model/group.rs: a group of channels of a whole team. An invocation is one channel of one agent in one episode
// under one controller; a workgroup holds whole teams, whose members see each other through workgroup memory.

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
    // 1 / true inertia.
    inverse_inertia: f32,
    kappa: f32,
    // The step of the agent's first fault that does not begin with the run; NEVER if there is none.
    first_fault: u32,
    // The next step at which what is held changes.
    next_change: u32,
    // The first step that failed; NEVER if none did.
    failed: u32,
}

var<private> own: Own;

// What a channel shows to others, in two halves that the stages use in turn: one barrier per stage is enough, since who
// writes to a half has passed the barrier after which the others had read it.
var<workgroup> published: array<f32, 2u * SHARED * WORKGROUP>;

fn slot(stage: u32, what: u32, channel: u32, agent: u32) -> u32 {
    return (((stage & 1u) * SHARED + what) * NC + channel) * (TEAM * LANES) + agent * LANES + own.lane;
}

// What another channel of this agent has published at this stage.
fn seen(stage: u32, what: u32, channel: u32) -> f32 {
    return published[slot(stage, what, channel, own.agent)];
}

fn publish(stage: u32, what: u32, value: f32) {
    published[slot(stage, what, own.channel, own.agent)] = value;
}

// The answer of the plant at the state of a stage.
fn agent_respond(stage: u32, at: Reference) -> Response {
    let r = reference(stage, at.row);
    let position = r.x + stepped_at(stage, 1u);
    let velocity = r.y + stepped_at(stage, 2u);
    var inputs = Inputs(at, feedback(stage), position, velocity, disturbance);
    if COUPLED || NC > 1u {
        publish_channel(stage, inputs);
        workgroupBarrier();
    }
    if COUPLED {
        // (10): c = kappa x o sum of the other agents' x.
        let others = team_sum(stage) - position;
        inputs.force = fma(others * own.kappa, position, disturbance);
    }
    return respond(stage, inputs);
}

// The sum of x over the team, which the coupling needs.
fn team_sum(stage: u32) -> f32 {
    var sum = 0.0;
    for (var agent = 0u; agent < TEAM; agent++) {
        sum = sum + published[slot(stage, POSITION, own.channel, agent)];
    }
    // Finite, so that an agent that diverged leaves those alone to whom it is coupled with kappa = 0.
    return select(select(FAR_AWAY, -FAR_AWAY, sum < 0.0), sum, lane_within(sum, FAR_AWAY));
}

fn agent_observe(response: Response, settled: bool, now: u32) {
    let estimates = fault_estimates();
    let f1 = response.error_acceleration - response.told;
    let sample = Sample(
        stepped_start[1],
        response.command,
        response.excess,
        estimates.x - f1,
        estimates.y - sensor_fault,
    );
    let limit = select(MAX, own.limits.x, settled);
    own.failed = min(own.failed, select(now, NEVER, lane_within(sample.error, limit)));
    metrics_take(sample, settled, own.limits.y, i32(now));
}

// Sets what is held over the coming step, if it differs from the last.
fn group_begin_step(step: u32) {
    if N_NOISES > 0u || step == own.next_change {
        group_hold(step);
    }
}

fn group_hold(step: u32) {
    signals_hold(step);
    signals_evaluate(false);
    metrics_before_fault(own.first_fault, step);
    own.next_change = min(next_onset(step), select(NEVER, own.first_fault, own.first_fault > step));
}

fn group_stage(stage: u32, at: Reference, settled: bool, step: u32) {
    let response = agent_respond(stage, at);
    if stage == 0u {
        agent_observe(response, settled, step);
    }
    step_channel(stage, response.error_acceleration, sensor_fault, response.told);
    if EXTRA_STATES > 0u {
        stepped_take(stage, EXTRA, response.extra_rate.x);
        stepped_take(stage, EXTRA + 1u, response.extra_rate.y);
    }
}

// The channel's reference `half` half steps after the span's first step.
fn reference_at(half: u32) -> Reference {
    let place = (((span.table_first + half) * TEAM + own.agent) * NC + own.channel) * ROWS;
    return Reference(table[place], place);
}

// Integrates from the span's first step up to its end.
fn group_advance() {
    var end = reference_at(0u);
    for (var step = span.first; step < span.until; step++) {
        group_begin_step(step);
        let start = end;
        let half = 2u * (step - span.first);
        let middle = reference_at(half + 1u);
        end = reference_at(half + 2u);
        group_stage(0u, start, step >= setting.settle_step, step);
        signals_evaluate(true);
        group_stage(1u, middle, false, step);
        group_stage(2u, middle, false, step);
        signals_evaluate(true);
        group_stage(3u, end, false, step);
        if (step + 1u) % FLUSH_STEPS == 0u {
            metrics_flush();
        }
    }
}

// What the channel shows at the span's first step.
fn group_show() -> array<f32, SHOWN> {
    let response = agent_respond(0u, reference_at(0u));
    let position = reference(0u, reference_at(0u).row).x + stepped_start[1];
    let estimates = fault_estimates();
    let f1 = response.error_acceleration - response.told;
    return array(
        position - stepped_start[1],
        position,
        stepped_start[1],
        stepped_start[2],
        stepped_start[OBSERVER + 1u],
        f1,
        estimates.x,
        sensor_fault,
        estimates.y,
        response.command,
    );
}
