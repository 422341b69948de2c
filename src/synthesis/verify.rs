//! What can be said about gains without the solver that produced them: poles,
//! margins and the certificate.

use super::certificate::{Certificate, RELAXATION, certify};
use super::channel::{ERROR_STATES, augmented_channel, error_channel, reduced_channel};
use super::design::ChannelDesign;
use super::error::{Step, SynthesisError};
use super::gains::ControllerGains;
use super::linalg::eigenvalues;
use super::lmi::Optimum;
use super::margins::{Margins, margins};
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// A number that had to stay below a limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Which step of the synthesis it belongs to.
    pub step: Step,
    /// What was measured.
    pub name: String,
    /// What was found.
    pub value: f64,
    /// What it had to be below.
    pub limit: f64,
    /// Whether it was.
    pub passed: bool,
}

/// Poles and margins of one controller on one channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopAnalysis {
    /// Eigenvalues [re, im] of Abar + Bbar K, 1/s.
    pub controller_poles: Vec<[f64; 2]>,
    /// Eigenvalues [re, im] of Abar + L Cbar, 1/s.
    pub observer_poles: Vec<[f64; 2]>,
    /// Stability margins, loop broken at the plant input.
    pub margins: Margins,
}

/// What was established about given gains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Verified {
    /// Poles and margins.
    pub analysis: LoopAnalysis,
    /// The certified level; none for a PID, whose observer does not estimate the faults that (24) weighs.
    pub certificate: Option<Certificate>,
    /// Every check that was made; all passed.
    pub checks: Vec<Check>,
}

/// Checks gains of either shape against a design: stable poles, and for the
/// fault-tolerant controller the certificate (27).
///
/// # Errors
/// The first check that does not hold, or a shape that does not fit the design.
pub fn verify(design: &ChannelDesign, gains: &ControllerGains) -> Result<Verified, SynthesisError> {
    design.validate()?;
    verify_with_report(design, gains).map(|(verified, _)| verified)
}

/// [`verify`] with the solver's report on the certificate.
pub(super) fn verify_with_report(
    design: &ChannelDesign,
    gains: &ControllerGains,
) -> Result<(Verified, Option<Optimum>), SynthesisError> {
    let (analysis, mut checks) = analyse(design, gains)?;
    if gains.is_pid() {
        let verified = Verified {
            analysis,
            certificate: None,
            checks,
        };
        return Ok((verified, None));
    }
    let (certificate, optimum) = certify(design, gains)?;
    checks.push(require(
        Step::Certificate,
        format!("largest eigenvalue of (27) at {RELAXATION} rho"),
        certificate.max_eigenvalue,
        0.0,
        "use weights (or gains) with less extreme ratios",
    )?);
    checks.push(require(
        Step::Certificate,
        "true H-infinity norm over certified rho".into(),
        certificate.hinf_norm / certificate.rho,
        NORM_RATIO_LIMIT,
        "use weights (or gains) with less extreme ratios",
    )?);
    let verified = Verified {
        analysis,
        certificate: Some(certificate),
        checks,
    };
    Ok((verified, Some(optimum)))
}

/// No level below the norm can be certified; the excess is what the solver's tolerance may give away.
const NORM_RATIO_LIMIT: f64 = 1.0 + 1e-6;

/// Poles, which must be stable, and margins.
pub(super) fn analyse(
    design: &ChannelDesign,
    gains: &ControllerGains,
) -> Result<(LoopAnalysis, Vec<Check>), SynthesisError> {
    let pid = gains.is_pid();
    gains.require_states(if pid { ERROR_STATES } else { design.states() })?;
    let channel = if pid {
        error_channel()
    } else {
        augmented_channel(design)
    };
    let unsolved = |step| SynthesisError::NotConverged {
        step,
        what: "a pole",
    };
    let controller = controller_poles(design, gains).ok_or(unsolved(Step::Feedback))?;
    let observer = observer_poles(design, gains).ok_or(unsolved(Step::Observer))?;
    let checks = vec![
        require(
            Step::Feedback,
            "largest real part of a pole of A + B K".into(),
            largest_real_part(&controller),
            0.0,
            "change k: the feedback does not stabilise the channel",
        )?,
        require(
            Step::Observer,
            "largest real part of a pole of A + L C".into(),
            largest_real_part(&observer),
            0.0,
            "change l: the observer does not converge",
        )?,
    ];
    let analysis = LoopAnalysis {
        controller_poles: pairs(&controller),
        observer_poles: pairs(&observer),
        margins: margins(&channel, gains).ok_or(SynthesisError::NotConverged {
            step: Step::Feedback,
            what: "the search for a gain crossover",
        })?,
    };
    Ok((analysis, checks))
}

/// Eigenvalues of Abar + Bbar K: of the controlled error and of the smoothing models, which K cannot move.
fn controller_poles(design: &ChannelDesign, gains: &ControllerGains) -> Option<Vec<Complex<f64>>> {
    let error = error_channel();
    let k = DMatrix::from_row_slice(1, ERROR_STATES, &gains.k[..ERROR_STATES]);
    let mut poles = eigenvalues(&(error.a + error.b * k))?;
    if !gains.is_pid() {
        for taps in design.smoothing.taps() {
            poles.extend(design.smoothing.eigenvalues(taps)?);
        }
    }
    Some(sorted(poles))
}

/// Eigenvalues of Abar + L Cbar: of the reduced observer and of the delay
/// lines, which are split off because their multiple eigenvalue cannot be computed well.
fn observer_poles(design: &ChannelDesign, gains: &ControllerGains) -> Option<Vec<Complex<f64>>> {
    if gains.is_pid() {
        let error = error_channel();
        return Some(sorted(eigenvalues(
            &(error.a + gains.l_matrix() * error.c),
        )?));
    }
    let [taps1, _] = design.smoothing.taps();
    let active = design.smoothing.active_taps();
    let f2 = ERROR_STATES + taps1;
    let kept: Vec<usize> = (0..ERROR_STATES + active).chain(f2..f2 + active).collect();
    let channel = reduced_channel(design);
    let l = gains.l_matrix().select_rows(&kept);
    let mut poles = eigenvalues(&(channel.a + l * channel.c))?;
    let delay = Complex::new(-design.smoothing.spacing_s.recip(), 0.0);
    poles.resize(design.states(), delay);
    Some(sorted(poles))
}

fn sorted(mut poles: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    poles.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    poles
}

fn largest_real_part(poles: &[Complex<f64>]) -> f64 {
    poles
        .iter()
        .fold(f64::NEG_INFINITY, |m, pole| m.max(pole.re))
}

fn pairs(poles: &[Complex<f64>]) -> Vec<[f64; 2]> {
    poles.iter().map(|pole| [pole.re, pole.im]).collect()
}

/// A check that must hold: `value` below `limit`.
pub(super) fn require(
    step: Step,
    name: String,
    value: f64,
    limit: f64,
    remedy: &'static str,
) -> Result<Check, SynthesisError> {
    if value < limit {
        return Ok(Check {
            step,
            name,
            value,
            limit,
            passed: true,
        });
    }
    Err(SynthesisError::CheckFailed {
        step,
        name,
        value,
        limit,
        remedy,
    })
}
