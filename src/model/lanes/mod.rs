//! The number type of the episode loop: one episode per lane.
//!
//! Every formula of [`crate::model`] is written once, generic over [`Lane`]: `f64` is the reference, `f32` the scalar
//! twin of the GPU, the blocks of `simd` integrate 8 or 16 episodes at once, and those of `double` 4 or 8 in double
//! precision. Branches on data become
//! [`Lane::select_le`]; fused multiply-add is a property of the lane type, because a scalar `mul_add` without hardware
//! support is a library call.

#[cfg(target_arch = "x86_64")]
pub mod double;
mod lane;
pub(crate) mod math;
pub(crate) mod math_double;
mod scalar;
#[cfg(target_arch = "x86_64")]
pub mod simd;

pub use lane::{Kernel, Lane, MAX_WIDTH, Real};
