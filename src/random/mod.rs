//! Random numbers by address ([`philox`]), and designs: how the numbers of a campaign's episodes lie in the unit cube.
//!
//! Every design is a pure function of (seed, dimension, episode), addressed by the counters of
//! [`philox`] as the independent numbers are ([`Address::unit`]): nothing is stored
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

mod design;
mod latin_hypercube;
mod permutation;
pub mod philox;
mod purpose;
mod sobol;

pub(crate) use design::MOST_ENTRIES;
pub use design::{Design, Method, allows};
pub use latin_hypercube::latin_hypercube;
pub use sobol::sobol;
