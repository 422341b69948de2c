// Twin of src/model/exogenous/window.rs: when a fault is there, and how much of it. Switches are counted through all
// lists of signals; a burst is a switch too, and has its own words beside.

// The share of switch number `k`'s value that is there at a step.
fn window_weight(k: u32, step: u32) -> f32 {
    let word = SWITCHES + 4u * k;
    let onset = drawn(word);
    let risen = lane_min(f32(step - onset + 1u) * drawn_number(word + 2u), 1.0);
    let begun = select(0.0, risen, onset <= step);
    return select(begun, 0.0, drawn(word + 1u) <= step);
}

fn window_value(k: u32) -> f32 {
    return drawn_number(SWITCHES + 4u * k + 3u);
}

// What is there at a step.
fn window_at(k: u32, step: u32) -> f32 {
    return window_weight(k, step) * window_value(k);
}

// The first step after `step` at which a switch of the channel turns on or off.
fn next_change(step: u32) -> u32 {
    var next = NEVER;
    for (var k = 0u; k < N_SWITCHES; k++) {
        let onset = drawn(SWITCHES + 4u * k);
        next = select(next, min(next, onset), onset > step);
        let end = drawn(SWITCHES + 4u * k + 1u);
        next = select(next, min(next, end), end > step);
    }
    return next;
}

// What is there of the value of switch number `k`, a burst, and 1 or -1 by the toss of a coin for each slot.
fn intermittent_window_at(k: u32, step: u32) -> vec2<f32> {
    let burst = k - INTERMITTENTS;
    // Before the onset the weight is zero, whatever the slot.
    let since = step - drawn(SWITCHES + 4u * k);
    let together = BURST_TOGETHER[burst];
    let channel = select(uniforms.first_channel + own.channel, 0u, together);
    let member = (FIRST_AGENT + own.agent) * MEMBERS_PER_AGENT + channel;
    let slot = since / drawn(BURSTS + 2u * burst);
    let address = Address(drawn(EPISODE), STREAM_INTERMITTENT, BURST_ENTRIES[burst], member, slot);
    let words = address_words(address, uniforms.seed);
    let hit = select(0.0, 1.0, words.x <= drawn(BURSTS + 2u * burst + 1u));
    let sign = select(1.0, -1.0, (words.y & 1u) == 1u);
    return vec2(hit * window_at(k, step), sign);
}
