//! Statistics of a campaign: what the verdicts and metrics of its episodes say about the controllers.
//!
//! The sample unit is the episode, and the episodes are independent draws ([`random`](crate::random)
//! says what other designs allow); every function here is pure and deterministic, and the only
//! random numbers, permutations, are addressed by a seed. A diverged episode carries a metric of `+inf`
//! (it ranks worst), so ranks decide wherever a mean would not survive it. No function returns
//! NaN: where nothing can be said the answer is `None` or the widest interval.
//!
//! | question | function | method |
//! |---|---|---|
//! | how often does a controller fail? | [`wilson`], [`clopper_pearson`] | score and exact binomial |
//! | what can be claimed about its failure rate? | [`clopper_pearson_upper`] | exact one-sided bound |
//! | how bad is its 95th percentile? | [`quantile()`], [`quantile_interval`], [`quantile_upper`] | order statistics |
//! | does A fail less often than B? | [`mcnemar_mid_p`], [`paired_difference`] | mid-p, Tango's score |
//! | by how much do two independent samples differ? | [`independent_difference`] | MOVER, Newcombe |
//! | by how much is A's metric better? | [`median_bca`] | BCa with the ideal bootstrap |
//! | in which share of episodes is A better? | [`win_rate`] | Tango's score |
//! | how many runs does a claim need? | [`runs_needed`], [`failures_allowed`], [`power`] | exact binomial |
//! | may a run stop as soon as it is proved? | [`sequential_proof`], [`sequential_interval`] | confidence sequence |
//! | which parameter matters? | [`effects`], [`spearman`], [`somers_d`] | ranks, permutations |
//! | which of many effects are real? | [`holm`] | Holm's step-down |
//! | how large are numbers of either sign? | [`root_mean_square()`] | exact for equal sizes |
//! | what do replicates of a design say? | [`replicate_mean`], [`replicate_p`] | Student's t |
//!
//! Counts beyond their total are read as the total. A `level` is a two-sided confidence level in
//! (0, 1) unless a function says otherwise; any other level is a demand for certainty, which only
//! the widest interval (or `None`) meets.
//!
#![doc = include_str!("README.md")]

mod arrangement;
mod binomial;
mod correlation;
mod difference;
mod effect;
mod holm;
mod interval;
mod median;
mod normal;
mod paired;
mod permutation;
mod proportion;
mod quantile;
mod rank;
mod replicates;
mod root_mean_square;
mod sample_size;
mod search;
mod sequential;
mod student;

pub use correlation::{somers_d, spearman};
pub use difference::independent_difference;
pub use effect::{Effect, Outcome, effects};
pub use holm::holm;
pub use interval::{Estimate, Interval, LEVEL, SIGNIFICANCE};
pub use median::median_bca;
pub(crate) use normal::normal_quantile;
pub use paired::{PairedFailures, alike_needed, mcnemar_mid_p, paired_difference, win_rate};
pub use permutation::Permutations;
pub use proportion::{clopper_pearson, clopper_pearson_upper, wilson};
pub use quantile::{quantile, quantile_interval, quantile_lower, quantile_upper};
pub use rank::Ranked;
pub use replicates::{replicate_mean, replicate_p};
pub use root_mean_square::{rms, root_mean_square};
pub use sample_size::{failures_allowed, power, runs_needed};
pub use sequential::{
    Proof, sequential_interval, sequential_lower, sequential_proof, sequential_runs_needed,
    sequential_upper,
};
