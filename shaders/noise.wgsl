// Twin of src/model/exogenous/noise.rs: what is random in every step. Samples and states are kept in the state, where
// each is needed once.

// Two independent normal numbers from two random words (Box and Muller's transform).
fn normal_pair(word: u32, turn: u32) -> vec2<f32> {
    let radius = sqrt(lane_ln(lane_unit_from_words(word)) * -2.0);
    return vec2(radius * lane_turns_sin(turn), radius * lane_turns_sin(turn + QUARTER_TURN));
}

fn own_member() -> u32 {
    return (FIRST_AGENT + own.agent) * MEMBERS_PER_AGENT + uniforms.first_channel + own.channel;
}

// Draws the four samples that block number `index` of a noise holds.
fn noise_draw(k: u32, index: u32) {
    let address = Address(drawn(EPISODE), STREAM_NOISE, NOISE_ENTRIES[k], own_member(), index);
    let words = address_words(address, uniforms.seed);
    let first = normal_pair(words.x, words.y);
    let second = normal_pair(words.z, words.w);
    store_number(SAMPLES + 4u * k, first.x);
    store_number(SAMPLES + 4u * k + 1u, first.y);
    store_number(SAMPLES + 4u * k + 2u, second.x);
    store_number(SAMPLES + 4u * k + 3u, second.y);
}

// Number `number` of the filter of turbulence `k`: keep, cross, noise (three), output (two), states at the start (two).
fn turbulence_filter(k: u32, number: u32) -> f32 {
    return drawn_number(TURBULENCES + 9u * k + number);
}

// The force of turbulence `k` in this step.
fn turbulence_force(k: u32) -> f32 {
    let z1 = stored_number(TURBULENCE_STATE + 2u * k);
    let z2 = stored_number(TURBULENCE_STATE + 2u * k + 1u);
    return fma(z1, turbulence_filter(k, 5u), z2 * turbulence_filter(k, 6u));
}

// Moves turbulence `k` from a step to the next.
fn turbulence_advance(k: u32, step: u32) {
    let address = Address(drawn(EPISODE), STREAM_TURBULENCE, TURBULENCE_ENTRIES[k], own_member(), step);
    let words = address_words(address, uniforms.seed);
    let pair = normal_pair(words.x, words.y);
    let z1 = stored_number(TURBULENCE_STATE + 2u * k);
    let z2 = stored_number(TURBULENCE_STATE + 2u * k + 1u);
    let pushed = fma(pair.x, turbulence_filter(k, 3u), pair.y * turbulence_filter(k, 4u));
    let carried = fma(z1, turbulence_filter(k, 1u), pushed);
    store_number(TURBULENCE_STATE + 2u * k, fma(z1, turbulence_filter(k, 0u), pair.x * turbulence_filter(k, 2u)));
    store_number(TURBULENCE_STATE + 2u * k + 1u, fma(z2, turbulence_filter(k, 0u), carried));
}
