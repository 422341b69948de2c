//! Campaign files: those that are shipped, and settings laid over them.

mod overlay;
mod shipped;
