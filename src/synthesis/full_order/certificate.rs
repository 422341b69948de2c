//! The certificate (27) of a full-order loop: P is the stabilising solution of the bounded real Riccati equation at a
//! level just above the H-infinity norm.
//!
//! P is a full matrix, which Theorem 1 allows; the block-diagonal P of (30) is only needed to design K and L.

use super::coupled::CoupledChannels;
use super::doubling::stabilising_solution;
use super::norm::{hinf_norm, largest_gain};
use crate::synthesis::certificate::RELAXATION;
use crate::synthesis::closed_loop::ClosedLoop;
use crate::synthesis::error::{Step, SynthesisError};
use crate::synthesis::linalg::symmetric_eigenvalues;
use nalgebra::DMatrix;
use serde::Serialize;

/// Frequencies a decade of the sweep for the norm, and the fraction of rho^2 given up to make (27) strictly negative,
/// of which 2e-3 lie between the norm and rho; finer where a certificate does not exist, because the sweep has missed
/// a peak or the fraction was more than was thought.
const ATTEMPTS: [(u32, f64); 3] = [(8, 1e-3), (40, 1e-4), (200, 1e-5)];

/// A certified attenuation level of a full-order loop and the matrix that proves it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FullOrderCertificate {
    /// Certified attenuation level rho of (24), 1.001 times the norm.
    pub rho: f64,
    /// Largest eigenvalue of (27) at rho, computed apart from P; negative.
    pub max_eigenvalue: f64,
    /// Norm of what P leaves of its Riccati equation, relative to the equation's largest term.
    pub residual: f64,
    /// H-infinity norm from a frequency sweep; no level below it can be certified.
    pub hinf_norm: f64,
    /// Frequency of the norm's peak, rad/s.
    pub hinf_peak_rad_s: f64,
    /// Whether the certified level is within the rho the gains were designed for.
    pub meets_design_rho: bool,
    /// P, rows, 2 N x 2 N: of the augmented error, then of the estimation error.
    pub p: Vec<Vec<f64>>,
}

impl FullOrderCertificate {
    /// The norm and the certificate of stabilising gains K (n x N) and L (N x l).
    pub(super) fn of(
        channels: &CoupledChannels<'_>,
        [k, l]: [&DMatrix<f64>; 2],
        design_rho: f64,
    ) -> Result<Self, SynthesisError> {
        let whole = channels.closed_loop(k, l);
        let (n, seen) = (channels.states(), channels.seen_states());
        let part = whole.restricted(&(0..seen).chain(n..2 * n).collect::<Vec<_>>());
        for (points_per_decade, fraction) in ATTEMPTS {
            let (norm, peak_rad_s) = hinf_norm(&part, seen, points_per_decade)
                .ok_or(not_converged("the frequency sweep"))?;
            let rho = RELAXATION * norm;
            let strengthened = strengthened(&whole, (norm, peak_rad_s), fraction)?;
            let Some((p, residual)) = bounded_real_solution(&strengthened, rho) else {
                continue;
            };
            let max_eigenvalue = max_eigenvalue_27(&whole, &p, rho)?;
            if max_eigenvalue >= 0.0 {
                continue;
            }
            return Ok(Self {
                rho,
                max_eigenvalue,
                residual,
                hinf_norm: norm,
                hinf_peak_rad_s: peak_rad_s,
                meets_design_rho: rho <= design_rho,
                p: p.row_iter()
                    .map(|row| row.iter().copied().collect())
                    .collect(),
            });
        }
        Err(not_converged("the search for the peak of the norm"))
    }

    /// The largest eigenvalue of (27) at rho with this P and the closed loop of given gains; negative if they belong
    /// together.
    pub(super) fn max_eigenvalue_with(
        &self,
        channels: &CoupledChannels<'_>,
        [k, l]: [&DMatrix<f64>; 2],
    ) -> Result<f64, SynthesisError> {
        let size = self.p.len();
        let p = DMatrix::from_fn(size, size, |i, j| self.p[i][j]);
        max_eigenvalue_27(&channels.closed_loop(k, l), &p, self.rho)
    }
}

/// The closed loop with weights that leave (27) strictly negative: enlarged in every direction by eps, which costs a
/// fraction of rho^2 at rest or where the norm has its peak.
fn strengthened(
    whole: &ClosedLoop,
    (norm, peak_rad_s): (f64, f64),
    fraction: f64,
) -> Result<ClosedLoop, SynthesisError> {
    let size = whole.a.nrows();
    let unweighted = ClosedLoop {
        weight: DMatrix::identity(size, size),
        ..whole.clone()
    };
    let state_gain = largest_gain(&unweighted, size / 2, &[0.0, peak_rad_s])
        .ok_or(not_converged("the gain to the states"))?;
    let eps = fraction * (norm / state_gain).powi(2);
    Ok(ClosedLoop {
        weight: &whole.weight + DMatrix::from_diagonal_element(size, size, eps),
        ..whole.clone()
    })
}

/// P > 0 of A~' P + P A~ + Q~ + eps I + rho^-2 P E E' P = 0 and its residual; `None` where rho is below the norm.
fn bounded_real_solution(strengthened: &ClosedLoop, rho: f64) -> Option<(DMatrix<f64>, f64)> {
    let ClosedLoop { a, e, weight } = strengthened;
    let s = e * e.transpose() / -rho.powi(2);
    let solution = stabilising_solution(a, &s, weight)?;
    solution.p.clone().cholesky()?;
    Some((solution.p, solution.residual))
}

fn max_eigenvalue_27(
    closed_loop: &ClosedLoop,
    p: &DMatrix<f64>,
    rho: f64,
) -> Result<f64, SynthesisError> {
    symmetric_eigenvalues(&closed_loop.inequality_27(p, rho))
        .and_then(|values| values.last().copied())
        .ok_or(not_converged("an eigenvalue of (27)"))
}

fn not_converged(what: &'static str) -> SynthesisError {
    SynthesisError::NotConverged {
        step: Step::Certificate,
        what,
    }
}
