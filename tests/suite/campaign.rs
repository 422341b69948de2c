//! Campaign files: those that are shipped, and settings laid over them.

mod chance;
mod overlay;
mod shipped;
