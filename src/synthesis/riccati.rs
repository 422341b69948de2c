//! The stabilising solution of an algebraic Riccati equation.
//!
//! Matrix sign function of the Hamiltonian (J. D. Roberts, Int. J. Control 32,
//! 1980) with determinantal scaling (R. Byers, Linear Algebra Appl. 85, 1987),
//! then Newton steps in balanced coordinates, which give back the digits
//! that a badly scaled Hamiltonian loses.

use super::linalg::{eigenvalues, lyapunov, max_abs, power_of_two_near, symmetric_eigenvalues};
use nalgebra::DMatrix;

const MAX_SIGN_ITERATIONS: usize = 100;
const MAX_NEWTON_STEPS: usize = 30;

/// The stabilising solution P >= 0 of `A' P + P A - P S P + Q = 0`, with
/// symmetric S (indefinite in H-infinity problems) and Q.
///
/// `None` where none exists: the Hamiltonian has eigenvalues on the imaginary
/// axis, P is not positive semidefinite, or A - S P is not Hurwitz.
pub(super) fn stabilising_solution(
    a: &DMatrix<f64>,
    s: &DMatrix<f64>,
    q: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    // P = c P_hat makes the two off-diagonal blocks equally large.
    let c = (max_abs(q) / max_abs(s)).sqrt();
    let rough = sign_solution(a, &(s * c), &(q / c))? * c;

    // Coordinates in which the diagonal of P is one, by exact powers of two.
    let balance: Vec<f64> = (0..n)
        .map(|i| power_of_two_near(rough[(i, i)].abs().sqrt()))
        .collect();
    let scaled = |m: &DMatrix<f64>, row: i32, col: i32| {
        DMatrix::from_fn(n, n, |i, j| {
            m[(i, j)] * balance[i].powi(row) * balance[j].powi(col)
        })
    };
    let a_scaled = scaled(a, 1, -1);
    let s_scaled = scaled(s, 1, 1);
    let q_scaled = scaled(q, -1, -1);
    let p_scaled = refine(&a_scaled, &s_scaled, &q_scaled, scaled(&rough, -1, -1))?;

    let semidefinite = *symmetric_eigenvalues(&p_scaled)?.first()? > -1e-9 * max_abs(&p_scaled);
    let hurwitz = eigenvalues(&(&a_scaled - &s_scaled * &p_scaled))?
        .iter()
        .all(|pole| pole.re < 0.0);
    (semidefinite && hurwitz).then(|| scaled(&p_scaled, 1, 1))
}

/// The smallest feasible level above an infeasible one, on the feasible side;
/// `None` if there is none up to 1e12.
///
/// To four digits: at the border itself the Hamiltonian's eigenvalues reach the
/// imaginary axis in pairs, and rounding decides within about 1e-4.
pub(super) fn smallest_feasible(feasible: impl Fn(f64) -> bool, infeasible: f64) -> Option<f64> {
    let mut low = infeasible;
    let mut high = 2.0 * infeasible;
    while !feasible(high) {
        low = high;
        high *= 2.0;
        if high > 1e12 {
            return None;
        }
    }
    while high / low > 1.0 + 1e-5 {
        let middle = (low * high).sqrt();
        if feasible(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}

/// P from the stable invariant subspace of the Hamiltonian, by its matrix sign.
fn sign_solution(a: &DMatrix<f64>, s: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let mut z = DMatrix::zeros(2 * n, 2 * n);
    z.view_mut((0, 0), (n, n)).copy_from(a);
    z.view_mut((0, n), (n, n)).copy_from(&-s);
    z.view_mut((n, 0), (n, n)).copy_from(&-q);
    z.view_mut((n, n), (n, n)).copy_from(&-a.transpose());

    let mut converged = false;
    for _ in 0..MAX_SIGN_ITERATIONS {
        let lu = z.clone().lu();
        // |det Z|^(1/2n) through logarithms, which cannot overflow.
        let log_det: f64 = lu.u().diagonal().iter().map(|u| u.abs().ln()).sum();
        #[expect(clippy::cast_precision_loss, reason = "a few dozen states")]
        let mu = (log_det / (2 * n) as f64).exp();
        if !(mu.is_finite() && mu > 0.0) {
            return None;
        }
        let next = (&z / mu + lu.try_inverse()? * mu) * 0.5;
        let change = (&next - &z).norm();
        z = next;
        if !change.is_finite() {
            return None;
        }
        if change <= 1e-9 * z.norm() {
            converged = true;
            break;
        }
    }
    if !converged {
        return None;
    }

    // (sign + I) [I; P] = 0, in the least-squares sense.
    let identity = DMatrix::<f64>::identity(n, n);
    let mut left = DMatrix::zeros(2 * n, n);
    left.view_mut((0, 0), (n, n))
        .copy_from(&z.view((0, n), (n, n)));
    left.view_mut((n, 0), (n, n))
        .copy_from(&(z.view((n, n), (n, n)) + &identity));
    let mut right = DMatrix::zeros(2 * n, n);
    right
        .view_mut((0, 0), (n, n))
        .copy_from(&-(z.view((0, 0), (n, n)) + &identity));
    right
        .view_mut((n, 0), (n, n))
        .copy_from(&-z.view((n, 0), (n, n)));
    let p = left.svd(true, true).solve(&right, f64::EPSILON).ok()?;
    Some((&p + p.transpose()) * 0.5)
}

/// Newton's method on the Riccati residual from a stabilising start.
fn refine(
    a: &DMatrix<f64>,
    s: &DMatrix<f64>,
    q: &DMatrix<f64>,
    start: DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let mut p = start;
    let mut last_step = f64::INFINITY;
    for _ in 0..MAX_NEWTON_STEPS {
        let residual = a.transpose() * &p + &p * a - &p * s * &p + q;
        let step = lyapunov(&(a - s * &p), &residual)?;
        let size = max_abs(&step) / max_abs(&p);
        // Rounding has taken over once the steps no longer shrink.
        if !size.is_finite() || (size >= last_step && last_step < 1e-6) {
            break;
        }
        p += step;
        last_step = size;
        if size < 1e-15 {
            break;
        }
    }
    (last_step < 1e-6).then_some(p)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;

    #[test]
    fn val_double_integrator_has_its_textbook_solution() {
        // A = [0 1; 0 0], S = [0 0; 0 1], Q = I: P = [sqrt 3, 1; 1, sqrt 3].
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let s = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
        let p = stabilising_solution(&a, &s, &DMatrix::identity(2, 2)).unwrap();
        let root = 3.0_f64.sqrt();
        let expected = DMatrix::from_row_slice(2, 2, &[root, 1.0, 1.0, root]);
        // A few units in the last place.
        assert!(max_abs(&(p - expected)) < 1e-14);
    }

    #[test]
    fn has_no_solution_below_the_smallest_attenuation_level() {
        // x' = -x + w + u, cost x^2 + u^2: with S = 1 - 1/rho^2 and A = -1 the
        // Hamiltonian has real eigenvalues +-sqrt(1 + S) while S > -1, rho > 1/sqrt 2.
        let scalar = |x: f64| DMatrix::from_element(1, 1, x);
        let at = |rho: f64| {
            stabilising_solution(&scalar(-1.0), &scalar(1.0 - rho.powi(-2)), &scalar(1.0))
        };
        assert!(at(0.70).is_none());
        assert!(at(0.72).is_some());
    }

    #[test]
    fn scaling_of_the_states_does_not_cost_digits() {
        // The same problem in states scaled by 1e-4 and 1e3.
        let t = DMatrix::from_row_slice(2, 2, &[1e-4, 0.0, 0.0, 1e3]);
        let inverse = t.clone().try_inverse().unwrap();
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let s = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
        let p = stabilising_solution(&(&inverse * a * &t), &(&inverse * s * &inverse), &(&t * &t))
            .unwrap();
        let back = &inverse * p * &inverse;
        let root = 3.0_f64.sqrt();
        let expected = DMatrix::from_row_slice(2, 2, &[root, 1.0, 1.0, root]);
        assert!(max_abs(&(back - expected)) < 1e-12);
    }
}
