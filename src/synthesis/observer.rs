//! Step 2 of the design: the observer gain L as a filter with a
//! measurement-noise channel, from its inequality and from the Riccati equation
//! that has the same optimum.
//!
//! (32) as printed is met by slow observers that hardly estimate the fault;
//! the noise channel N and the least tr P2^-1 select a fast one of bounded size.

use super::channel::{
    Channel, ERROR_STATES, augmented_channel, error_channel, estimation_weight, inputs,
};
use super::design::ChannelDesign;
use super::error::{Step, SynthesisError};
use super::feedback::{FeedbackProblem, RiccatiGain};
use super::linalg::{diagonal, join, square_roots, sym};
use super::lmi::{Optimum, Unknowns, minimise};
use super::riccati::{smallest_feasible, stabilising_solution};
use nalgebra::DMatrix;

/// What besides rho may make the filter feasible.
pub(super) const REMEDY: &str =
    "lower nu, r or the weights q2, or raise the leak of the smoothing model";

/// A filter problem: weights on the estimation error, model errors, measurement noise.
#[derive(Clone, Debug)]
pub(super) struct ObserverProblem {
    /// What is observed: one channel, or several that share sensors.
    pub(super) channel: Channel,
    /// Qf, the weight on the estimation error.
    pub(super) q: DMatrix<f64>,
    /// Where the model errors enter.
    pub(super) e: DMatrix<f64>,
    /// Diagonal of N, one per measurement.
    pub(super) noise: Vec<f64>,
}

impl ObserverProblem {
    /// The fault-tolerant observer for a feedback gain (1 x s): Qf = Q2 + R K'K.
    pub(super) fn fault_tolerant(design: &ChannelDesign, k: &DMatrix<f64>) -> Self {
        let channel = augmented_channel(design);
        let f2 = ERROR_STATES + design.smoothing.taps()[0];
        let mut e = inputs(design.states(), [ERROR_STATES, f2]);
        e.column_mut(1).scale_mut(design.eps2);
        Self {
            channel,
            q: estimation_weight(design) + k.transpose() * k * design.r,
            e,
            noise: vec![design.nu; 3],
        }
    }

    /// An observer of the error alone, without weights: a model error at the acceleration and noise.
    pub(super) fn pid(model_error: f64, noise: [f64; 3]) -> Self {
        let channel = error_channel();
        Self {
            q: DMatrix::zeros(ERROR_STATES, ERROR_STATES),
            e: &channel.b * model_error,
            noise: noise.to_vec(),
            channel,
        }
    }

    /// X of A X + X A' - X (C' N^-2 C - Qf / rho^2) X + E E' = 0.
    pub(super) fn riccati(&self, rho: f64) -> Option<DMatrix<f64>> {
        let [a, s, q] = self.equation(rho);
        stabilising_solution(&a, &s, &q)
    }

    /// A', C' N^-2 C - Qf / rho^2 and E E' of that equation.
    pub(super) fn equation(&self, rho: f64) -> [DMatrix<f64>; 3] {
        let c = self.whitened_output();
        let s = c.transpose() * c - &self.q / rho.powi(2);
        let a = self.channel.a.transpose();
        [a, s, &self.e * self.e.transpose()]
    }

    /// L = -X C' N^-2.
    pub(super) fn gain(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        -x * self.whitened_output().transpose() * self.noise_inverse()
    }

    /// N^-1.
    pub(super) fn noise_inverse(&self) -> DMatrix<f64> {
        let inverses = self.noise.iter().map(|nu| nu.recip());
        diagonal(&inverses.collect::<Vec<_>>())
    }

    /// N^-1 C.
    pub(super) fn whitened_output(&self) -> DMatrix<f64> {
        self.noise_inverse() * &self.channel.c
    }

    /// L = P2^-1 Y2 from the inequality with the least tr P2^-1.
    ///
    /// Solved for P2 / rho^2 in coordinates in which `scale` (a Riccati
    /// solution) is the identity: in the given ones the solver
    /// reports success with a gain that is wrong by most of its size.
    fn lmi(
        &self,
        rho: f64,
        scale: &DMatrix<f64>,
    ) -> Result<(DMatrix<f64>, Optimum), SynthesisError> {
        let n = scale.nrows();
        let (root, root_inverse) = square_roots(scale).ok_or(not_converged())?;
        let (to, from) = (root_inverse.transpose(), root.transpose());
        let a = &to * &self.channel.a * &from;
        let c = self.whitened_output() * &from;
        let e = &to * &self.e;
        let q = from.transpose() * &self.q * &from / rho.powi(2);

        let mut unknowns = Unknowns::default();
        let z = unknowns.symmetric(n);
        let p = unknowns.symmetric(n);
        // Y2 N / rho^2
        let y = unknowns.full(n, 3);
        let identity = DMatrix::identity(n, n);
        let identity_e = DMatrix::identity(e.ncols(), e.ncols());
        let identity_y = DMatrix::identity(3, 3);
        let zero = DMatrix::zeros(e.ncols(), 3);
        // [Sym(P2 A + Y2 C) + Qf, P2 E, Y2 N; *, -rho^2 I, 0; *, *, -rho^2 I] <= 0
        let inequality_32 = |x: &[f64]| {
            let (p, y) = (p.at(x), y.at(x));
            let corner = -(sym(&p * &a + &y * &c) + &q);
            let (pe, yn) = (-(&p * &e), -y);
            join(&[
                [&corner, &pe, &yn],
                [&pe.transpose(), &identity_e, &zero],
                [&yn.transpose(), &zero.transpose(), &identity_y],
            ])
        };
        // Z >= P2^-1
        let bound = |x: &[f64]| join(&[[&z.at(x), &identity], [&identity, &p.at(x)]]);
        let optimum = minimise(
            unknowns.count(),
            &|x| z.at(x).trace(),
            &[&inequality_32, &bound],
        )
        .ok_or(not_converged())?
        .usable(Step::Observer)?;
        let p_inverse = p.at(&optimum.x).try_inverse().ok_or(not_converged())?;
        let l = from * p_inverse * y.at(&optimum.x) * self.noise_inverse();
        Ok((l, optimum))
    }
}

/// L = -X C' N^-2 from the filter Riccati equation of Step 2, for a feedback gain K (1 x s).
///
/// # Errors
/// If the design's rho is too small, with the smallest one that is not.
pub fn observer_riccati(
    design: &ChannelDesign,
    k: &DMatrix<f64>,
) -> Result<RiccatiGain, SynthesisError> {
    let problem = ObserverProblem::fault_tolerant(design, k);
    let x = problem
        .riccati(design.rho)
        .ok_or_else(|| SynthesisError::Infeasible {
            step: Step::Observer,
            rho: design.rho,
            smallest_rho: smallest_feasible(|rho| both_steps_feasible(design, rho), design.rho),
            remedy: REMEDY,
        })?;
    Ok(RiccatiGain {
        gain: problem.gain(&x),
        solution: x,
    })
}

/// Whether both steps have a solution at `rho`; the feedback gain changes with it.
fn both_steps_feasible(design: &ChannelDesign, rho: f64) -> bool {
    let design = ChannelDesign {
        rho,
        ..design.clone()
    };
    let problem = FeedbackProblem::fault_tolerant(&design);
    problem.riccati(rho).is_some_and(|p| {
        let k = problem.gain(&p).resize(1, design.states(), 0.0);
        ObserverProblem::fault_tolerant(&design, &k)
            .riccati(rho)
            .is_some()
    })
}

/// L (s x 3) from the inequality of Step 2, solved in the coordinates of the Riccati solution.
pub(super) fn observer_lmi(
    design: &ChannelDesign,
    k: &DMatrix<f64>,
    riccati: &RiccatiGain,
) -> Result<(DMatrix<f64>, Optimum), SynthesisError> {
    ObserverProblem::fault_tolerant(design, k).lmi(design.rho, &riccati.solution)
}

fn not_converged() -> SynthesisError {
    SynthesisError::NotConverged {
        step: Step::Observer,
        what: "the scaling of (32)",
    }
}
