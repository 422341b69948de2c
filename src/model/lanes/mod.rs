//! The number type of the episode loop: one episode per lane.
//!
//! Every formula of [`crate::model`] is written once, generic over [`Lane`]: `f64` is the reference, `f32` the scalar
//! twin of the GPU, and the blocks of `simd` integrate 8 or 16 episodes at once. Branches on data become
//! [`Lane::select_le`]; fused multiply-add is a property of the lane type, because a scalar `mul_add` without hardware
//! support is a library call.

mod lane;
pub(crate) mod math;
mod scalar;
#[cfg(target_arch = "x86_64")]
pub mod simd;

pub use lane::{Kernel, Lane, MAX_WIDTH, Real};
