//! The stabilising solution of a large algebraic Riccati equation, by structure-preserving doubling.
//!
//! A Cayley transform makes the equation one in discrete time, whose solution is summed over 1, 2, 4, 8, .. steps
//! (Chu, Fan and Lin, Linear Algebra Appl. 396, 2005); then Newton steps (Kleinman, IEEE Trans. Autom. Control 13,
//! 1968) in balanced coordinates. The matrices are half as large as the Hamiltonian, whose sign function takes twice as
//! long; the direct solution of the Newton steps' Lyapunov equations, with a million unknowns, would not end.

use crate::synthesis::linalg::{join, max_abs, power_of_two_near};
use nalgebra::DMatrix;

/// Doublings after which a solution is given up: 2^60 steps reach any pole that can be told from zero.
const MAX_DOUBLINGS: usize = 60;
/// Newton steps: each squares the error, so that the last only confirms.
const NEWTON_STEPS: usize = 3;
/// What is left of the transition matrix when the sum has converged; what is left out of the sum is its square.
const CONVERGED: f64 = 1e-12;

/// A solution of a Riccati equation.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    /// The stabilising solution P >= 0.
    pub(super) p: DMatrix<f64>,
    /// Norm of what is left of the equation, relative to its largest term.
    pub(super) residual: f64,
}

/// The stabilising solution P >= 0 of `A' P + P A - P S P + Q = 0`, with symmetric S (indefinite in H-infinity
/// problems) and Q.
///
/// `None` where none is found: if there is none, or if P is not positive semidefinite.
pub(super) fn stabilising_solution(
    a: &DMatrix<f64>,
    s: &DMatrix<f64>,
    q: &DMatrix<f64>,
) -> Option<Solution> {
    let n = a.nrows();
    // P = c P_hat makes the two quadratic terms equally large.
    let c = (max_abs(q) / max_abs(s)).sqrt();
    let shift = mean_pole(a, s, q)?;
    let rough = doubled(a, &(s * c), &(q / c), shift)? * c;

    // Coordinates in which the diagonal of P is one, by exact powers of two.
    let balance: Vec<f64> = (0..n)
        .map(|i| power_of_two_near(rough[(i, i)].abs().sqrt()))
        .collect();
    let scaled = |m: &DMatrix<f64>, row: i32, column: i32| {
        DMatrix::from_fn(n, n, |i, j| {
            m[(i, j)] * balance[i].powi(row) * balance[j].powi(column)
        })
    };
    let [a, s, q] = [scaled(a, 1, -1), scaled(s, 1, 1), scaled(q, -1, -1)];
    let mut p = scaled(&rough, -1, -1);
    for _ in 0..NEWTON_STEPS {
        let (equation, _) = equation(&a, &s, &q, &p);
        // Its doubling converges only if A - S P is stable.
        let step = doubled(&(&a - &s * &p), &DMatrix::zeros(n, n), &equation, shift)?;
        p += step;
    }
    let (left, largest) = equation(&a, &s, &q, &p);
    // Positive semidefinite up to rounding.
    let margin = DMatrix::from_diagonal_element(n, n, 1e-9 * max_abs(&p));
    (&p + margin).cholesky()?;
    Some(Solution {
        p: scaled(&p, 1, 1),
        residual: left.norm() / largest,
    })
}

/// The left side of the equation and the norm of its largest term.
fn equation(
    a: &DMatrix<f64>,
    s: &DMatrix<f64>,
    q: &DMatrix<f64>,
    p: &DMatrix<f64>,
) -> (DMatrix<f64>, f64) {
    let pa = p * a;
    let psp = p * s * p;
    let largest = [pa.norm(), psp.norm(), q.norm()]
        .into_iter()
        .fold(0.0, f64::max);
    (&pa + pa.transpose() - psp + q, largest)
}

/// The geometric mean of the poles of A - S P, 1/s: the eigenvalues of the Hamiltonian are these and their negatives.
fn mean_pole(a: &DMatrix<f64>, s: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<f64> {
    let hamiltonian = join(&[[a, &-s], [&-q, &-a.transpose()]]);
    let size = hamiltonian.nrows();
    // Through logarithms, which cannot overflow.
    let log_det: f64 = hamiltonian
        .lu()
        .u()
        .diagonal()
        .iter()
        .map(|u| u.abs().ln())
        .sum();
    #[expect(clippy::cast_precision_loss, reason = "a few hundred states")]
    let mean = (log_det / size as f64).exp();
    (mean.is_finite() && mean > 0.0).then_some(mean)
}

/// P by doubling, with the Cayley transform about `shift`; with S = 0 this is Smith's method for a Lyapunov equation.
fn doubled(
    a: &DMatrix<f64>,
    s: &DMatrix<f64>,
    q: &DMatrix<f64>,
    shift: f64,
) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let identity = DMatrix::<f64>::identity(n, n);
    let shifted_inverse = (a - &identity * shift).try_inverse()?;
    let hs = q * &shifted_inverse * s;
    let w_inverse = ((a - &identity * shift).transpose() + hs).try_inverse()?;
    // Transition matrix, dual solution and solution of one step.
    let mut transition = &identity + w_inverse.transpose() * (2.0 * shift);
    let mut g = &shifted_inverse * s * &w_inverse * (2.0 * shift);
    let mut h = &w_inverse * q * &shifted_inverse * (2.0 * shift);
    let linear = s.iter().all(|&x| x == 0.0);
    for _ in 0..MAX_DOUBLINGS {
        let size = transition.norm();
        if !size.is_finite() {
            return None;
        }
        if size < CONVERGED {
            return Some((&h + h.transpose()) * 0.5);
        }
        if linear {
            h += transition.transpose() * &h * &transition;
            transition = &transition * &transition;
            continue;
        }
        let lu = (&identity + &g * &h).lu();
        let [next, dual] = [lu.solve(&transition)?, lu.solve(&g)?];
        h += transition.transpose() * (&h * &next);
        g += &transition * dual * transition.transpose();
        transition = &transition * next;
    }
    None
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use crate::synthesis::{ChannelDesign, Preset, feedback_riccati, observer_riccati};

    fn scalar(x: f64) -> DMatrix<f64> {
        DMatrix::from_element(1, 1, x)
    }

    #[test]
    fn val_double_integrator_has_its_textbook_solution() {
        // A = [0 1; 0 0], S = [0 0; 0 1], Q = I: P = [sqrt 3, 1; 1, sqrt 3].
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let s = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
        let found = stabilising_solution(&a, &s, &DMatrix::identity(2, 2)).unwrap();
        let root = 3.0_f64.sqrt();
        let expected = DMatrix::from_row_slice(2, 2, &[root, 1.0, 1.0, root]);
        // A few units in the last place.
        assert!(max_abs(&(found.p - expected)) < 1e-14);
        assert!(found.residual < 1e-15);
    }

    #[test]
    fn has_no_solution_below_the_smallest_attenuation_level() {
        // x' = -x + w + u, cost x^2 + u^2: with S = 1 - 1/rho^2 and A = -1 the Hamiltonian has real eigenvalues
        // +-sqrt(1 + S) while S > -1, rho > 1/sqrt 2.
        let at = |rho: f64| {
            stabilising_solution(&scalar(-1.0), &scalar(1.0 - rho.powi(-2)), &scalar(1.0))
        };
        assert!(at(0.70).is_none());
        assert!(at(0.72).is_some());
    }

    #[test]
    fn has_no_solution_where_a_growing_mode_is_out_of_reach() {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, -1.0]);
        let s = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
        assert!(stabilising_solution(&a, &s, &DMatrix::identity(2, 2)).is_none());
    }

    #[test]
    fn val_filter_of_a_channel_is_that_of_the_sign_function() {
        for preset in Preset::ALL {
            let design: ChannelDesign = preset.designs()[0].1.clone();
            let k = feedback_riccati(&design).unwrap().gain;
            let expected = observer_riccati(&design, &k).unwrap().solution;
            let problem = crate::synthesis::observer::ObserverProblem::fault_tolerant(&design, &k);
            let [a, s, q] = problem.equation(design.rho);
            let found = stabilising_solution(&a, &s, &q).unwrap().p;
            // Relative to the variances of the states, which span ten decades: what Newton's method leaves in either.
            for ((i, j), difference) in entries(&(&found - &expected)) {
                let size = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!(
                    difference.abs() < 1e-9 * size,
                    "{preset:?} {i} {j}: {difference:e}"
                );
            }
        }
    }

    fn entries(m: &DMatrix<f64>) -> impl Iterator<Item = ((usize, usize), f64)> {
        let places = (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| (i, j)));
        places.map(|place| (place, m[place]))
    }
}
