//! The GPU backend: batches of episodes through the compute shaders of `shaders/`, single precision. This folder alone
//! names wgpu.
//!
#![doc = include_str!("../../../shaders/README.md")]

mod adapter;
mod batch;
mod buffers;
mod device;
mod instant;
mod iterations;
pub(crate) mod layout;
mod packer;
mod pipeline;
pub(crate) mod shape;
pub(crate) mod signals;
mod source;
mod times;
mod tuning;
pub(crate) mod uniforms;
mod unrolling;

#[cfg(test)]
#[path = "../../../tests/probes/mod.rs"]
mod probes;

pub use adapter::{Adapter, AdapterKind, AdapterReport, Wanted, adapters};
pub use batch::GpuSimulator;
pub use device::Gpu;
pub use packer::{LandedBatch, PackedBatch, Packer};
pub use times::GpuTimes;
pub use tuning::Tuning;
#[doc(hidden)]
pub use unrolling::unrolled;

use crate::util::suggest::did_you_mean;
use thiserror::Error;

/// Why a GPU cannot simulate episodes, or cannot go on.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum GpuError {
    /// There is no hardware GPU.
    #[error(
        "no hardware GPU found ({}); use --backend cpu, or name a software adapter with --adapter",
        listed(found)
    )]
    NoHardware {
        /// Names of the adapters that there are.
        found: Vec<String>,
    },
    /// No adapter has this name.
    #[error(
        "--adapter {name}: no adapter of this name ({}); {}",
        listed(found),
        named_nearly(name, found)
    )]
    NoSuchAdapter {
        /// The name.
        name: String,
        /// Names of the adapters that there are.
        found: Vec<String>,
    },
    /// An adapter that there was is not here, or has another driver.
    #[error("{name} with the driver {driver} is not here")]
    Gone {
        /// The adapter.
        name: String,
        /// Its driver.
        driver: String,
    },
    /// The adapter gives no device.
    #[error("{adapter}: the driver gives no device ({reason})")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The campaign does not fit the adapter.
    #[error("{adapter}: {what} needs {needed}, the adapter's limit is {limit}")]
    TooLarge {
        /// The adapter.
        adapter: String,
        /// What is too large.
        what: &'static str,
        /// How much it needs.
        needed: u64,
        /// How much there is.
        limit: u64,
    },
    /// The driver refuses the shaders.
    #[error("{adapter}: the shaders do not compile ({reason}); please report this")]
    Shader {
        /// The adapter.
        adapter: String,
        /// What the compiler says.
        reason: String,
    },
    /// Not even one block of episodes fits the device's memory.
    #[error("{adapter}: out of memory with buffers of {bytes} bytes for {episodes} episodes")]
    OutOfMemory {
        /// The adapter.
        adapter: String,
        /// What was asked for, bytes.
        bytes: u64,
        /// Episodes that it was for.
        episodes: usize,
    },
    /// The device went away.
    #[error("{adapter}: the device was lost ({reason})")]
    Lost {
        /// The adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// Something that should not happen.
    #[error("{adapter}: the driver reports an error ({reason}); please report this")]
    Driver {
        /// The adapter.
        adapter: String,
        /// What it says.
        reason: String,
    },
}

/// What to do about an unknown name: a part of a name is enough, so the nearest word is looked for.
fn named_nearly(name: &str, found: &[String]) -> String {
    let words = found.iter().flat_map(|name| name.split_whitespace());
    did_you_mean(
        &name.to_lowercase(),
        words,
        "`urts-mc devices` explains them",
    )
}

fn listed(names: &[String]) -> String {
    if names.is_empty() {
        "no adapter at all".to_string()
    } else {
        format!("there is {}", names.join(", "))
    }
}
