//! The model on many episodes: the same bits however they are shared out, and the shaders against the CPU.

mod determinism;
mod gpu;
