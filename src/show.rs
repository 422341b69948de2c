//! What the commands print.

mod attenuation;
mod caveats;
mod conclusion;
mod devices;
mod findings;
mod findings_json;
mod gains;
mod plan;
mod replay;
mod runs;
mod screening;
mod style;

pub(crate) use devices::devices;
pub(crate) use findings::findings;
pub(crate) use findings_json::findings_json;
pub(crate) use gains::{gains, synthesis};
pub(crate) use plan::{plan, plan_json};
pub(crate) use replay::{replay, replay_json};
pub(crate) use runs::{runs, runs_json};
pub(crate) use style::BAD;

use std::fmt::Write;
use std::path::Path;
use urts_mc::output::REPORTS;

/// Where the report of a run is.
pub(crate) fn report(dir: &Path) -> String {
    format!("the report: {}\n", dir.join(REPORTS[0]).display())
}

fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}
