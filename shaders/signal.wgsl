// Twin of src/model/signal.rs: disturbances and faults of one channel, what is held over a step and what varies within it.

// amplitude sin(phase); `advance` is in turns per half step.
struct Sine {
    amplitude: f32,
    phase: u32,
    advance: u32,
}

// amplitude tanh(sin(phase) / smoothing); `held` is the amplitude of this step, zero before the onset.
struct Square {
    inverse_smoothing: f32,
    phase: u32,
    advance: u32,
    held: f32,
}

// The samples of noise are kept in the state, where each is needed once.
var<private> sines: array<Sine, max(N_SINES, 1u)>;
var<private> squares: array<Square, max(N_SQUARES, 1u)>;
// The constant disturbance.
var<private> constant: f32;
// Scale of the ground's reaction.
var<private> ground: f32;
// Sensor bias and noise of this step.
var<private> held_sensor: f32;
// What actuator faults leave of the command in this step, and what they add to it.
var<private> command_gain: f32;
var<private> command_bias: f32;
// d1 and f2 at the current stage's time.
var<private> disturbance: f32;
var<private> sensor_fault: f32;

// The value of switch number `k` of the channel at a step: zero before its onset.
fn switch_at(k: u32, step: u32) -> f32 {
    return select(0.0, drawn_number(SWITCHES + 2u * k + 1u), drawn(SWITCHES + 2u * k) <= step);
}

// The first step after `step` at which a switch of the channel turns on.
fn next_onset(step: u32) -> u32 {
    var next = NEVER;
    for (var k = 0u; k < N_SWITCHES; k++) {
        let onset = drawn(SWITCHES + 2u * k);
        next = select(next, min(next, onset), onset > step);
    }
    return next;
}

// Takes the signals from the draw, with their phases at the start of a step. Phases count in fixed point modulo one turn, so
// this is exactly the sum of as many half steps.
fn signals_begin(step: u32) {
    constant = drawn_number(CONSTANT);
    ground = drawn_number(GROUND);
    for (var k = 0u; k < N_SINES; k++) {
        let word = SINES + 3u * k;
        let advance = drawn(word + 2u);
        sines[k] = Sine(drawn_number(word), drawn(word + 1u) + 2u * step * advance, advance);
    }
    for (var k = 0u; k < N_SQUARES; k++) {
        let word = SQUARES + 3u * k;
        let advance = drawn(word + 2u);
        squares[k] = Square(drawn_number(word), drawn(word + 1u) + 2u * step * advance, advance, 0.0);
    }
}

// Sets what is held over step number `step`.
fn signals_hold(step: u32) {
    var gain = 1.0;
    for (var k = 0u; k < N_LOSSES; k++) {
        gain = gain * (1.0 - switch_at(LOSSES + k, step));
    }
    command_gain = gain;
    var bias = 0.0;
    for (var k = 0u; k < N_COMMAND_BIASES; k++) {
        bias = bias + switch_at(COMMAND_BIASES + k, step);
    }
    command_bias = bias;
    var sensor = 0.0;
    for (var k = 0u; k < N_SENSOR_BIASES; k++) {
        sensor = sensor + switch_at(SENSOR_BIASES + k, step);
    }
    for (var k = 0u; k < N_NOISES; k++) {
        if step % 4u == 0u {
            noise_draw(k, step / 4u);
        }
        let sample = stored_number(SAMPLES + 4u * k + step % 4u);
        sensor = fma(sample, switch_at(NOISES + k, step), sensor);
    }
    held_sensor = sensor;
    for (var k = 0u; k < N_SQUARES; k++) {
        squares[k].held = switch_at(SQUARE_SWITCHES + k, step);
    }
}

// Evaluates d1 and f2 at the phases of the signals, after moving them on by half a step if `advance`.
fn signals_evaluate(advance: bool) {
    disturbance = constant;
    sensor_fault = held_sensor;
    for (var k = 0u; k < N_SINES; k++) {
        if advance {
            sines[k].phase = sines[k].phase + sines[k].advance;
        }
        disturbance = fma(lane_turns_sin(sines[k].phase), sines[k].amplitude, disturbance);
    }
    for (var k = 0u; k < N_SQUARES; k++) {
        if advance {
            squares[k].phase = squares[k].phase + squares[k].advance;
        }
        let shape = tanh(lane_turns_sin(squares[k].phase) * squares[k].inverse_smoothing);
        sensor_fault = fma(shape, squares[k].held, sensor_fault);
    }
}

// Draws the four samples that block number `index` of a noise holds (Box and Muller's transform, twice).
fn noise_draw(k: u32, index: u32) {
    let member = own.agent * MEMBERS_PER_AGENT + setting.first_channel + own.channel;
    let address = Address(drawn(EPISODE), STREAM_NOISE, NOISE_ENTRIES[k], member, index);
    let words = address_words(address, setting.seed);
    noise_pair(SAMPLES + 4u * k, words.x, words.y);
    noise_pair(SAMPLES + 4u * k + 2u, words.z, words.w);
}

fn noise_pair(sample: u32, word: u32, turn: u32) {
    let radius = sqrt(lane_ln(lane_unit_from_words(word)) * -2.0);
    store_number(sample, radius * lane_turns_sin(turn));
    store_number(sample + 1u, radius * lane_turns_sin(turn + QUARTER_TURN));
}
