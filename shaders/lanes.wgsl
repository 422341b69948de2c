// Twin of src/model/lanes/scalar.rs: what the lane type f32 adds to the operators of WGSL. `mul_add` is the built-in
// fma.

// The larger value; `other` where either is NaN, which the built-in max does not promise.
fn lane_max(value: f32, other: f32) -> f32 {
    return select(other, value, value > other);
}

// The smaller value; `other` where either is NaN.
fn lane_min(value: f32, other: f32) -> f32 {
    return select(other, value, value < other);
}

// `yes` where left <= right, else `no` (so also where either is NaN).
fn lane_select_le(left: f32, right: f32, yes: f32, no: f32) -> f32 {
    return select(no, yes, left <= right);
}

// Whether |value| <= limit for a finite limit >= 0, told by the bits: a compiler may take it that no NaN exists.
fn lane_within(value: f32, limit: f32) -> bool {
    return (bitcast<u32>(value) & ~SIGN_BIT) <= bitcast<u32>(limit);
}

// The sine of a phase.
fn lane_turns_sin(phase: u32) -> f32 {
    // Doubling the phase modulo one turn folds both half waves onto one quarter-turn range around zero; the half
    // wave that was turned over is told by the top bit of the phase moved on by a quarter turn.
    let folded = f32(bitcast<i32>(phase << 1u)) * FOLD_SCALE;
    let sine = sin_folded(folded);
    return bitcast<f32>(bitcast<u32>(sine) ^ ((phase + QUARTER_TURN) & SIGN_BIT));
}

// A random word as a number in (0, 1), on the grid of odd multiples of 2^-24.
fn lane_unit_from_words(word: u32) -> f32 {
    return (f32(word >> 9u) + 0.5) * UNIT_SPACING;
}

// Natural logarithm of a positive normal number.
fn lane_ln(x: f32) -> f32 {
    let shifted = bitcast<u32>(x) - SQRT_HALF_BITS;
    let exponent = f32(bitcast<i32>(shifted) >> 23u);
    let mantissa = bitcast<f32>((shifted & MANTISSA_BITS) + SQRT_HALF_BITS);
    return ln_split(mantissa, exponent);
}
