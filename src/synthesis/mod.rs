//! Controller synthesis: from the weights of a channel to gains that are
//! proved to attenuate faults, and the proof.
//!
//! Flow: [`ChannelDesign`] -> Riccati equations ([`feedback_riccati`],
//! [`observer_riccati`]) -> the same optima from the matrix inequalities (31) and
//! (32) in the coordinates of those solutions -> poles, margins and the certificate
//! (27) of the result ([`verify`]) -> [`ChannelSynthesis`].
//!
//! Nothing here falls back silently: [`synthesize`] returns gains that passed
//! every check, or an error that says which step failed and what to change.
//!
#![doc = include_str!("README.md")]

mod certificate;
mod channel;
mod closed_loop;
mod design;
mod error;
mod feedback;
mod full_order;
mod gains;
pub mod lapack;
mod linalg;
mod lmi;
mod margins;
mod observer;
mod pid_shape;
mod placed;
mod preset;
mod responses;
mod riccati;
mod smoothing;
mod verify;

pub use certificate::{Certificate, RELAXATION};
pub use channel::{Channel, ERROR_STATES, augmented_channel, error_channel, reduced_channel};
pub use design::{ChannelDesign, MAX_WINDOW, geometric_q2};
pub use error::{Step, SynthesisError};
pub use feedback::{RiccatiGain, feedback_riccati};
pub use full_order::{
    Confirmation, FullOrderCertificate, FullOrderGains, FullOrderSynthesis,
    MOST_CONFIRMED_CHANNELS, MOST_CONFIRMED_STATES, Sensor, SensorChanges, SensorError, SensorRow,
    Sensors, Solver, synthesize_full_order,
};
pub use gains::{
    ControllerGains, LOOP_STATES, LoopGains, loop_gains, pid_gains, pid_robust_observer_gains,
    poles,
};
pub use margins::Margins;
pub use observer::observer_riccati;
pub use pid_shape::PidShape;
pub use placed::{PLACED_RAD_S, placed_gains, poles_for_delay_margin};
pub use preset::Preset;
pub use responses::{Response, responses, settling_s};
pub use smoothing::{Smoothing, SmoothingRule};
pub use verify::{Check, LoopAnalysis, Verified, verify};

use feedback::feedback_lmi;
use linalg::max_abs;
use lmi::Optimum;
use nalgebra::DMatrix;
use observer::observer_lmi;
use serde::{Deserialize, Serialize};
use verify::{analyse, require, verify_with_report};

/// Largest difference between the gains of the inequalities and of the
/// Riccati equations, relative to the largest entry: a thousand times what the solver's tolerance explains.
pub const AGREEMENT_LIMIT: f64 = 1e-3;

/// Controllers of one channel type, what is known about them, and how they came about.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSynthesis {
    /// What was asked for.
    pub design: ChannelDesign,
    /// The fault-tolerant controller from the matrix inequalities: these gains are used.
    pub ftc: ControllerGains,
    /// The same from the Riccati equations, for comparison.
    pub ftc_riccati: ControllerGains,
    /// The paper's PID with a plain observer.
    pub pid: ControllerGains,
    /// The paper's PID with an observer that distrusts the faulty velocity.
    pub pid_robust_observer: ControllerGains,
    /// The certified attenuation level of the fault-tolerant controller.
    pub certificate: Certificate,
    /// Poles and margins of the three controllers.
    pub analysis: Analyses,
    /// Every check of the fault-tolerant controller; all passed.
    pub checks: Vec<Check>,
    /// How the solver ended on each inequality.
    pub solver: Vec<SolverReport>,
    /// Time the solver took on each inequality, s; not part of any result.
    #[serde(skip)]
    pub solve_times_s: Vec<f64>,
}

/// Poles and margins of the controllers of one channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Analyses {
    /// Of the fault-tolerant controller.
    pub ftc: LoopAnalysis,
    /// Of the PID.
    pub pid: LoopAnalysis,
    /// Of the PID with the robust observer.
    pub pid_robust_observer: LoopAnalysis,
}

/// How the semidefinite solver ended on one inequality.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverReport {
    /// Which inequality: the step it belongs to.
    pub step: Step,
    /// Clarabel's status: `Solved`, or `AlmostSolved` where only the checks vouch for the result.
    pub status: String,
    /// Interior-point iterations.
    pub iterations: u32,
}

/// Designs, checks and certifies the controllers of one channel type.
///
/// # Errors
/// An invalid design, an infeasible step with the smallest feasible rho, or a
/// check that does not hold. Deterministic: the same design gives the same bits.
pub fn synthesize(design: &ChannelDesign) -> Result<ChannelSynthesis, SynthesisError> {
    design.validate()?;
    let riccati_k = feedback_riccati(design)?;
    let riccati_l = observer_riccati(design, &riccati_k.gain)?;
    let (k, feedback_optimum) = feedback_lmi(design, &riccati_k)?;
    let (l, observer_optimum) = observer_lmi(design, &k, &riccati_l)?;
    let mut checks = vec![
        agreement(Step::Feedback, &k, &riccati_k.gain)?,
        agreement(Step::Observer, &l, &riccati_l.gain)?,
    ];

    let ftc = ControllerGains::from_matrices(&k, &l);
    let (verified, certificate_optimum) = verify_with_report(design, &ftc)?;
    let (Some(certificate), Some(certificate_optimum)) =
        (verified.certificate, certificate_optimum)
    else {
        return Err(SynthesisError::Unsupported(
            "a design with no fault states has no certificate".into(),
        ));
    };
    checks.extend(verified.checks);

    let pid = pid_gains(design)?;
    let pid_robust_observer = pid_robust_observer_gains(design)?;
    let optima = [
        (Step::Feedback, feedback_optimum),
        (Step::Observer, observer_optimum),
        (Step::Certificate, certificate_optimum),
    ];
    Ok(ChannelSynthesis {
        design: design.clone(),
        analysis: Analyses {
            ftc: verified.analysis,
            pid: verify(design, &pid)?.analysis,
            pid_robust_observer: verify(design, &pid_robust_observer)?.analysis,
        },
        ftc,
        ftc_riccati: ControllerGains::from_matrices(&riccati_k.gain, &riccati_l.gain),
        pid,
        pid_robust_observer,
        certificate,
        checks,
        solve_times_s: optima.iter().map(|(_, o)| o.solve_time_s).collect(),
        solver: optima.map(report).into(),
    })
}

/// The fault-tolerant controller of a design from the Riccati equations alone, with its poles and margins: the optimum
/// that the inequalities of [`synthesize`] share, a hundred times as fast, without their confirmation and certificate.
///
/// # Errors
/// An invalid design, an infeasible step with the smallest feasible rho, or a pole that is not stable.
pub fn synthesize_by_riccati(
    design: &ChannelDesign,
) -> Result<(ControllerGains, Verified), SynthesisError> {
    design.validate()?;
    let k = feedback_riccati(design)?.gain;
    let l = observer_riccati(design, &k)?.gain;
    let gains = ControllerGains::from_matrices(&k, &l);
    let (analysis, checks) = analyse(design, &gains)?;
    let verified = Verified {
        analysis,
        certificate: None,
        checks,
    };
    Ok((gains, verified))
}

/// Refuses a gain of the inequalities that is not the one of the Riccati equations.
fn agreement(
    step: Step,
    lmi: &DMatrix<f64>,
    riccati: &DMatrix<f64>,
) -> Result<Check, SynthesisError> {
    require(
        step,
        "largest difference to the Riccati gain, relative to the largest entry".into(),
        max_abs(&(lmi - riccati)) / max_abs(riccati),
        AGREEMENT_LIMIT,
        "the solver did not reach the optimum; use weights with less extreme ratios",
    )
}

fn report((step, optimum): (Step, Optimum)) -> SolverReport {
    SolverReport {
        step,
        status: format!("{:?}", optimum.status),
        iterations: optimum.iterations,
    }
}
