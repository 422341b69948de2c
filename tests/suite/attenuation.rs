//! The theorem beside the experiment: inequality (24) on flights.
//!
//! `independent` flies a linear channel with all twelve observer states by plain formulas and evaluates (24) from the
//! analytic derivatives of its faults; `flights` looks at campaigns.

mod flights;
mod independent;
