//! The episodes of a run in parts, which outlive the process that flew them: each holds how the episodes of a fixed
//! range ended, is written whole, and says under a hash whose it is. What was drawn is not in it: it is drawn again.

mod file;
mod folder;
mod gather;
mod plan;
mod record;
mod store;
mod writer;

pub use folder::shards_of;
pub(crate) use folder::{Resume, pilot_of, plan_of, was_left};
pub(crate) use plan::Plan;
pub(crate) use record::Outcomes;
pub(crate) use store::Parts;
pub(crate) use writer::Writer;
