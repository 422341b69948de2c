// Twin of src/random/philox.rs: Philox4x32-10, addressed by (seed, episode, stream, entry, member, index).

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

// Four random words of a 128-bit counter under a 64-bit key.
fn philox4x32(counter: vec4<u32>, key: vec2<u32>) -> vec4<u32> {
    var x = counter;
    var k = key;
    for (var round = 0u; round < ROUNDS; round++) {
        if round > 0u {
            k += WEYL;
        }
        let product0 = wide_product(MULTIPLIERS.x, x.x);
        let product1 = wide_product(MULTIPLIERS.y, x.z);
        x = vec4(product1.x ^ x.y ^ k.x, product1.y, product0.x ^ x.w ^ k.y, product0.y);
    }
    return x;
}

struct Address {
    episode: u32,
    stream: u32,
    entry: u32,
    member: u32,
    index: u32,
}

// The four random words at this address.
fn address_words(address: Address, seed: vec2<u32>) -> vec4<u32> {
    let tag = (address.stream << 24u) | address.entry;
    return philox4x32(vec4(address.index, tag, address.episode, address.member), seed);
}
