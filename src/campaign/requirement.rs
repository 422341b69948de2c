//! `[[require]]`: what has to be proved of a run.

use super::measure::{Measure, Side};
use std::fmt;
use std::sync::Arc;

/// A condition on the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// Its place in the file; a table without channels stands for a requirement of each channel group.
    pub place: usize,
    /// The controller that has to meet it.
    pub controller: String,
    /// The controller that it is compared with on the same episodes, if it is.
    pub compared: Option<Compared>,
    /// The stratum in which it has to, or [`ALL`](super::ALL) episodes.
    pub stratum: Arc<str>,
    /// What is measured.
    pub measure: Measure,
    /// Which bound is limited: the upper one of what may be at most so much.
    pub side: Side,
    /// The limit of the one-sided 95 % bound.
    pub limit: f64,
}

/// How a number is compared with that of another controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Compared {
    /// The first over the other's.
    RatioTo(String),
    /// The first less the other's.
    DifferenceTo(String),
}

impl Compared {
    /// The other controller.
    #[must_use]
    pub fn other(&self) -> &str {
        match self {
            Self::RatioTo(other) | Self::DifferenceTo(other) => other,
        }
    }
}

impl Requirement {
    /// What is compared, in words: "rmse position p50, ratio to pid".
    #[must_use]
    pub fn quantity(&self) -> String {
        let measure = &self.measure;
        match &self.compared {
            None => measure.to_string(),
            Some(Compared::RatioTo(other)) => format!("{measure}, ratio to {other}"),
            Some(Compared::DifferenceTo(other)) => format!("{measure}, difference to {other}"),
        }
    }
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (quantity, side) = (self.quantity(), self.side.words());
        write!(f, "{quantity} of {} {side} {}", self.controller, self.limit)
    }
}
