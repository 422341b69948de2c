// Twin of src/model/metric.rs: what is kept of an episode, per channel; no trajectory is stored.

// Sums over steps.
struct Sums {
    square: f32,
    absolute: f32,
    effort: f32,
    actuator_fault: f32,
    sensor_fault: f32,
    limited: f32,
}

// Largest sizes.
struct Extremes {
    error: f32,
    command: f32,
    rate: f32,
}

// Of the steps since the last flush: short sums keep the digits of single precision. The sums of the steps before are
// in the state buffer, where they are needed once per FLUSH_STEPS.
var<private> recent: Sums;
var<private> largest: Extremes;
// The last step with |e| above the settled error; -1 if there is none.
var<private> outside: i32;
// The same, up to the agent's first fault.
var<private> outside_before_fault: i32;

// What the channel shows at the start of a step.
struct Sample {
    error: f32,
    error_rate: f32,
    command: f32,
    excess: f32,
    // f1hat - f1.
    actuator_fault_error: f32,
    // f2hat - f2.
    sensor_fault_error: f32,
}

// Takes the metrics from where the last span left them.
fn metrics_resume() {
    outside = bitcast<i32>(stored(OUTSIDE));
    outside_before_fault = bitcast<i32>(stored(OUTSIDE_BEFORE_FAULT));
    largest = Extremes(
        stored_number(LARGEST),
        stored_number(LARGEST + 1u),
        stored_number(LARGEST + 2u),
    );
    recent = Sums(
        stored_number(RECENT),
        stored_number(RECENT + 1u),
        stored_number(RECENT + 2u),
        stored_number(RECENT + 3u),
        stored_number(RECENT + 4u),
        stored_number(RECENT + 5u),
    );
}

// Leaves the metrics for the next span.
fn metrics_keep() {
    store(OUTSIDE, bitcast<u32>(outside));
    store(OUTSIDE_BEFORE_FAULT, bitcast<u32>(outside_before_fault));
    store_number(LARGEST, largest.error);
    store_number(LARGEST + 1u, largest.command);
    store_number(LARGEST + 2u, largest.rate);
    store_number(RECENT, recent.square);
    store_number(RECENT + 1u, recent.absolute);
    store_number(RECENT + 2u, recent.effort);
    store_number(RECENT + 3u, recent.actuator_fault);
    store_number(RECENT + 4u, recent.sensor_fault);
    store_number(RECENT + 5u, recent.limited);
}

// Takes in a sample at step `now`; `settled` from settle_s on.
fn metrics_take(sample: Sample, settled: bool, settled_error: f32, now: i32) {
    let size = abs(sample.error);
    outside = select(now, outside, lane_within(size, settled_error));
    largest.command = lane_max(largest.command, abs(sample.command));
    recent.effort = fma(sample.command, sample.command, recent.effort);
    if LIMITED {
        recent.limited = recent.limited + lane_select_le(abs(sample.excess), 0.0, 0.0, 1.0);
    }
    if settled {
        largest.error = lane_max(largest.error, size);
        largest.rate = lane_max(largest.rate, abs(sample.error_rate));
        recent.square = fma(size, size, recent.square);
        recent.absolute = recent.absolute + size;
        let first = sample.actuator_fault_error;
        let second = sample.sensor_fault_error;
        recent.actuator_fault = fma(first, first, recent.actuator_fault);
        recent.sensor_fault = fma(second, second, recent.sensor_fault);
    }
}

// Moves the recent sums to the totals.
fn metrics_flush() {
    add_to_total(0u, recent.square);
    add_to_total(1u, recent.absolute);
    add_to_total(2u, recent.effort);
    add_to_total(3u, recent.actuator_fault);
    add_to_total(4u, recent.sensor_fault);
    add_to_total(5u, recent.limited);
    recent = Sums(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
}

fn add_to_total(k: u32, sum: f32) {
    store_number(TOTALS + k, stored_number(TOTALS + k) + sum);
}

// Remembers, if the agent's first fault is at `step` or later, how the error stood until then.
fn metrics_before_fault(first_fault: u32, step: u32) {
    outside_before_fault = select(outside_before_fault, outside, step <= first_fault);
}
