//! Where the time of a GPU's work went.

use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::Sub;

/// Wall-clock times of a simulation on a GPU, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GpuTimes {
    /// Shaders to machine code.
    pub compile_s: f64,
    /// Sending draws.
    pub upload_s: f64,
    /// The episode loop.
    pub kernel_s: f64,
    /// Receiving outcomes.
    pub read_back_s: f64,
}

impl Sum for GpuTimes {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, own| Self {
            compile_s: sum.compile_s + own.compile_s,
            upload_s: sum.upload_s + own.upload_s,
            kernel_s: sum.kernel_s + own.kernel_s,
            read_back_s: sum.read_back_s + own.read_back_s,
        })
    }
}

impl Sub for GpuTimes {
    type Output = Self;

    fn sub(self, earlier: Self) -> Self {
        Self {
            compile_s: self.compile_s - earlier.compile_s,
            upload_s: self.upload_s - earlier.upload_s,
            kernel_s: self.kernel_s - earlier.kernel_s,
            read_back_s: self.read_back_s - earlier.read_back_s,
        }
    }
}
