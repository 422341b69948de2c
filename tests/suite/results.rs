//! Every statistic of a run, against numbers worked out by hand.

mod comparison;
mod fairness;
mod ranking;
