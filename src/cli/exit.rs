//! How the program ends: exit codes, and what is said of an error.

use quick_junit::SerializeError;
use std::error::Error;
use std::process;
use urts_mc::backend::gpu::GpuError;
use urts_mc::campaign::CampaignError;
use urts_mc::controllers::GainsError;
use urts_mc::report::ReportError;
use urts_mc::report::paper::PaperError;
use urts_mc::run::compare::CompareError;
use urts_mc::run::error::OutputError;
use urts_mc::run::replay::ReplayError;
use urts_mc::run::status::StatusError;
use urts_mc::run::tune::TuneError;
use urts_mc::run::{MergeError, RunError};
use urts_mc::simulation::SimulationError;
use urts_mc::synthesis::SynthesisError;

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    Done = 0,
    Other = 1,
    Usage = 2,
    Synthesis = 3,
    Unmet = 4,
    Partial = 5,
}

impl From<Code> for process::ExitCode {
    fn from(code: Code) -> Self {
        Self::from(code as u8)
    }
}

/// What an error of the library means for the program.
pub(crate) trait Ends: Error {
    /// The exit code.
    fn code(&self) -> Code;

    /// What kept files from being written or read, if it is that.
    fn output(&self) -> Option<&OutputError> {
        None
    }
}

impl Ends for OutputError {
    fn code(&self) -> Code {
        if self.is_usage() {
            Code::Usage
        } else {
            Code::Other
        }
    }

    fn output(&self) -> Option<&OutputError> {
        Some(self)
    }
}

impl Ends for CampaignError {
    fn code(&self) -> Code {
        Code::Usage
    }
}

impl Ends for SynthesisError {
    fn code(&self) -> Code {
        Code::Synthesis
    }
}

impl Ends for GainsError {
    fn code(&self) -> Code {
        if self.is_usage() {
            Code::Usage
        } else {
            Code::Synthesis
        }
    }
}

impl Ends for SimulationError {
    fn code(&self) -> Code {
        match self {
            Self::Threads { .. }
            | Self::NoGpu(GpuError::NoHardware { .. } | GpuError::NoSuchAdapter { .. }) => {
                Code::Usage
            }
            Self::NoGpu(_) | Self::Gpu(_) => Code::Other,
        }
    }
}

impl Ends for RunError {
    fn code(&self) -> Code {
        match self {
            Self::Gains(error) => error.code(),
            Self::Campaign(error) => error.code(),
            Self::Output(error) => error.code(),
            Self::Simulation(error) => error.code(),
            Self::Partial { .. } => Code::Partial,
            Self::Interrupted { .. } | Self::Stuck { .. } | Self::Manifest(_) => Code::Other,
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Output(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for MergeError {
    fn code(&self) -> Code {
        match self {
            Self::Output(error) => error.code(),
            Self::Campaign(error) => error.code(),
            Self::Run(error) => error.code(),
            Self::Simulation(error) => error.code(),
            Self::Nothing { .. } | Self::Differ { .. } | Self::Mixed { .. } => Code::Usage,
            Self::Gaps { .. } => Code::Partial,
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Output(error) => Some(error),
            Self::Run(error) => error.output(),
            _ => None,
        }
    }
}

impl Ends for StatusError {
    fn code(&self) -> Code {
        match self {
            Self::Output(error) => error.code(),
            Self::Campaign(error) => error.code(),
        }
    }
}

impl Ends for TuneError {
    fn code(&self) -> Code {
        match self {
            Self::Campaign(error) => error.code(),
            Self::Gains(error) => error.code(),
            Self::Output(error) => error.code(),
            Self::Simulation(error) => error.code(),
            Self::NoneFlies { .. } => Code::Synthesis,
            Self::Json(error) => error.code(),
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Output(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for CompareError {
    fn code(&self) -> Code {
        match self {
            Self::Run(error) => error.code(),
            Self::Campaign(error) => error.code(),
            Self::Gains(error) => error.code(),
            Self::Differ { .. } | Self::Detail { .. } | Self::Usage { .. } => Code::Usage,
            Self::Json(error) => error.code(),
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Run(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for ReplayError {
    fn code(&self) -> Code {
        match self {
            Self::Run(error) => error.code(),
            Self::Gains(error) => error.code(),
            Self::Campaign(_) | Self::Usage { .. } => Code::Usage,
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Run(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for ReportError {
    fn code(&self) -> Code {
        match self {
            Self::Run(error) => error.code(),
            Self::Campaign(error) => error.code(),
            Self::Gains(error) => error.code(),
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Run(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for PaperError {
    fn code(&self) -> Code {
        match self {
            Self::Output(error) => error.code(),
            Self::Gains(error) => error.code(),
            // Its campaigns are part of the program: no other input would help.
            Self::Campaign(_) | Self::Unsuited { .. } => Code::Other,
        }
    }

    fn output(&self) -> Option<&OutputError> {
        match self {
            Self::Output(error) => Some(error),
            _ => None,
        }
    }
}

impl Ends for SerializeError {
    fn code(&self) -> Code {
        Code::Other
    }
}

impl Ends for serde_json::Error {
    fn code(&self) -> Code {
        Code::Other
    }
}

/// An error and the exit code that it means.
#[derive(Debug)]
pub(crate) struct Failure {
    /// What went wrong.
    pub(crate) message: String,
    /// How the program ends.
    pub(crate) code: Code,
    /// Whether it is a place that cannot be written, for which only the command knows another.
    unwritable: bool,
}

impl<E: Ends> From<E> for Failure {
    fn from(error: E) -> Self {
        Self {
            code: error.code(),
            unwritable: matches!(error.output(), Some(OutputError::Unwritable { .. })),
            message: said_once(&error),
        }
    }
}

impl Failure {
    pub(crate) fn new(code: Code, message: String) -> Self {
        Self {
            message,
            code,
            unwritable: false,
        }
    }

    pub(crate) fn usage(message: String) -> Self {
        Self::new(Code::Usage, message)
    }

    /// The same, with what to do if it is a place that cannot be written.
    pub(crate) fn of_place(self, remedy: &str) -> Self {
        if !self.unwritable {
            return self;
        }
        Self::new(self.code, format!("{}; {remedy}", self.message))
    }
}

/// An error and its causes, each once: some errors quote their cause, others leave it to whoever reports them.
fn said_once(error: &dyn Error) -> String {
    let mut said = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let text = cause.to_string();
        if !said.contains(&text) {
            said = format!("{said}: {text}");
        }
        next = cause.source();
    }
    said
}
