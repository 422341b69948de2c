//! Lines of what is printed, and words that several of its parts use.

use crate::campaign::Campaign;
use crate::results::RateMethod;
use std::fmt::Write;

/// Adds a line.
pub(super) fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}

/// What the intervals of failure rates are.
pub(super) fn kind_of_interval(campaign: &Campaign) -> &'static str {
    match RateMethod::of(campaign) {
        RateMethod::Replicates => "t 95 %",
        RateMethod::Sequential => "sequential 95 %",
        RateMethod::Wilson => "Wilson 95 %",
    }
}
