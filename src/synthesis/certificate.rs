//! The H-infinity certificate: the smallest attenuation level for which
//! inequality (27) holds with given gains and a block-diagonal P.
//!
//! The infimum itself is the true norm, but no bounded P attains it, and (27)
//! holds there with equality only. Two small terms give up a little of rho for
//! a bounded P and a strictly negative (27): `SIZE_WEIGHT` and `STRENGTHENINGS`.

use super::channel::ERROR_STATES;
use super::closed_loop::ClosedLoop;
use super::design::ChannelDesign;
use super::error::{Step, SynthesisError};
use super::gains::ControllerGains;
use super::linalg::{join, lyapunov, square_roots, sym, symmetric_eigenvalues};
use super::lmi::{Optimum, Unknowns, minimise};
use super::riccati::stabilising_solution;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// (27) is verified at this multiple of the certified level: at the level itself it holds with equality.
pub const RELAXATION: f64 = 1.001;

/// Fractions of rho^2 given up to make (27) strictly negative, tried in turn:
/// the first suffices unless the solver's tolerance eats it up.
const STRENGTHENINGS: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// The level, as a multiple of the true norm, whose Riccati solution gives the
/// coordinates of (27). Any from 1.02 to 2 serves.
const GUESS_LEVEL: f64 = 1.1;

/// Weight on the size of P against rho^2, in those coordinates. The smallest
/// rho alone is approached only as P2 grows without bound; this ends 0.01 % above it.
const SIZE_WEIGHT: f64 = 1e-5;

/// How many times the block of P1 on unseen states is tried ten times smaller.
const MAX_SHRINKINGS: i32 = 14;

/// A certified attenuation level of one channel and the matrices that prove it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// Certified attenuation level rho of (24).
    pub rho: f64,
    /// Largest eigenvalue of (27) at 1.001 rho, computed without the solver; negative.
    pub max_eigenvalue: f64,
    /// True H-infinity norm from a frequency sweep; no level below it can be certified.
    pub hinf_norm: f64,
    /// Frequency of the norm's peak, rad/s.
    pub hinf_peak_rad_s: f64,
    /// Whether the certified level is within the rho the gains were designed for.
    pub meets_design_rho: bool,
    /// P1, rows, s x s.
    pub p1: Vec<Vec<f64>>,
    /// P2, rows, s x s.
    pub p2: Vec<Vec<f64>>,
}

impl Certificate {
    /// The largest eigenvalue of (27) at 1.001 rho with this certificate's P1
    /// and P2 and the given gains; negative if they belong together.
    ///
    /// With gains whose poles are stable, which [`verify`](super::verify()) checks, a negative
    /// value also implies that P1 and P2 are positive definite.
    ///
    /// # Errors
    /// If a size does not fit the design or an eigenvalue cannot be computed.
    pub fn max_eigenvalue_with(
        &self,
        design: &ChannelDesign,
        gains: &ControllerGains,
    ) -> Result<f64, SynthesisError> {
        gains.require_states(design.states())?;
        let p = block_diagonal(
            &from_rows(&self.p1, design.states())?,
            &from_rows(&self.p2, design.states())?,
        );
        max_eigenvalue_27(&ClosedLoop::of(design, gains), &p, self.rho)
            .ok_or(not_converged("an eigenvalue of (27)"))
    }
}

/// Minimises rho^2 subject to (27) for fixed, stabilising gains, then checks (27) independently.
///
/// # Errors
/// If the solver fails or the check does not hold.
pub(super) fn certify(
    design: &ChannelDesign,
    gains: &ControllerGains,
) -> Result<(Certificate, Optimum), SynthesisError> {
    let s = design.states();
    let whole = ClosedLoop::of(design, gains);
    let seen = seen_states(design, gains);
    let states: Vec<usize> = seen.iter().copied().chain(s..2 * s).collect();
    let part = whole.restricted(&states);
    let (hinf_norm, hinf_peak_rad_s) = part
        .hinf_norm()
        .ok_or(not_converged("the frequency sweep"))?;

    let attempt = |strengthening: f64| {
        let solution = minimise_rho(&part, seen.len(), hinf_norm, strengthening)?;
        let (p, max_eigenvalue) = extended(&whole, &seen, &solution)?;
        let certificate = Certificate {
            rho: solution.rho,
            max_eigenvalue,
            hinf_norm,
            hinf_peak_rad_s,
            meets_design_rho: solution.rho <= design.rho,
            p1: to_rows(&p.view((0, 0), (s, s)).into_owned()),
            p2: to_rows(&p.view((s, s), (s, s)).into_owned()),
        };
        Ok((certificate, solution.optimum))
    };
    let [first, retries @ ..] = STRENGTHENINGS;
    let mut outcome = attempt(first);
    for strengthening in retries {
        if matches!(&outcome, Ok((certificate, _)) if certificate.max_eigenvalue < 0.0) {
            break;
        }
        outcome = attempt(strengthening);
    }
    outcome
}

/// The states of the tracking half that reach the weighted output: the error
/// and the fault taps that feed back or carry a gain.
///
/// The other taps neither drive these nor are weighted, so that the smallest
/// level does not depend on them and P1 could be zero there.
fn seen_states(design: &ChannelDesign, gains: &ControllerGains) -> Vec<usize> {
    let [taps1, taps2] = design.smoothing.taps();
    let active = design.smoothing.active_taps();
    let with_gain = |first: usize, taps: usize| {
        let gains = &gains.k[first..first + taps];
        gains.iter().rposition(|&k| k != 0.0).map_or(0, |i| i + 1)
    };
    let (f1, f2) = (ERROR_STATES, ERROR_STATES + taps1);
    let seen1 = with_gain(f1, taps1).max(active);
    let seen2 = match with_gain(f2, taps2) {
        0 => 0,
        last => last.max(active),
    };
    (0..f1 + seen1).chain(f2..f2 + seen2).collect()
}

struct Solution {
    /// On the seen states.
    p1: DMatrix<f64>,
    p2: DMatrix<f64>,
    rho: f64,
    optimum: Optimum,
}

/// Clarabel's smallest rho for which (27) holds with P = diag(P1, P2).
///
/// Solved in coordinates in which the diagonal blocks of the bounded-real
/// Riccati solution slightly above the true norm are the identity.
fn minimise_rho(
    part: &ClosedLoop,
    seen: usize,
    hinf_norm: f64,
    strengthening: f64,
) -> Result<Solution, SynthesisError> {
    let n = part.a.nrows();
    let strengthened = strengthened(part, hinf_norm, strengthening)?;
    let level = GUESS_LEVEL * hinf_norm;
    let s = &part.e * part.e.transpose() / -level.powi(2);
    let guess = stabilising_solution(&part.a, &s, &strengthened.weight)
        .ok_or(not_converged("the bounded-real Riccati equation"))?;
    let roots = |first: usize, size: usize| {
        square_roots(&guess.view((first, first), (size, size)).into_owned())
            .ok_or(not_converged("the scaling of (27)"))
    };
    let (to1, from1) = roots(0, seen)?;
    let (to2, from2) = roots(seen, n - seen)?;
    let scaled =
        strengthened.transformed(&block_diagonal(&to1, &to2), &block_diagonal(&from1, &from2));
    let e = &scaled.e / level;

    let mut unknowns = Unknowns::default();
    let level2 = unknowns.full(1, 1);
    let p1 = unknowns.symmetric(seen);
    let p2 = unknowns.symmetric(n - seen);
    let identity = DMatrix::<f64>::identity(e.ncols(), e.ncols());
    // [Q + K' R K + Sym(P A), P E; *, -rho^2 I] <= 0
    let inequality_27 = |x: &[f64]| {
        let p = block_diagonal(&p1.at(x), &p2.at(x));
        let corner = -(&scaled.weight + sym(&p * &scaled.a));
        let pe = -(&p * &e);
        let bound = &identity * level2.at(x)[(0, 0)];
        join(&[[&corner, &pe], [&pe.transpose(), &bound]])
    };
    let cost =
        |x: &[f64]| level2.at(x)[(0, 0)] + SIZE_WEIGHT * (p1.at(x).trace() + p2.at(x).trace());
    let optimum = minimise(unknowns.count(), &cost, &[&inequality_27])
        .ok_or(not_converged("the set-up of (27)"))?
        .usable(Step::Certificate)?;
    let x = &optimum.x;
    Ok(Solution {
        p1: to1.transpose() * p1.at(x) * &to1,
        p2: to2.transpose() * p2.at(x) * &to2,
        rho: level2.at(x)[(0, 0)].max(0.0).sqrt() * level,
        optimum,
    })
}

/// The closed loop with weights that leave (27) strictly negative: enlarged
/// in every direction by as much as costs a fraction of rho^2 at most.
fn strengthened(
    part: &ClosedLoop,
    hinf_norm: f64,
    fraction: f64,
) -> Result<ClosedLoop, SynthesisError> {
    let identity = DMatrix::identity(part.a.nrows(), part.a.nrows());
    let unweighted = ClosedLoop {
        weight: identity.clone(),
        ..part.clone()
    };
    let (state_gain, _) = unweighted
        .hinf_norm()
        .ok_or(not_converged("the frequency sweep"))?;
    let weight = &part.weight + identity * (fraction * (hinf_norm / state_gain).powi(2));
    Ok(ClosedLoop {
        weight,
        ..part.clone()
    })
}

/// P = diag(P1, P2) on all states and the largest eigenvalue of (27).
///
/// On the unseen states P1 is a Lyapunov matrix, made small enough not to
/// disturb the inequality on the others.
fn extended(
    whole: &ClosedLoop,
    seen: &[usize],
    solution: &Solution,
) -> Result<(DMatrix<f64>, f64), SynthesisError> {
    let s = whole.a.nrows() / 2;
    let unseen: Vec<usize> = (0..s).filter(|i| !seen.contains(i)).collect();
    let a = whole.a.select_rows(&unseen).select_columns(&unseen);
    let small = lyapunov(&a, &DMatrix::identity(unseen.len(), unseen.len()))
        .ok_or(not_converged("a Lyapunov equation"))?;
    let mut p1 = DMatrix::zeros(s, s);
    for (i, &row) in seen.iter().enumerate() {
        for (j, &column) in seen.iter().enumerate() {
            p1[(row, column)] = solution.p1[(i, j)];
        }
    }
    (0..MAX_SHRINKINGS)
        .filter_map(|k| {
            let mut p1 = p1.clone();
            for (i, &row) in unseen.iter().enumerate() {
                for (j, &column) in unseen.iter().enumerate() {
                    p1[(row, column)] = small[(i, j)] * 0.1_f64.powi(k);
                }
            }
            let p = block_diagonal(&p1, &solution.p2);
            let eigenvalue = max_eigenvalue_27(whole, &p, solution.rho)?;
            Some((p, eigenvalue))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .ok_or(not_converged("an eigenvalue of (27)"))
}

/// The largest eigenvalue of (27) at 1.001 rho.
fn max_eigenvalue_27(whole: &ClosedLoop, p: &DMatrix<f64>, rho: f64) -> Option<f64> {
    symmetric_eigenvalues(&whole.inequality_27(p, RELAXATION * rho))?
        .last()
        .copied()
}

fn block_diagonal(p1: &DMatrix<f64>, p2: &DMatrix<f64>) -> DMatrix<f64> {
    let upper = DMatrix::zeros(p1.nrows(), p2.ncols());
    let lower = DMatrix::zeros(p2.nrows(), p1.ncols());
    join(&[[p1, &upper], [&lower, p2]])
}

fn to_rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    m.row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}

fn from_rows(rows: &[Vec<f64>], states: usize) -> Result<DMatrix<f64>, SynthesisError> {
    let wrong = |given| SynthesisError::WrongLength {
        key: "a matrix of the certificate".into(),
        given,
        needed: states,
        why: "the number of states of the design",
    };
    if rows.len() != states {
        return Err(wrong(rows.len()));
    }
    if let Some(row) = rows.iter().find(|row| row.len() != states) {
        return Err(wrong(row.len()));
    }
    Ok(DMatrix::from_fn(states, states, |i, j| rows[i][j]))
}

fn not_converged(what: &'static str) -> SynthesisError {
    SynthesisError::NotConverged {
        step: Step::Certificate,
        what,
    }
}
