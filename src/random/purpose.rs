//! What the addresses of a design's random numbers are for.

/// What an address of the stream [`Design`](super::philox::Stream::Design) is for: the entry of
/// an address, rounds and levels added to it. The numbers never change.
#[derive(Clone, Copy)]
#[repr(u32)]
pub(super) enum Purpose {
    /// The order of a hypercube's strata, by round.
    Strata = 0x100,
    /// Where in its stratum a point lies.
    Place = 0x200,
    /// The order of a Sobol sequence, by level.
    Shuffle = 0x300,
    /// The scrambling of its digits, by level.
    Scramble = 0x400,
    /// The digits below the last scrambled one.
    Tail = 0x500,
}
