//! Every statistic of a run, against numbers worked out by hand.

mod comparison;
mod effect;
mod fairness;
mod ranking;
