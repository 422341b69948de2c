//! The equations of an episode, against formulas and programs that know nothing of it.

mod biped;
mod faults;
mod integration;
mod lanes;
mod leg;
mod metrics;
mod scenarios;
