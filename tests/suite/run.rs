//! The directory of a run, and the search for parameters.

mod cma_es;
mod compare;
mod detail;
mod digests;
mod large_tables;
mod shards;
mod tune;
