// Twin of src/random/philox.rs: Philox4x32-10, addressed by (seed, episode, stream, entry, member, index). The product
// on which it builds is in wide_product.wgsl or, where the device has 64-bit integers, wide_product_int64.wgsl.

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
