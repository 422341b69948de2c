//! Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as
//! 1, 2, 3", SC 2011), addressed and never advanced. What an episode draws depends on (seed, episode, stream, entry,
//! member, index) alone: not on the batch, the thread, the backend or what was drawn before.

pub(crate) const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
pub(crate) const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
pub(crate) const ROUNDS: u32 = 10;

/// Four random words of a 128-bit counter under a 64-bit key.
#[inline(always)]
#[must_use]
pub fn philox4x32(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let [mut x0, mut x1, mut x2, mut x3] = counter;
    let [mut k0, mut k1] = key;
    for round in 0..ROUNDS {
        if round > 0 {
            k0 = k0.wrapping_add(WEYL[0]);
            k1 = k1.wrapping_add(WEYL[1]);
        }
        let (high0, low0) = wide_product(MULTIPLIERS[0], x0);
        let (high1, low1) = wide_product(MULTIPLIERS[1], x2);
        (x0, x1, x2, x3) = (high1 ^ x1 ^ k0, low1, high0 ^ x3 ^ k1, low0);
    }
    [x0, x1, x2, x3]
}

#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the two halves of a 64-bit product"
)]
pub(crate) fn wide_product(a: u32, b: u32) -> (u32, u32) {
    let product = u64::from(a) * u64::from(b);
    ((product >> 32) as u32, product as u32)
}

/// What a random number is for; the discriminant is part of its address and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stream {
    /// Initial errors, masses, inertias, coupling.
    Initial = 1,
    /// Parameters of the disturbances.
    Disturbance = 2,
    /// Occurrence, channel, onset and magnitude of the faults.
    Fault = 3,
    /// Sensor noise, sample by sample.
    Noise = 4,
    /// Which episodes a run is checked by.
    CrossCheck = 5,
    /// Where the points of a sampling design lie.
    Design = 6,
    /// Permutations of episodes in tests.
    Permutation = 7,
    /// Which slots of time a fault hits that is there now and then.
    Intermittent = 8,
    /// The noise that drives turbulence, step by step.
    Turbulence = 9,
    /// The candidates of a search.
    Search = 10,
    /// The seeds of episodes that are drawn beside a campaign's own.
    Seed = 11,
    /// The world of a mission: targets, obstacles, thresholds of detection, endurance.
    Mission = 12,
    /// The samples of a mission's path planner.
    Plan = 13,
}

/// Where a random number lives inside its campaign's seed.
#[derive(Clone, Copy, Debug)]
pub struct Address {
    /// Index of the episode.
    pub episode: u32,
    /// What the number is for.
    pub stream: Stream,
    /// Which disturbance, fault or quantity of the stream; below 2^24.
    pub entry: u32,
    /// Agent and channel, or 0 where all share the draw.
    pub member: u32,
    /// Which number: a parameter's index or, for noise, a step's.
    pub index: u32,
}

impl Address {
    /// The four random words at this address.
    #[inline(always)]
    #[must_use]
    pub fn words(self, seed: u64) -> [u32; 4] {
        let tag = (u32::from(self.stream as u8) << 24) | self.entry;
        philox4x32([self.index, tag, self.episode, self.member], key(seed))
    }

    /// A number in (0, 1) with 52 random bits.
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        reason = "52 bits and a half fit a double"
    )]
    pub fn unit(self, seed: u64) -> f64 {
        let [w0, w1, ..] = self.words(seed);
        let bits = (u64::from(w0) << 20) | u64::from(w1 >> 12);
        (bits as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
    }
}

/// The seed as Philox key words.
#[inline(always)]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the two halves of the seed"
)]
pub fn key(seed: u64) -> [u32; 2] {
    [seed as u32, (seed >> 32) as u32]
}

#[cfg(test)]
mod tests {
    use super::philox4x32;

    #[test]
    fn val_philox_gives_the_published_vectors() {
        // Known-answer vectors of the Random123 distribution (kat_vectors, philox4x32-10).
        let cases = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox4x32(counter, key), expected);
        }
    }
}
