//! How the free parameters of a controller are searched: what is to be small, within which limits, at which expense.

use super::measure::{Measure, Side};
use std::fmt;

/// `[tune]`
#[derive(Debug, Clone, PartialEq)]
pub struct Tune {
    /// What is to be small: the sum of these, at least one.
    pub objective: Vec<Term>,
    /// What has to hold.
    pub limits: Vec<Limit>,
    /// How many candidates are tried, at most.
    pub budget: u32,
    /// Episodes under which each candidate is tried.
    pub episodes: u32,
    /// Fresh episodes under which the result is confirmed.
    pub confirmation: u32,
}

/// A summand of what is to be small.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What is measured.
    pub measure: Measure,
    /// By how much it counts, in the unit of the measure: its weight over its limit.
    pub factor: f64,
}

/// What has to hold of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// What is measured.
    pub measure: Measure,
    /// On which side of the bound it has to be.
    pub side: Side,
    /// The bound.
    pub bound: Bound,
}

/// A bound.
#[derive(Debug, Clone, PartialEq)]
pub enum Bound {
    /// This number.
    Number(f64),
    /// What is measured of this controller, under the same episodes.
    Of(String),
}

impl Tune {
    /// The controllers whose measures are bounds, each once.
    #[must_use]
    pub fn references(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for limit in &self.limits {
            if let Bound::Of(name) = &limit.bound
                && !names.contains(name)
            {
                names.push(name.clone());
            }
        }
        names
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = match self.side {
            Side::AtMost => "<=",
            Side::AtLeast => ">=",
        };
        write!(f, "{} {side} ", self.measure)?;
        match &self.bound {
            Bound::Number(number) => write!(f, "{number}"),
            Bound::Of(name) => write!(f, "that of {name}"),
        }
    }
}
