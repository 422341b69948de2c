//! Inequality (24) on episodes, beside the level that is certified.
//!
//! `independent` simulates a linear channel with all twelve observer states by plain formulas and evaluates (24) from
//! the analytic derivatives of its faults; `episodes` looks at campaigns.

mod episodes;
mod independent;
