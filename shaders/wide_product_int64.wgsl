// Twin of wide_product in src/random/philox.rs, for devices with 64-bit integers: the same bits by a third of the
// instructions.

// Both halves of a 64-bit product: (high, low).
fn wide_product(a: u32, b: u32) -> vec2<u32> {
    let product = u64(a) * u64(b);
    return vec2(u32(product >> 32u), u32(product));
}
