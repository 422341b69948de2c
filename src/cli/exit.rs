//! How the program ends: exit codes, and what is said of an error.

use std::process;
use urts_mc::backend::gpu::GpuError;
use urts_mc::controllers::GainsError;
use urts_mc::report::ReportError;
use urts_mc::report::paper::PaperError;
use urts_mc::run::RunError;
use urts_mc::run::error::OutputError;
use urts_mc::run::replay::ReplayError;
use urts_mc::simulation::SimulationError;

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    Done = 0,
    Other = 1,
    Usage = 2,
    Synthesis = 3,
    Unmet = 4,
}

impl From<Code> for process::ExitCode {
    fn from(code: Code) -> Self {
        Self::from(code as u8)
    }
}

/// An error and the exit code that it means.
#[derive(Debug)]
pub(crate) struct Failure {
    /// What went wrong.
    pub(crate) error: anyhow::Error,
    /// How the program ends.
    pub(crate) code: Code,
    /// Whether it is a place that cannot be written, for which only the command knows another.
    unwritable: bool,
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        Self {
            code: code_of(&error),
            unwritable: matches!(output_of(&error), Some(OutputError::Unwritable { .. })),
            error: anyhow::Error::msg(said_once(&error)),
        }
    }
}

impl Failure {
    pub(crate) fn new(code: Code, message: String) -> Self {
        Self {
            error: anyhow::Error::msg(message),
            code,
            unwritable: false,
        }
    }

    pub(crate) fn usage(message: String) -> Self {
        Self::new(Code::Usage, message)
    }

    /// The same with another exit code.
    pub(crate) fn coded(self, code: Code) -> Self {
        Self { code, ..self }
    }

    /// The same, with what to do if it is a place that cannot be written.
    pub(crate) fn of_place(self, remedy: &str) -> Self {
        if !self.unwritable {
            return self;
        }
        Self::new(self.code, format!("{}; {remedy}", self.error))
    }
}

/// An error and its causes, each once: some errors quote their cause, others leave it to whoever reports them.
fn said_once(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .reduce(|said, cause| {
            if said.contains(&cause) {
                said
            } else {
                format!("{said}: {cause}")
            }
        })
        .unwrap_or_default()
}

fn code_of(error: &anyhow::Error) -> Code {
    let of_gains = |error: &GainsError| {
        if error.is_usage() {
            Code::Usage
        } else {
            Code::Synthesis
        }
    };
    let of_report = |error: &ReportError| match error {
        ReportError::Run(_) => Code::Other,
        ReportError::Campaign(_) => Code::Usage,
        ReportError::Gains(error) => of_gains(error),
    };
    if let Some(error) = output_of(error) {
        return if error.is_usage() {
            Code::Usage
        } else {
            Code::Other
        };
    }
    if error.is::<urts_mc::campaign::CampaignError>() {
        return Code::Usage;
    }
    match error.downcast_ref() {
        Some(RunError::Gains(error)) => return of_gains(error),
        Some(RunError::Simulation(error)) => return of_simulation(error),
        _ => {}
    }
    match error.downcast_ref() {
        Some(ReplayError::Gains(error)) => return of_gains(error),
        Some(ReplayError::Campaign(_) | ReplayError::Usage { .. }) => return Code::Usage,
        _ => {}
    }
    match error.downcast_ref() {
        Some(PaperError::Gains(error)) => return of_gains(error),
        // Its campaigns are part of the program: no other input would help.
        Some(PaperError::Campaign(_) | PaperError::Unsuited { .. }) => return Code::Other,
        _ => {}
    }
    if let Some(error) = error.downcast_ref() {
        return of_report(error);
    }
    error.downcast_ref().map_or(Code::Other, of_gains)
}

/// What kept files from being written or read, whichever command it was.
fn output_of(error: &anyhow::Error) -> Option<&OutputError> {
    fn of_report(error: &ReportError) -> Option<&OutputError> {
        match error {
            ReportError::Run(error) => Some(error),
            _ => None,
        }
    }
    if let Some(RunError::Output(error)) = error.downcast_ref() {
        return Some(error);
    }
    if let Some(ReplayError::Run(error)) = error.downcast_ref() {
        return Some(error);
    }
    if let Some(PaperError::Output(error)) = error.downcast_ref() {
        return Some(error);
    }
    if let Some(error) = error.downcast_ref() {
        return of_report(error);
    }
    error.downcast_ref()
}

fn of_simulation(error: &SimulationError) -> Code {
    match error {
        SimulationError::Threads { .. } => Code::Usage,
        SimulationError::NoGpu(GpuError::NoHardware { .. } | GpuError::NoSuchAdapter { .. }) => {
            Code::Usage
        }
        SimulationError::NoGpu(_) => Code::Other,
        SimulationError::Gpu(_) => Code::Other,
    }
}
