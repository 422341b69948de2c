// Twin of wide_product in src/random/philox.rs, for devices without 64-bit integers.

// Both halves of a 64-bit product, from 16-bit limbs: (high, low).
fn wide_product(a: u32, b: u32) -> vec2<u32> {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let low = a_low * b_low;
    let first = a_high * b_low + (low >> 16u);
    let second = a_low * b_high + (first & 0xffffu);
    return vec2(a_high * b_high + (first >> 16u) + (second >> 16u), a * b);
}
