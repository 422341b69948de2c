//! A whole run: gains, episodes, tables, statistics, files.
//!
#![doc = include_str!("README.md")]

mod begin;
pub mod compare;
mod conclusion;
pub mod directory;
pub mod error;
mod failure;
pub(crate) mod file_names;
mod findings;
mod flights;
pub mod integrity;
mod labels;
mod lock;
pub mod manifest;
mod merge;
pub mod output_file;
pub(crate) mod parts;
mod progress;
mod replacement;
pub mod replay;
pub mod replay_files;
mod replay_rows;
mod scores_of_run;
pub mod shard;
mod sink;
mod staging;
pub mod status;
mod table_file;
pub(crate) mod table_reader;
mod tables;
mod tabulation;
pub mod tune;

pub use begin::{Extras, GPU_CROSS_CHECK, ShardFlown, fly_shard, run, run_on};
pub use failure::RunError;
pub use findings::Findings;
pub use labels::Labels;
pub use merge::{MergeError, Merging, merge};
pub use parts::shards_of as shards_begun;
pub use progress::Progress;
