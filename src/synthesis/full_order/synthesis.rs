//! From the weights of a channel and the sensors of all to gains that are proved to attenuate faults.

use super::abscissa::spectral_abscissa;
use super::certificate::FullOrderCertificate;
use super::coupled::CoupledChannels;
use super::doubling::{Solution, stabilising_solution};
use super::inequality::observer_inequality;
use super::sensors::Sensors;
use crate::synthesis::design::ChannelDesign;
use crate::synthesis::error::{Step, SynthesisError};
use crate::synthesis::feedback::feedback_riccati;
use crate::synthesis::observer::{ObserverProblem, REMEDY};
use crate::synthesis::riccati::smallest_feasible;
use crate::synthesis::verify::{Check, require};
use crate::synthesis::{SolverReport, agreement, report};
use nalgebra::DMatrix;
use serde::Serialize;

/// Channels and states of a filter up to which Clarabel confirms it, three channels of the paper's: its time grows with
/// the sixth power, from 1 s for 24 states to 10 s for 36, and minutes for 72.
pub const MOST_CONFIRMED_CHANNELS: usize = 3;
/// See [`MOST_CONFIRMED_CHANNELS`].
pub const MOST_CONFIRMED_STATES: usize = 36;

/// Largest residual of a Riccati equation, relative to its largest term: a million times its rounding errors.
const RESIDUAL_LIMIT: f64 = 1e-9;

/// What the gains of a filter come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Solver {
    /// The Riccati equation alone.
    #[serde(rename = "riccati")]
    Riccati,
    /// The Riccati equation; the matrix inequality (32) has the same optimum.
    #[serde(rename = "riccati, confirmed")]
    RiccatiConfirmed,
}

impl Solver {
    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Riccati => "riccati",
            Self::RiccatiConfirmed => "riccati, confirmed",
        }
    }
}

/// Feedback and observer gain of a group of n channels with N states and l sensors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FullOrderGains {
    /// K of (21), a row per channel: n x N.
    pub k: Vec<Vec<f64>>,
    /// L of (20), a row per state, a column per sensor: N x l.
    pub l: Vec<Vec<f64>>,
}

/// How Clarabel confirmed L.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confirmation {
    /// How the solver ended on (32).
    pub report: SolverReport,
    /// Largest difference of the two L, relative to the largest entry.
    pub difference: f64,
    /// Time the solver took, s; not part of any result.
    #[serde(skip)]
    pub solve_time_s: f64,
}

/// The controller of a group of channels that share sensors, and what is known about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FullOrderSynthesis {
    /// The weights of each channel.
    pub design: ChannelDesign,
    /// The sensors.
    pub sensors: Sensors,
    /// The gains.
    pub gains: FullOrderGains,
    /// What L comes from.
    pub solver: Solver,
    /// How it was confirmed, where it was.
    pub confirmation: Option<Confirmation>,
    /// Norm of what is left of the filter's Riccati equation, relative to its largest term.
    pub residual: f64,
    /// Largest real part of an eigenvalue of Abar + L Cbar, 1/s.
    pub slowest_pole_per_s: f64,
    /// The certified attenuation level.
    pub certificate: FullOrderCertificate,
    /// Every check; all passed.
    pub checks: Vec<Check>,
}

impl FullOrderSynthesis {
    /// The largest eigenvalue of (27) at the certified level with gains of the same shape; negative if the certificate
    /// holds for them.
    ///
    /// # Errors
    /// If a size differs or an eigenvalue cannot be computed.
    pub fn max_eigenvalue_with(&self, gains: &FullOrderGains) -> Result<f64, SynthesisError> {
        let channels = CoupledChannels::new(&self.design, &self.sensors);
        let k = from_rows("k", &gains.k, self.gains.k.len(), channels.states())?;
        let l = from_rows("l", &gains.l, channels.states(), self.sensors.rows().len())?;
        self.certificate.max_eigenvalue_with(&channels, [&k, &l])
    }
}

/// Designs, checks and certifies the controller of a group of channels with these sensors.
///
/// # Errors
/// An invalid design, an infeasible step with the smallest feasible rho, or a check that does not hold. Deterministic:
/// the same design and sensors give the same bits.
pub fn synthesize_full_order(
    design: &ChannelDesign,
    sensors: &Sensors,
) -> Result<FullOrderSynthesis, SynthesisError> {
    design.validate()?;
    let channels = CoupledChannels::new(design, sensors);
    let k = channels.feedback(&feedback_riccati(design)?.gain);
    let filter = channels.filter(&k);
    let x = solved(&filter, design.rho).ok_or_else(|| infeasible(design, sensors))?;
    let l = filter.gain(&x.p);
    let mut checks = vec![require(
        Step::Observer,
        "residual of the Riccati equation, relative to its largest term".into(),
        x.residual,
        RESIDUAL_LIMIT,
        "use weights with less extreme ratios",
    )?];

    let is_small = sensors.channels().len() <= MOST_CONFIRMED_CHANNELS
        && channels.states() <= MOST_CONFIRMED_STATES;
    let (confirmation, agreed) = match is_small {
        true => Some(confirmed(&filter, design.rho, &x, &l)?),
        false => None,
    }
    .unzip();
    checks.extend(agreed);
    let slowest_pole_per_s = slowest_pole(&channels, &l)?;
    checks.push(require(
        Step::Observer,
        "largest real part of a pole of A + L C".into(),
        slowest_pole_per_s,
        0.0,
        "use weights with less extreme ratios",
    )?);
    let certificate = FullOrderCertificate::of(&channels, [&k, &l], design.rho)?;
    checks.push(require(
        Step::Certificate,
        "largest eigenvalue of (27) at the certified level".into(),
        certificate.max_eigenvalue,
        0.0,
        "use weights with less extreme ratios",
    )?);
    Ok(FullOrderSynthesis {
        design: design.clone(),
        sensors: sensors.clone(),
        gains: FullOrderGains {
            k: to_rows(&k),
            l: to_rows(&l),
        },
        solver: match confirmation {
            Some(_) => Solver::RiccatiConfirmed,
            None => Solver::Riccati,
        },
        confirmation,
        residual: x.residual,
        slowest_pole_per_s,
        certificate,
        checks,
    })
}

/// X of the filter's Riccati equation at a level.
fn solved(filter: &ObserverProblem, rho: f64) -> Option<Solution> {
    let [a, s, q] = filter.equation(rho);
    stabilising_solution(&a, &s, &q)
}

/// L of the inequality (32) against that of the Riccati equation.
fn confirmed(
    filter: &ObserverProblem,
    rho: f64,
    x: &Solution,
    l: &DMatrix<f64>,
) -> Result<(Confirmation, Check), SynthesisError> {
    let (of_inequality, optimum) = observer_inequality(filter, rho, &x.p)?;
    let agreed = agreement(Step::Observer, &of_inequality, l)?;
    let confirmation = Confirmation {
        difference: agreed.value,
        solve_time_s: optimum.solve_time_s,
        report: report((Step::Observer, optimum)),
    };
    Ok((confirmation, agreed))
}

/// The error of a filter without a solution, with the smallest level at which both steps have one.
fn infeasible(design: &ChannelDesign, sensors: &Sensors) -> SynthesisError {
    let feasible = |rho: f64| {
        let design = ChannelDesign {
            rho,
            ..design.clone()
        };
        let channels = CoupledChannels::new(&design, sensors);
        feedback_riccati(&design).is_ok_and(|k| {
            let filter = channels.filter(&channels.feedback(&k.gain));
            solved(&filter, rho).is_some()
        })
    };
    SynthesisError::Infeasible {
        step: Step::Observer,
        rho: design.rho,
        smallest_rho: smallest_feasible(feasible, design.rho),
        remedy: REMEDY,
    }
}

/// The largest real part of a pole of Abar + L Cbar, 1/s.
fn slowest_pole(channels: &CoupledChannels<'_>, l: &DMatrix<f64>) -> Result<f64, SynthesisError> {
    let system = &channels.system;
    spectral_abscissa(&(&system.a + l * &system.c)).ok_or(SynthesisError::NotConverged {
        step: Step::Observer,
        what: "the slowest pole",
    })
}

fn to_rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let rows = m.row_iter();
    rows.map(|row| row.iter().copied().collect()).collect()
}

/// A gain of so many rows and columns from its rows.
fn from_rows(
    key: &str,
    given: &[Vec<f64>],
    rows: usize,
    columns: usize,
) -> Result<DMatrix<f64>, SynthesisError> {
    let wrong = |given, needed, why| SynthesisError::WrongLength {
        key: key.into(),
        given,
        needed,
        why,
    };
    if given.len() != rows {
        return Err(wrong(given.len(), rows, "the rows of the gain"));
    }
    if let Some(row) = given.iter().find(|row| row.len() != columns) {
        return Err(wrong(row.len(), columns, "the columns of the gain"));
    }
    Ok(DMatrix::from_fn(rows, columns, |i, j| given[i][j]))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use crate::synthesis::Preset;
    use crate::synthesis::full_order::sensor::SensorChanges;

    #[test]
    fn inequality_does_not_confirm_a_gain_that_is_off_by_a_hundredth() {
        let design = Preset::UavPaper.designs()[0].1.clone();
        let sensors = Sensors::new(&["x".to_string()], &design, &SensorChanges::default()).unwrap();
        let channels = CoupledChannels::new(&design, &sensors);
        let k = channels.feedback(&feedback_riccati(&design).unwrap().gain);
        let filter = channels.filter(&k);
        let x = solved(&filter, design.rho).unwrap();
        let l = filter.gain(&x.p);
        assert!(confirmed(&filter, design.rho, &x, &l).is_ok());
        let error = confirmed(&filter, design.rho, &x, &(l * 1.01)).unwrap_err();
        assert!(
            matches!(error, SynthesisError::CheckFailed { .. }),
            "{error}"
        );
    }
}
