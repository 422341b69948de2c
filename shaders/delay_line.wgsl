// Twin of src/model/exogenous/delay_line.rs: what a channel remembers of its commands and measurements. The samples of
// a ring lie in the state, those of all commands first; a ring of measurements has those of x, then those of x'.

// What a ring plays in this step: whether it does (1 or 0), and the past at the step's start and at its end. Commands
// use the first number only.
struct Past {
    plays: f32,
    start: vec2<f32>,
    end: vec2<f32>,
}

const START = 0u;
const MIDDLE = 1u;
const END = 2u;

// Those of commands, then those of measurements.
var<private> pasts: array<Past, max(N_COMMAND_RINGS + N_SENSOR_RINGS, 1u)>;

// Finds out whether the past is played in a step, and what it is at the step's start.
fn delay_line_hold(ring: u32, step: u32) {
    if step > 0u {
        pasts[ring].plays = window_weight(COMMAND_RINGS + ring, step);
        pasts[ring].start = delay_line_read(ring, step);
    }
}

// The past at a moment of the step where it is played, else `now`.
fn delay_line_recall(ring: u32, moment: u32, now: vec2<f32>) -> vec2<f32> {
    let start = pasts[ring].start;
    let end = pasts[ring].end;
    var past = start;
    if moment == MIDDLE {
        past = (start + end) * 0.5;
    }
    if moment == END {
        past = end;
    }
    return delay_line_or_past(ring, now, past);
}

// `past` where the past is played, else `now`.
fn delay_line_or_past(ring: u32, now: vec2<f32>, past: vec2<f32>) -> vec2<f32> {
    return select(now, past, pasts[ring].plays >= 0.5);
}

// Records what was seen at the start of a step, after which the past at its end is known.
fn delay_line_record(ring: u32, step: u32, now: vec2<f32>) {
    if RING_RECORDS[ring] || pasts[ring].plays < 0.5 {
        let place = delay_line_place(ring, step);
        store_number(place, now.x);
        if ring >= N_COMMAND_RINGS {
            store_number(place + RING_STEPS, now.y);
        }
    }
    pasts[ring].end = delay_line_read(ring, step + 1u);
}

// The sample that is as old as the ring is long; before there is one, the first.
fn delay_line_read(ring: u32, step: u32) -> vec2<f32> {
    let place = delay_line_place(ring, select(step, 0u, step < drawn(RINGS + ring)));
    if ring >= N_COMMAND_RINGS {
        return vec2(stored_number(place), stored_number(place + RING_STEPS));
    }
    return vec2(stored_number(place), 0.0);
}

fn delay_line_place(ring: u32, step: u32) -> u32 {
    let of_sensors = select(0u, ring - N_COMMAND_RINGS, ring >= N_COMMAND_RINGS);
    return RINGS_STORED + (ring + of_sensors) * RING_STEPS + step % drawn(RINGS + ring);
}
