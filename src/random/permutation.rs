//! A random permutation of 0..n that is computed at any place, without a table.

/// Rounds of the network: four would be enough for a few points of a large domain (Luby and Rackoff
/// 1988, SIAM Journal on Computing 17:373-386); here all points of a small one are used.
const ROUNDS: u32 = 8;
/// Smallest domain, in bits: networks over 3 or 4 make some orders of a few numbers more likely than
/// others.
const FEWEST_BITS: u32 = 8;

/// Where `index` goes under a permutation of `0..n`; `index` must be below `n`.
///
/// An alternating Feistel network permutes the smallest power of two that is not below n, with
/// `random(round, half)` as its round function; what falls outside 0..n goes through the network
/// again until it comes back in (cycle walking; Black and Rogaway 2002, "Ciphers with arbitrary
/// finite domains"). That takes less than two passes on average from n = 129 on.
pub(super) fn permuted(index: u32, n: u32, random: impl Fn(u32, u32) -> u32) -> u32 {
    if n <= 1 {
        return 0;
    }
    let bits = bits_of(n).max(FEWEST_BITS);
    let (high_bits, low_bits) = (bits / 2, bits - bits / 2);
    let (high_mask, low_mask) = ((1 << high_bits) - 1, (1 << low_bits) - 1);
    let mut place = index;
    loop {
        let (mut high, mut low) = (place >> low_bits, place & low_mask);
        for round in 0..ROUNDS {
            if round % 2 == 0 {
                high ^= random(round, low) & high_mask;
            } else {
                low ^= random(round, high) & low_mask;
            }
        }
        place = (high << low_bits) | low;
        if place < n {
            return place;
        }
    }
}

/// Bits of the numbers 0..n.
pub(super) fn bits_of(n: u32) -> u32 {
    u32::BITS - n.saturating_sub(1).leading_zeros()
}
