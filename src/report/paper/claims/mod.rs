//! The claims of Section V, sentence by sentence, and what the episodes say about them.

mod baseline;
mod errors;
mod found;
mod groups;
mod jumps;
mod list;
mod signals;

pub use found::Claim;
pub use list::claims;
