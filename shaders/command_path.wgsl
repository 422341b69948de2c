// Twin of src/model/exogenous/command_path.rs and src/model/exogenous/actuator.rs: the way of a command from the
// controller to the plant.

// What faults leave of the command in this step, and what they add to it.
var<private> command_gain: f32;
var<private> command_bias: f32;
// By how much the acting command may change in a step.
var<private> slew: f32;
// Whether the link brings no new command (1 or 0).
var<private> blocked: f32;
// At the start of the last step: the command that the controller sent, the one that arrived at the actuator, and the
// one that acted.
var<private> last_sent: f32;
var<private> last_arrived: f32;
var<private> last_command: f32;

// What is between the command that is demanded and the one that acts: clamp(gain demanded + bias, low, high), where
// what is within the dead zone, if there is one, gives nothing.
struct Actuator {
    gain: f32,
    bias: f32,
    low: f32,
    high: f32,
    // Up to which size the command gives nothing in this step.
    dead_zone: f32,
}

var<private> actuator: Actuator;

// The command that acts on the channel.
fn actuator_command(sent: f32) -> f32 {
    var arrived = fma(sent, actuator.gain, actuator.bias);
    if N_DEAD_ZONES > 0u {
        arrived = beyond_dead_zone(arrived, actuator.dead_zone);
    }
    return clamp(arrived, actuator.low, actuator.high);
}

// What of a command goes beyond a dead zone of this half width.
fn beyond_dead_zone(command: f32, half_width: f32) -> f32 {
    return command - clamp(command, -half_width, half_width);
}

// Sets what faults do to the command in step number `step`; `team` is the sum of the team's last commands.
fn hold_command(step: u32, team: f32) {
    var gain = 1.0;
    for (var k = 0u; k < N_LOSSES; k++) {
        gain = gain * (1.0 - window_at(LOSSES + k, step));
    }
    for (var k = 0u; k < N_INTERMITTENTS; k++) {
        let lost = intermittent_window_at(INTERMITTENTS + k, step).x;
        gain = gain * (1.0 - lost);
    }
    var bias = 0.0;
    for (var k = 0u; k < N_COMMAND_BIASES; k++) {
        bias = bias + window_at(COMMAND_BIASES + k, step);
    }
    for (var k = 0u; k < N_LEAKS; k++) {
        let others = team - last_command;
        bias = fma(others, window_at(LEAKS + k, step), bias);
    }
    for (var k = 0u; k < N_HARD_OVERS; k++) {
        let weight = window_weight(HARD_OVERS + k, step);
        let left = 1.0 - weight;
        gain = gain * left;
        bias = fma(window_value(HARD_OVERS + k), weight, bias * left);
    }
    command_gain = gain;
    command_bias = bias;
    var limit = MAX;
    for (var k = 0u; k < N_RATE_LIMITS; k++) {
        let weight = window_weight(RATE_LIMITS + k, step);
        limit = lane_select_le(0.5, weight, lane_min(window_value(RATE_LIMITS + k), limit), limit);
    }
    slew = limit;
    if N_DEAD_ZONES > 0u {
        // Two zones, one after the other, are one as wide as both.
        var wide = 0.0;
        for (var k = 0u; k < N_DEAD_ZONES; k++) {
            wide = wide + window_at(DEAD_ZONES + k, step);
        }
        actuator.dead_zone = wide;
    }
    var blocks = 0.0;
    for (var k = 0u; k < N_COMMAND_HOLDS; k++) {
        blocks = lane_max(blocks, intermittent_window_at(COMMAND_HOLDS + k, step).x);
    }
    blocked = blocks;
    for (var k = 0u; k < N_COMMAND_RINGS; k++) {
        delay_line_hold(k, step);
    }
}

// Evaluates the actuator at a moment of step number `step`; the phases of what oscillates have been turned.
fn evaluate_command(step: u32, moment: u32) {
    if moment == START || N_COMMAND_WAVES > 0u || CARRIES {
        actuator.gain = command_gain;
        actuator.bias = command_bias;
    }
    for (var k = COMMAND_WAVES; k < COMMAND_WAVES + N_COMMAND_WAVES; k++) {
        let sine = oscillation_turned(k - SINES, moment != START);
        actuator.bias = fma(sine, waves[k - SINES].held, actuator.bias);
    }
    if CARRIES {
        carry_command(step, moment);
    }
    if N_RATE_LIMITS > 0u {
        limit_rate(step, moment);
    }
}

// Replaces the demanded command by the one that arrives at the actuator. What a sampled controller sends is constant
// within a step, and stays so however late it arrives: delays are whole steps.
fn carry_command(step: u32, moment: u32) {
    let sampled = HOLD_STEPS > 1u;
    let held = sampled && (moment != START || !exogenous_inputs_ticks(step));
    let recalled = select(moment, START, sampled);
    // What is sent at first arrives, blocked or not: before it there is nothing.
    let first = step == 0u && moment == START;
    var sent = vec2(1.0, 0.0);
    var other = vec2(0.0);
    if held {
        sent = vec2(0.0);
        other = vec2(last_sent, 0.0);
    }
    for (var k = 0u; k < N_COMMAND_RINGS; k++) {
        other = delay_line_recall(k, recalled, other);
        sent = delay_line_or_past(k, sent, vec2(0.0));
    }
    if N_COMMAND_HOLDS > 0u && !first {
        other.x = lane_select_le(0.5, blocked, last_arrived, other.x);
        sent.x = lane_select_le(0.5, blocked, 0.0, sent.x);
    }
    let gain = actuator.gain;
    actuator.bias = fma(other.x, gain, actuator.bias);
    actuator.gain = gain * sent.x;
}

// Keeps the acting command near the one at the start of the last step; at first, there is none.
fn limit_rate(step: u32, moment: u32) {
    var near = slew;
    if moment == MIDDLE {
        near = slew * 0.5;
    }
    if step == 0u && moment == START {
        near = MAX;
    }
    actuator.low = last_command - near;
    actuator.high = last_command + near;
}

// Takes in what was demanded at the start of step number `step`: what of it was sent, and what arrived.
fn remember_command(step: u32, sent: f32) {
    if exogenous_inputs_ticks(step) {
        last_sent = sent;
    }
    var carried = vec2(last_sent, 0.0);
    for (var k = 0u; k < N_COMMAND_RINGS; k++) {
        let recalled = delay_line_recall(k, START, carried);
        delay_line_record(k, step, carried);
        carried = recalled;
    }
    let arrives = lane_select_le(0.5, blocked, last_arrived, carried.x);
    last_arrived = select(arrives, carried.x, step == 0u);
}
