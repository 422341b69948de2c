//! How a campaign is to be simulated, and what it is simulated with.

use crate::backend::cpu::{Precision, Simd};
use crate::backend::gpu::{Gpu, GpuError, Tuning, Wanted};
use rayon::ThreadPool;
use thiserror::Error;

/// Where the episodes are to be simulated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Backend {
    /// On a hardware GPU if there is one, else, and if it fails, on the CPU.
    Auto,
    /// On a GPU only: the best hardware one, or that of a name.
    Gpu {
        /// Part of the adapter's name; software adapters are taken only by name.
        adapter: Option<String>,
    },
    /// On the CPU.
    Cpu,
}

/// How a campaign is to be simulated.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Where.
    pub backend: Backend,
    /// Number format of the episode loop; double precision is simulated on the CPU.
    pub precision: Precision,
    /// Layout of the CPU's single-precision episodes; the widest of this processor if not given.
    pub simd: Option<Simd>,
    /// Threads; all cores if zero.
    pub threads: usize,
    /// How a GPU's work is cut up.
    pub tuning: Tuning,
}

impl RunOptions {
    /// On the CPU, with all its cores and the widest lanes.
    #[must_use]
    pub fn cpu(precision: Precision) -> Self {
        Self {
            backend: Backend::Cpu,
            precision,
            simd: None,
            threads: 0,
            tuning: Tuning::default(),
        }
    }
}

/// Why nothing could be simulated.
#[derive(Debug, Error)]
pub enum SimulationError {
    /// No threads.
    #[error("--threads {threads}: the threads cannot be started ({source}); use fewer")]
    Threads {
        /// As many as were asked for.
        threads: usize,
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
    /// No GPU, though one was asked for.
    #[error(transparent)]
    NoGpu(GpuError),
    /// The GPU failed before it had finished a batch.
    #[error("{0}; use --backend cpu")]
    Gpu(GpuError),
}

/// The device to use, if any, and what there is to know about the choice.
///
/// # Errors
/// If a GPU is asked for and is not to be had.
pub fn open(options: &RunOptions) -> Result<(Option<Gpu>, Vec<String>), SimulationError> {
    let opened = match &options.backend {
        Backend::Cpu => return Ok((None, Vec::new())),
        Backend::Gpu { adapter: None } => {
            Gpu::open(Wanted::Hardware).map_err(SimulationError::NoGpu)?
        }
        Backend::Gpu {
            adapter: Some(name),
        } => Gpu::open(Wanted::Named(name)).map_err(SimulationError::NoGpu)?,
        // Double precision, or a layout of lanes, says that the CPU is meant.
        Backend::Auto if options.precision == Precision::F64 || options.simd.is_some() => {
            return Ok((None, Vec::new()));
        }
        Backend::Auto => match Gpu::open(Wanted::Hardware) {
            Ok(gpu) => gpu,
            Err(GpuError::NoHardware { .. }) => return Ok((None, Vec::new())),
            Err(error) => {
                return Ok((
                    None,
                    vec![format!("the CPU simulated all episodes: {error}")],
                ));
            }
        },
    };
    Ok((Some(opened), Vec::new()))
}

/// The threads that are asked for.
///
/// # Errors
/// If they cannot be started.
pub fn threads(options: &RunOptions) -> Result<ThreadPool, SimulationError> {
    let threads = options.threads;
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let failed = |source| SimulationError::Threads { threads, source };
    builder.build().map_err(failed)
}
