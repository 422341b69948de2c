//! Designs: how the random numbers of a campaign's episodes lie in the unit cube.
//!
//! Every design is a pure function of (seed, dimension, episode), addressed by the counters of
//! [`rng`](philox) as the independent numbers are ([`Address::unit`]): nothing is stored
//! and nothing depends on the order of asking. A dimension is one random quantity of an episode, by
//! any number that the caller gives it; all numbers lie strictly between 0 and 1.
//!
//! | design | numbers of one dimension | gains |
//! |---|---|---|
//! | independent ([`Address::unit`]) | independent and uniform | all statistics |
//! | [`latin_hypercube`] | each of the n strata of width 1/n once | an outcome's additive part free of most error |
//! | [`sobol`] | an Owen-scrambled net, in groups of four dimensions | that too, and interactions within a group |
//!
//! **What may be concluded.** In a stratified design the episodes are not independent, and the
//! statistics that count on it are wrong: too cautious mostly, but not provably. [`allows`] is this
//! table:
//!
//! | statistic | independent | Latin hypercube | Sobol |
//! |---|---|---|---|
//! | rates, means, quantiles as estimates | yes | yes | yes |
//! | binomial and sequential bounds, order statistics, BCa, paired tests, intervals of effects | yes | no | no |
//! | permutation tests of effects | yes | yes, within one hypercube | no |
//! | Student's t over replicates ([`replicate_mean`](crate::statistics::replicate_mean)) | yes | yes | yes |
//!
//! The estimates of a Latin hypercube have at most n / (n - 1) times the variance of independent
//! ones, those of a scrambled net at most a constant times it (Owen 1997, SIAM Journal on Numerical
//! Analysis 34:1884-1910). Permutation tests stay exact in one hypercube because each dimension is
//! permuted on its own: without an effect, its order is as random against the outcome as that of
//! independent numbers. Replicates, be they hypercubes or scramblings, are independent of each
//! other; five or more of them give an interval.
//!
//! A hypercube belongs to its n: the first episodes of a larger one are others. Sobol points and
//! independent numbers do not depend on the number of episodes.
//!
//! [`Address::unit`]: philox::Address::unit

mod latin_hypercube;
mod permutation;
pub mod philox;
mod sobol;

pub use latin_hypercube::latin_hypercube;
pub use sobol::sobol;

/// Disturbances, or faults, that the dimensions of a design can tell apart.
pub(crate) const MOST_ENTRIES: usize = 1 << 11;

/// How the random numbers of the episodes are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Independent numbers.
    Independent,
    /// One or several Latin hypercubes.
    LatinHypercube,
    /// One or several scramblings of a Sobol sequence.
    Sobol,
}

impl Design {
    /// All designs.
    pub const ALL: [Self; 3] = [Self::Independent, Self::LatinHypercube, Self::Sobol];

    /// What its replicates are called.
    #[must_use]
    pub fn replicates_noun(self) -> &'static str {
        match self {
            Self::Independent => "independent draws",
            Self::LatinHypercube => "Latin hypercubes",
            Self::Sobol => "scrambled Sobol nets",
        }
    }
}

/// Kinds of statistics, by what they take for granted of the episodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Failure rates, means and quantiles of all episodes, without an interval.
    Estimate,
    /// Intervals and bounds of a failure rate, sequential ones too, and the number of runs they
    /// need.
    FailureRate,
    /// Intervals of quantiles and medians.
    Quantile,
    /// Paired tests, differences and win rates of two controllers, episode by episode.
    Paired,
    /// Intervals of rank correlations.
    EffectInterval,
    /// Permutation tests of effects.
    EffectTest,
    /// Student's t over the estimates of replicates.
    Replicates,
}

impl Method {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Estimate,
        Self::FailureRate,
        Self::Quantile,
        Self::Paired,
        Self::EffectInterval,
        Self::EffectTest,
        Self::Replicates,
    ];
}

/// Whether a statistic keeps what it promises for the episodes of a design; the reasons are at the
/// head of this module. Effect tests of Latin hypercubes: within one of them.
#[must_use]
pub fn allows(design: Design, method: Method) -> bool {
    match design {
        Design::Independent => true,
        Design::LatinHypercube => matches!(
            method,
            Method::Estimate | Method::EffectTest | Method::Replicates
        ),
        Design::Sobol => matches!(method, Method::Estimate | Method::Replicates),
    }
}

/// What an address of the stream [`Design`](philox::Stream::Design) is for: the entry of
/// an address, rounds and levels added to it. The numbers never change.
#[derive(Clone, Copy)]
#[repr(u32)]
enum Purpose {
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
