//! The directory of a run.

mod digests;
