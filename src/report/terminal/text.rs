//! Lines of what is printed, and words that several of its parts use.

use crate::campaign::Campaign;
use std::fmt::Write;

/// Adds a line.
pub(super) fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}

/// What the intervals of failure rates are.
pub(super) fn kind_of_interval(campaign: &Campaign) -> &'static str {
    if campaign.sampling.replicates().is_some() {
        "t 95 %"
    } else if campaign.stop.is_some() {
        "sequential 95 %"
    } else {
        "Wilson 95 %"
    }
}
