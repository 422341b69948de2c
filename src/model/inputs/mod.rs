//! From draws to what acts on an agent: the numbers of the episode loop, in its precision and lanes.

mod block;
mod changes;
mod channel;
mod disturbance;
mod fault;

pub(crate) use block::{LaneBlock, Selection};
pub(crate) use changes::{changes, later_onsets};
pub(crate) use channel::ChannelInputs;
