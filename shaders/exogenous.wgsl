// Twin of src/model/exogenous/evaluation.rs, src/model/exogenous/inputs.rs and src/model/exogenous/lists.rs:
// disturbances and faults of one channel, what is held over a step and what varies within it.

// A periodic signal; its list says of what shape. `held` is the amplitude of this step.
struct Oscillation {
    inverse_smoothing: f32,
    phase: u32,
    // Turns per half step.
    advance: u32,
    held: f32,
}

// All waves, in the order of their switches.
var<private> waves: array<Oscillation, max(N_WAVES, 1u)>;
// The part of d1 that is always there.
var<private> constant: f32;
// Scale of the ground's reaction.
var<private> ground: f32;
// What of d1 and of f2 is held over this step.
var<private> held_disturbance: f32;
var<private> held_sensor: f32;
// By what share x and x' are measured too large in this step.
var<private> scale: f32;
// Whether the measurement stays what it was (1 or 0).
var<private> frozen: f32;
// 1 / true inertia in this step.
var<private> inverse_inertia: f32;
// x and x' as measured at the start of the last step.
var<private> last_measured: vec2<f32>;
// d1 and f2 at the current stage's time.
var<private> disturbance: f32;
var<private> sensor_fault: f32;

// Takes the signals from the draw, with their phases at the start of a step. Phases count in fixed point modulo one
// turn, so this is exactly the sum of as many half steps.
fn exogenous_inputs_begin(step: u32) {
    constant = drawn_number(CONSTANT);
    ground = drawn_number(GROUND);
    actuator = Actuator(1.0, 0.0, -MAX, MAX, 0.0);
    for (var k = 0u; k < N_WAVES; k++) {
        let word = WAVES + 3u * k;
        let advance = drawn(word + 2u);
        waves[k] = Oscillation(drawn_number(word), drawn(word + 1u) + 2u * step * advance, advance, 0.0);
    }
}

// Whether a sampled controller gives a new command at the start of a step.
fn exogenous_inputs_ticks(step: u32) -> bool {
    return step % HOLD_STEPS == 0u;
}

// Sets what is held over step number `step`; `team` is the sum of the team's last commands.
fn exogenous_inputs_hold(step: u32, team: f32) {
    hold_command(step, team);
    hold_sensor(step);
    var force = constant;
    for (var k = 0u; k < N_WEIGHTS; k++) {
        force = force + window_at(WEIGHTS + k, step);
    }
    for (var k = 0u; k < N_TURBULENCES; k++) {
        force = force + turbulence_force(k);
    }
    held_disturbance = force;
    var grown = 1.0;
    for (var k = 0u; k < N_INERTIAS; k++) {
        grown = grown + window_at(INERTIAS + k, step);
    }
    inverse_inertia = own.inverse_inertia;
    if N_INERTIAS > 0u {
        inverse_inertia = own.inverse_inertia / grown;
    }
    for (var k = 0u; k < N_WAVES; k++) {
        waves[k].held = window_at(SINES + k, step);
    }
}

fn hold_sensor(step: u32) {
    var sensor = 0.0;
    for (var k = 0u; k < N_SENSOR_BIASES; k++) {
        sensor = sensor + window_at(SENSOR_BIASES + k, step);
    }
    for (var k = 0u; k < N_NOISES; k++) {
        if step % 4u == 0u {
            noise_draw(k, step / 4u);
        }
        let sample = stored_number(SAMPLES + 4u * k + step % 4u);
        sensor = fma(sample, window_at(NOISES + k, step), sensor);
    }
    for (var k = 0u; k < N_OUTLIERS; k++) {
        let outlier = intermittent_window_at(OUTLIERS + k, step);
        sensor = fma(outlier.x, outlier.y, sensor);
    }
    held_sensor = sensor;
    var too_large = 0.0;
    for (var k = 0u; k < N_SCALES; k++) {
        too_large = too_large + window_at(SCALES + k, step);
    }
    scale = too_large;
    var holds = 0.0;
    for (var k = 0u; k < N_SENSOR_HOLDS; k++) {
        holds = lane_max(holds, intermittent_window_at(SENSOR_HOLDS + k, step).x);
    }
    frozen = select(holds, 0.0, step == 0u);
    for (var k = 0u; k < N_SENSOR_RINGS; k++) {
        delay_line_hold(N_COMMAND_RINGS + k, step);
    }
}

// Evaluates d1, f2 and the actuator at a moment of step number `step`, whose phases are half a step further each.
fn exogenous_inputs_evaluate(step: u32, moment: u32) {
    let advance = moment != START;
    disturbance = held_disturbance;
    sensor_fault = held_sensor;
    for (var k = SINES; k < SINES + N_SINES; k++) {
        let sine = oscillation_turned(k - SINES, advance);
        disturbance = fma(sine, waves[k - SINES].held, disturbance);
    }
    for (var k = GUSTS; k < GUSTS + N_GUSTS; k++) {
        let shape = fma(oscillation_turned(k - SINES, advance), 0.5, 0.5);
        disturbance = fma(shape, waves[k - SINES].held, disturbance);
    }
    for (var k = SENSOR_WAVES; k < SENSOR_WAVES + N_SENSOR_WAVES; k++) {
        let sine = oscillation_turned(k - SINES, advance);
        sensor_fault = fma(sine, waves[k - SINES].held, sensor_fault);
    }
    for (var k = SQUARES; k < SQUARES + N_SQUARES; k++) {
        let sine = oscillation_turned(k - SINES, advance);
        let shape = tanh(sine * waves[k - SINES].inverse_smoothing);
        sensor_fault = fma(shape, waves[k - SINES].held, sensor_fault);
    }
    evaluate_command(step, moment);
}

// x and x' as they are measured at a moment of the step.
fn measure(moment: u32, motion: vec2<f32>) -> vec2<f32> {
    var seen = vec2(fma(motion.x, scale, motion.x), fma(motion.y, scale, motion.y));
    for (var k = 0u; k < N_SENSOR_RINGS; k++) {
        seen = delay_line_recall(N_COMMAND_RINGS + k, moment, seen);
    }
    return select(seen, last_measured, frozen >= 0.5);
}

// Takes in what was demanded and what was at the start of a step.
fn exogenous_inputs_remember(step: u32, sent: f32, motion: vec2<f32>) {
    last_measured = measure(START, motion);
    last_command = actuator_command(sent);
    remember_command(step, sent);
    var seen = vec2(fma(motion.x, scale, motion.x), fma(motion.y, scale, motion.y));
    for (var k = 0u; k < N_SENSOR_RINGS; k++) {
        let ring = N_COMMAND_RINGS + k;
        let recalled = delay_line_recall(ring, START, seen);
        delay_line_record(ring, step, seen);
        seen = recalled;
    }
}

// The sine of a wave's phase, after half a step if it is to `advance`.
fn oscillation_turned(k: u32, advance: bool) -> f32 {
    if advance {
        waves[k].phase = waves[k].phase + waves[k].advance;
    }
    return lane_turns_sin(waves[k].phase);
}
