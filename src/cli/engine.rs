//! Where and how episodes are to be simulated.

use super::exit::Failure;
use super::options::{BackendChoice, EngineArguments, PrecisionChoice, SimdChoice};
use urts_mc::backend::cpu::{Precision, Simd};
use urts_mc::backend::gpu::Tuning;
use urts_mc::simulation::{Backend, RunOptions};

impl EngineArguments {
    /// The options; options that contradict each other, or that this processor lacks, are refused.
    pub(super) fn options(&self) -> Result<RunOptions, Failure> {
        let options = self.options_anywhere()?;
        if let Some(simd) = options.simd.filter(|simd| !simd.is_available()) {
            let name = format!("{simd:?}").to_lowercase();
            return Err(Failure::usage(format!(
                "--simd {name}: this processor lacks it; use auto"
            )));
        }
        Ok(options)
    }

    /// The same, for any machine.
    pub(super) fn options_anywhere(&self) -> Result<RunOptions, Failure> {
        let precision = match self.precision {
            PrecisionChoice::F32 => Precision::F32,
            PrecisionChoice::F64 => Precision::F64,
        };
        let simd = match self.simd {
            SimdChoice::Auto => None,
            SimdChoice::Scalar => Some(Simd::Scalar),
            SimdChoice::Avx2 => Some(Simd::Avx2),
            SimdChoice::Avx512 => Some(Simd::Avx512),
        };
        if self
            .adapter
            .as_ref()
            .is_some_and(|name| name.trim().is_empty())
        {
            return Err(Failure::usage(
                "--adapter \"\": an empty name is part of every name; give a part of one, or a number of urts-mc devices"
                    .into(),
            ));
        }
        let backend = match (self.backend, &self.adapter) {
            (BackendChoice::Gpu, adapter) => Backend::Gpu {
                adapter: adapter.clone(),
            },
            (_, Some(name)) => {
                return Err(Failure::usage(format!(
                    "--adapter {name}: only a GPU has adapters; add --backend gpu"
                )));
            }
            (BackendChoice::Auto, None) => Backend::Auto,
            (BackendChoice::Cpu, None) => Backend::Cpu,
        };
        if self.backend == BackendChoice::Gpu && precision == Precision::F64 {
            return Err(Failure::usage(
                "--precision f64: the shaders are in single precision; use --backend cpu".into(),
            ));
        }
        if self.backend == BackendChoice::Gpu && simd.is_some() {
            return Err(Failure::usage(
                "--simd: lays out the episodes of the CPU; use --backend cpu".into(),
            ));
        }
        Ok(RunOptions {
            backend,
            precision,
            simd,
            threads: usize::from(self.threads),
            tuning: Tuning::default(),
        })
    }
}

/// The options of work on so many threads of the CPU, all cores if it is none.
pub(super) fn of_threads(threads: u16) -> RunOptions {
    RunOptions {
        threads: usize::from(threads),
        ..RunOptions::cpu(Precision::F32)
    }
}
