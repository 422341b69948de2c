//! Options that several commands have: the campaign with what is laid over it, and what simulates it.

use clap::{Args, ValueEnum};
use std::path::PathBuf;
use urts_mc::campaign::Setting;

#[derive(Debug, Args)]
pub(crate) struct Overrides {
    /// The campaign file
    pub(crate) campaign: PathBuf,
    /// Simulate this many episodes instead of the campaign's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) episodes: Option<u32>,
    /// Use this seed instead of the campaign's
    #[arg(long, allow_negative_numbers = true, value_parser = seed)]
    pub(crate) seed: Option<u64>,
    /// Set a key of the campaign, as its error messages name it, to a TOML
    /// value; without a value, remove it. Repeatable
    #[arg(long, value_name = "KEY=VALUE", verbatim_doc_comment)]
    pub(crate) set: Vec<Setting>,
}

/// A seed.
fn seed(text: &str) -> Result<u64, String> {
    let limit = |_| format!("must be a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(limit)
}

#[derive(Debug, Args)]
pub(crate) struct EngineArguments {
    /// Where to simulate: auto takes a hardware GPU if there is one,
    /// and the CPU otherwise
    #[arg(long, value_enum, default_value = "auto", verbatim_doc_comment)]
    pub(crate) backend: BackendChoice,
    /// Use the GPU whose name contains this, or that of this number in
    /// urts-mc devices; the only way to a software one
    #[arg(long, value_name = "NAME", verbatim_doc_comment)]
    pub(crate) adapter: Option<String>,
    /// Number format of the episode loop; f64 is the reference,
    /// on the CPU
    #[arg(
        long,
        value_enum,
        default_value = "f32",
        value_name = "FORMAT",
        verbatim_doc_comment
    )]
    pub(crate) precision: PrecisionChoice,
    /// Layout of the CPU's episodes; all give the same result in f64, in f32
    /// avx2 and avx512
    /// do
    #[arg(
        long,
        value_enum,
        default_value = "auto",
        value_name = "LANES",
        verbatim_doc_comment
    )]
    pub(crate) simd: SimdChoice,
    /// Threads; 0 takes all cores. The result is the same
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(..=1024))]
    pub(crate) threads: u16,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PrecisionChoice {
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SimdChoice {
    Auto,
    Scalar,
    Avx2,
    Avx512,
}
