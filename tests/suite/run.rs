//! The directory of a run, and the search for parameters.

mod cma_es;
mod digests;
mod tune;
