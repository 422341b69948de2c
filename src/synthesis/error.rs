//! Why a synthesis failed and what to change.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why no gains were returned.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SynthesisError {
    /// A design parameter is outside its range.
    #[error("{key} = {value} must be {limit}")]
    InvalidDesign {
        /// Name of the parameter, an index appended for lists.
        key: String,
        /// What was given.
        value: f64,
        /// The range it must lie in.
        limit: String,
    },
    /// A list has the wrong length.
    #[error("{key} has {given} values but needs {needed}: {why}")]
    WrongLength {
        /// Name of the list.
        key: String,
        /// Values given.
        given: usize,
        /// Values needed.
        needed: usize,
        /// Where the needed length comes from.
        why: &'static str,
    },
    /// The smoothing model does not decay.
    #[error(
        "the smoothing model has the eigenvalue {eigenvalue} 1/s, which does not decay, and no \
         gain can stabilise fault states; use a leak above 0 1/s, or weights whose model decays"
    )]
    UnstableSmoothing {
        /// The eigenvalue with the largest real part, 1/s.
        eigenvalue: Complex<f64>,
    },
    /// The matrix inequality of a step has no solution at the requested attenuation level.
    #[error("{step} has no solution at rho = {rho}: {}", infeasible_remedy(*smallest_rho, remedy))]
    Infeasible {
        /// Which step.
        step: Step,
        /// The attenuation level asked for.
        rho: f64,
        /// The smallest level that has a solution, where one exists at all.
        smallest_rho: Option<f64>,
        /// What besides rho could be changed.
        remedy: &'static str,
    },
    /// The semidefinite solver stopped without a usable solution.
    #[error(
        "{step}: the semidefinite solver ended with {status} after {iterations} iterations \
         although a solution exists; use weights (or gains) with less extreme ratios"
    )]
    SolverFailed {
        /// Which step.
        step: Step,
        /// Clarabel's status.
        status: String,
        /// Iterations it made.
        iterations: u32,
    },
    /// A check that does not depend on the solver failed.
    #[error("{step}: {name} is {value:.3e} but must be below {limit}; {remedy}")]
    CheckFailed {
        /// Which step.
        step: Step,
        /// What was checked.
        name: String,
        /// What was found.
        value: f64,
        /// What it must be below.
        limit: f64,
        /// What could be changed.
        remedy: &'static str,
    },
    /// Gains that the episode loop cannot integrate.
    #[error("{0}")]
    Unsupported(String),
    /// A numerical routine did not converge.
    #[error("{step}: {what} did not converge; check the weights for extreme ratios")]
    NotConverged {
        /// Which step.
        step: Step,
        /// Which computation.
        what: &'static str,
    },
}

/// The stages of a synthesis, as errors and reports name them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// Feedback gain K, inequality (31).
    Feedback,
    /// Observer gain L, inequality (32).
    Observer,
    /// The H-infinity certificate (27) of given gains.
    Certificate,
    /// The baseline PID.
    Pid,
}

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Feedback => "step 1 (feedback gain)",
            Self::Observer => "step 2 (observer gain)",
            Self::Certificate => "certificate",
            Self::Pid => "PID baseline",
        })
    }
}

fn infeasible_remedy(smallest_rho: Option<f64>, remedy: &str) -> String {
    match smallest_rho {
        Some(rho) => format!(
            "the smallest feasible rho is {}; raise rho, or {remedy}",
            rounded_up(rho)
        ),
        None => format!("no rho makes it feasible; {remedy}"),
    }
}

/// `x` rounded up to four significant digits: still feasible when typed in.
fn rounded_up(x: f64) -> f64 {
    let unit = 10.0_f64.powf(x.log10().floor() - 3.0);
    // Divide by a whole number where possible, so that the result prints short.
    if unit < 1.0 {
        (x / unit).ceil() / unit.recip().round()
    } else {
        (x / unit).ceil() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_rho_is_printed_on_the_feasible_side() {
        assert_eq!(rounded_up(1.314_213).to_string(), "1.315");
        assert_eq!(rounded_up(29.1706).to_string(), "29.18");
        assert_eq!(rounded_up(0.012_341).to_string(), "0.01235");
        assert_eq!(rounded_up(123_456.0).to_string(), "123500");
    }
}
