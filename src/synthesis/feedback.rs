//! Step 1 of the design: the feedback gain K from inequality (31), and from
//! the Riccati equation that has the same optimum.
//!
//! (31) as printed lets a disturbance enter the pure integrators, which (19)
//! excludes, and then has no solution at the paper's own rho. Here the
//! disturbance enters the first row of F1, in every term.

use super::channel::{ERROR_STATES, error_channel, inputs, reduced_channel};
use super::design::ChannelDesign;
use super::error::{Step, SynthesisError};
use super::linalg::{diagonal, join, square_roots, sym};
use super::lmi::{Optimum, Unknowns, minimise};
use super::riccati::{smallest_feasible, stabilising_solution};
use nalgebra::DMatrix;

const REMEDY: &str = "lower the weights q1 or r, or raise the leak of the smoothing model";

/// A gain and the solution of the Riccati equation it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct RiccatiGain {
    /// K as a row over all states (1 x s), or L with a row per state (s x 3).
    pub gain: DMatrix<f64>,
    /// P1 on [e; F1], zero on the taps that K does not see; or X on all states.
    pub solution: DMatrix<f64>,
}

/// Step 1 on the states it can see: the error and the active taps of F1.
///
/// The other taps of F1 are a delay line and F2 does not act on the error;
/// neither is weighted, so K and P1 are zero there and W = P1^-1 would be unbounded.
#[derive(Clone, Debug)]
pub(super) struct FeedbackProblem {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// Q1.
    q: DMatrix<f64>,
    /// Where the model error of the actuator fault enters.
    e: DMatrix<f64>,
    r: f64,
}

impl FeedbackProblem {
    /// The fault-tolerant problem on [e; active taps of F1].
    pub(super) fn fault_tolerant(design: &ChannelDesign) -> Self {
        let n = ERROR_STATES + design.smoothing.active_taps();
        let channel = reduced_channel(design);
        let mut q = DMatrix::zeros(n, n);
        q.view_mut((0, 0), (ERROR_STATES, ERROR_STATES))
            .copy_from(&diagonal(&design.q1));
        Self {
            a: channel.a.view((0, 0), (n, n)).into(),
            b: channel.b.view((0, 0), (n, 1)).into(),
            q,
            e: inputs(n, [ERROR_STATES]),
            r: design.r,
        }
    }

    /// The same weights on the error alone, disturbed at the acceleration.
    pub(super) fn pid(design: &ChannelDesign) -> Self {
        let channel = error_channel();
        Self {
            a: channel.a,
            e: channel.b.clone(),
            b: channel.b,
            q: diagonal(&design.q1),
            r: design.r,
        }
    }

    /// P1 of A' P + P A - P B R^-1 B' P + rho^-2 P E E' P + Q1 = 0.
    pub(super) fn riccati(&self, rho: f64) -> Option<DMatrix<f64>> {
        let s = &self.b * self.b.transpose() / self.r - &self.e * self.e.transpose() / rho.powi(2);
        stabilising_solution(&self.a, &s, &self.q)
    }

    /// K = -R^-1 B' P1.
    pub(super) fn gain(&self, p: &DMatrix<f64>) -> DMatrix<f64> {
        -self.b.transpose() * p / self.r
    }

    /// K = Y W^-1 from (31) with the least tr W^-1, in coordinates in which
    /// `scale` (a Riccati solution) is the identity and in units of u in which R is one.
    fn lmi(
        &self,
        rho: f64,
        scale: &DMatrix<f64>,
    ) -> Result<(DMatrix<f64>, Optimum), SynthesisError> {
        let n = self.a.nrows();
        let (to, from) = square_roots(scale).ok_or(not_converged())?;
        let a = &to * &self.a * &from;
        let b = &to * &self.b / self.r.sqrt();
        let e = &to * &self.e / rho;
        let weighted: Vec<usize> = (0..n).filter(|&i| self.q[(i, i)] > 0.0).collect();
        let g = from.transpose() * self.q.map(f64::sqrt).select_columns(&weighted);

        let mut unknowns = Unknowns::default();
        let z = unknowns.symmetric(n);
        let w = unknowns.symmetric(n);
        let y = unknowns.full(1, n);
        let identity = DMatrix::identity(n, n);
        let identity_g = DMatrix::identity(g.ncols(), g.ncols());
        let one = DMatrix::identity(1, 1);
        let zero = DMatrix::zeros(g.ncols(), 1);
        // [Sym(A W + B Y) + E E'/rho^2, W G, Y'; *, -I, 0; *, *, -R^-1] <= 0
        let inequality_31 = |x: &[f64]| {
            let (w, y) = (w.at(x), y.at(x));
            let corner = -(sym(&a * &w + &b * &y) + &e * e.transpose());
            let (wg, yt) = (-(&w * &g), -y.transpose());
            join(&[
                [&corner, &wg, &yt],
                [&wg.transpose(), &identity_g, &zero],
                [&yt.transpose(), &zero.transpose(), &one],
            ])
        };
        // Z >= W^-1
        let bound = |x: &[f64]| join(&[[&z.at(x), &identity], [&identity, &w.at(x)]]);
        let optimum = minimise(
            unknowns.count(),
            &|x| z.at(x).trace(),
            &[&inequality_31, &bound],
        )
        .ok_or(not_converged())?
        .usable(Step::Feedback)?;
        let w_inverse = w.at(&optimum.x).try_inverse().ok_or(not_converged())?;
        let k = y.at(&optimum.x) * w_inverse * to / self.r.sqrt();
        Ok((k, optimum))
    }
}

/// K = -R^-1 B' P1 from the Riccati equation of Step 1.
///
/// # Errors
/// If the design's rho is too small, with the smallest one that is not.
pub fn feedback_riccati(design: &ChannelDesign) -> Result<RiccatiGain, SynthesisError> {
    let problem = FeedbackProblem::fault_tolerant(design);
    let p = problem
        .riccati(design.rho)
        .ok_or_else(|| SynthesisError::Infeasible {
            step: Step::Feedback,
            rho: design.rho,
            smallest_rho: smallest_feasible(|rho| problem.riccati(rho).is_some(), design.rho),
            remedy: REMEDY,
        })?;
    let f1_states = ERROR_STATES + design.smoothing.taps()[0];
    Ok(RiccatiGain {
        gain: problem.gain(&p).resize(1, design.states(), 0.0),
        solution: p.resize(f1_states, f1_states, 0.0),
    })
}

/// K (1 x s) from inequality (31), solved in the coordinates of the Riccati solution.
pub(super) fn feedback_lmi(
    design: &ChannelDesign,
    riccati: &RiccatiGain,
) -> Result<(DMatrix<f64>, Optimum), SynthesisError> {
    let problem = FeedbackProblem::fault_tolerant(design);
    let n = problem.a.nrows();
    let scale = riccati.solution.view((0, 0), (n, n)).into_owned();
    let (k, optimum) = problem.lmi(design.rho, &scale)?;
    Ok((k.resize(1, design.states(), 0.0), optimum))
}

fn not_converged() -> SynthesisError {
    SynthesisError::NotConverged {
        step: Step::Feedback,
        what: "the scaling of (31)",
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use crate::synthesis::preset::Preset;

    #[test]
    fn inequality_has_no_solution_below_the_smallest_rho_of_the_riccati_equation() {
        let design = Preset::UavPaper.designs()[0].1.clone();
        let problem = FeedbackProblem::fault_tolerant(&design);
        let smallest = smallest_feasible(|rho| problem.riccati(rho).is_some(), 0.1).unwrap();
        let scale = problem.riccati(2.0 * smallest).unwrap();
        assert!(problem.lmi(1.01 * smallest, &scale).is_ok());
        let error = problem.lmi(0.9 * smallest, &scale).unwrap_err();
        let SynthesisError::SolverFailed { status, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!(*status, "PrimalInfeasible");
    }

    #[test]
    fn val_printed_inequality_is_infeasible_at_the_papers_rho() {
        // (31) with I/rho^2 in its corner, as printed, at rho = 30: the analytic
        // bound is the root of the largest weight in Q1.
        for preset in [Preset::UavPaper, Preset::BipedPaper] {
            let design = preset.designs()[0].1.clone();
            let bound = design.q1[1].sqrt();
            assert!(bound > 30.0);
            let smallest = smallest_rho_as_printed(&FeedbackProblem::fault_tolerant(&design));
            // The solver's tolerance on 1/rho^2.
            assert!((smallest / bound - 1.0).abs() < 1e-5, "{smallest}");
        }
    }

    /// The smallest rho of (31) as printed: the largest s = 1/rho^2 with s I in the corner.
    fn smallest_rho_as_printed(problem: &FeedbackProblem) -> f64 {
        let n = problem.a.nrows();
        let mut unknowns = Unknowns::default();
        let s = unknowns.full(1, 1);
        let w = unknowns.symmetric(n);
        let y = unknowns.full(1, n);
        let g = problem.q.map(f64::sqrt).select_columns(&[0, 1, 2]);
        let identity = DMatrix::<f64>::identity(n, n);
        let inequality = |x: &[f64]| {
            let (w, y) = (w.at(x), y.at(x));
            let corner = -(sym(&problem.a * &w + &problem.b * &y) + &identity * s.at(x)[(0, 0)]);
            let (wg, yt) = (-(&w * &g), -y.transpose());
            join(&[
                [&corner, &wg, &yt],
                [
                    &wg.transpose(),
                    &DMatrix::identity(3, 3),
                    &DMatrix::zeros(3, 1),
                ],
                [
                    &yt.transpose(),
                    &DMatrix::zeros(1, 3),
                    &DMatrix::from_element(1, 1, problem.r.recip()),
                ],
            ])
        };
        let optimum = minimise(unknowns.count(), &|x| -s.at(x)[(0, 0)], &[&inequality]).unwrap();
        s.at(&optimum.x)[(0, 0)].sqrt().recip()
    }
}
