//! Whether the sensors show what a filter must hold.

use nalgebra::{DMatrix, SymmetricEigen};

/// Smallest squared length of what sensors show of a combination of integrals, relative to what they show best, that
/// counts as shown: below it the gains would be a million times as large.
const LEAST_SHOWN: f64 = 1e-12;

/// A combination of the integrals of the n channels, a factor each, that no sensor shows, if there is one; C is l x 3n.
///
/// A filter has a stabilising solution only if no eigenvector of Abar to an eigenvalue with Re >= 0 is hidden from the
/// sensors (Popov, Belevitch and Hautus; weaker than the paper's Assumption 4.1, which asks it of every eigenvalue and
/// does not hold for the delay taps even of the paper's own C). The fault models decay, so that 0 is the only such
/// eigenvalue, and its eigenvectors are the integrals, which drive nothing. So C must have full rank on them.
pub(super) fn hidden_integral(c: &DMatrix<f64>, n: usize) -> Option<Vec<f64>> {
    let of_integrals = c.columns(0, n);
    let shown = SymmetricEigen::new(of_integrals.tr_mul(&of_integrals));
    let best = shown.eigenvalues.max();
    let (least, value) = shown.eigenvalues.argmin();
    let is_hidden = best <= 0.0 || value <= LEAST_SHOWN * best;
    is_hidden.then(|| shown.eigenvectors.column(least).iter().copied().collect())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use crate::synthesis::full_order::doubling::stabilising_solution;
    use crate::synthesis::observer::ObserverProblem;
    use crate::synthesis::{Preset, augmented_channel, feedback_riccati};

    /// Rows of C of one channel.
    const INTEGRAL: [f64; 3] = [1.0, 0.0, 0.0];
    const POSITION: [f64; 3] = [0.0, 1.0, 0.0];
    const RATE: [f64; 3] = [0.0, 0.0, 1.0];

    /// Sensors of one channel, and whether a filter exists.
    struct Case {
        rows: &'static [[f64; 3]],
        /// How the sensor fault enters them.
        fault: &'static [f64],
        has_filter: bool,
    }

    const fn case(rows: &'static [[f64; 3]], fault: &'static [f64], has_filter: bool) -> Case {
        Case {
            rows,
            fault,
            has_filter,
        }
    }

    const CASES: [Case; 7] = [
        case(&[INTEGRAL, POSITION, RATE], &[0.0, 0.0, 1.0], true),
        case(&[RATE], &[1.0], false),
        case(&[INTEGRAL, RATE], &[0.0, 1.0], true),
        case(&[POSITION], &[1.0], false),
        case(&[POSITION], &[0.0], false),
        case(&[INTEGRAL, POSITION], &[0.0, 1.0], true),
        case(&[INTEGRAL, POSITION, RATE], &[1.0, 1.0, 1.0], true),
    ];

    #[test]
    fn val_rank_on_the_integrals_decides_as_the_whole_test_and_the_riccati_equation_do() {
        let design = Preset::UavPaper.designs()[0].1.clone();
        let k = feedback_riccati(&design).unwrap().gain;
        for Case {
            rows,
            fault,
            has_filter,
        } in CASES
        {
            let c = DMatrix::from_fn(rows.len(), 3, |i, j| rows[i][j]);
            let mut problem = ObserverProblem::fault_tolerant(&design, &k);
            problem.channel = augmented_channel(&design);
            problem.channel.c = c.clone().resize_horizontally(design.states(), 0.0);
            let f2 = 3 + design.smoothing.taps()[0];
            problem
                .channel
                .c
                .set_column(f2, &nalgebra::DVector::from_column_slice(fault));
            problem.noise = vec![design.nu; rows.len()];

            // [z I - A; C] at the only eigenvalue with Re >= 0, z = 0: its smallest singular value.
            let (a, all) = (&problem.channel.a, &problem.channel.c);
            let gram = a.tr_mul(a) + all.tr_mul(all);
            let least = SymmetricEigen::new(gram).eigenvalues.min();
            assert_eq!(least > 1e-9, has_filter, "{rows:?} {least:e}");
            let [a, s, q] = problem.equation(design.rho);
            assert_eq!(
                stabilising_solution(&a, &s, &q).is_some(),
                has_filter,
                "{rows:?}"
            );
            assert_eq!(hidden_integral(&c, 1).is_none(), has_filter, "{rows:?}");
        }
    }

    #[test]
    fn combination_that_no_sensor_shows_is_named() {
        // Two sensors of x + 2 y: 2 x - y is hidden.
        let c = DMatrix::from_row_slice(
            2,
            6,
            &[
                1.0, 2.0, 0.0, 0.0, 0.0, 0.0, //
                1.0, 2.0, 0.0, 1.0, 0.0, 0.0,
            ],
        );
        let hidden = hidden_integral(&c, 2).unwrap();
        assert!((hidden[0] + 2.0 * hidden[1]).abs() < 1e-12 && hidden[0].abs() > 0.8);
    }
}
