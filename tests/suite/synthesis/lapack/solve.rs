// Linear systems in the precision `Real`, against nalgebra's solutions in double precision.

use super::super::{PADDINGS, Stored, all_double, assert_close, in_triangle, int, only_triangle, random, random_definite};
use nalgebra::DMatrix;

/// Factors of matrices of up to 12 rows with entries up to 10: some hundred roundings of numbers
/// of that size.
const TOLERANCE: f64 = 2000.0 * EPSILON;

/// Solutions are worse than factors by the condition number, which is below 100 here.
const SOLUTION_TOLERANCE: f64 = 100.0 * TOLERANCE;

#[test]
fn val_potrf_and_potrs_match_nalgebra() {
    for n in [1, 4, 12] {
        for uplo in [b'U', b'L', b'u'] {
            for padding in PADDINGS {
                let definite = random_definite::<Real>(n, 20);
                let uplo_upper = uplo.to_ascii_uppercase();
                let before = Stored::new(&only_triangle(uplo_upper, &definite, padding), padding);
                let mut factor = before.clone();
                let right_side = Stored::new(&random(n, 3, 21), padding);
                let mut solution = right_side.clone();
                let (mut info, mut solved) = (7, 7);
                // SAFETY: the arrays have the sizes passed.
                unsafe {
                    potrf(
                        &uplo,
                        &int(n),
                        factor.data.as_mut_ptr(),
                        &factor.ld(),
                        &mut info,
                    );
                    potrs(
                        &uplo,
                        &int(n),
                        &3,
                        factor.data.as_ptr(),
                        &factor.ld(),
                        solution.data.as_mut_ptr(),
                        &solution.ld(),
                        &mut solved,
                    );
                }
                assert_eq!((info, solved), (0, 0));
                let cholesky = all_double(&definite).cholesky().expect("definite");
                let expected = if uplo_upper == b'L' {
                    cholesky.l()
                } else {
                    cholesky.l().transpose()
                };
                assert_close(
                    &only_triangle(uplo_upper, &factor.matrix(), 0.0),
                    &expected,
                    TOLERANCE,
                );
                factor.assert_untouched(&before, |i, j| in_triangle(uplo_upper, i, j));
                let expected = cholesky.solve(&right_side.matrix());
                assert_close(&solution.matrix(), &expected, SOLUTION_TOLERANCE);
                solution.assert_untouched(&right_side, |_, _| true);
            }
        }
    }
}

#[test]
fn potrf_reports_the_order_of_the_first_minor_that_is_not_positive() {
    for (position, value) in [(0, -1.0), (3, -1.0), (5, -1.0), (2, Real::NAN), (4, 0.0)] {
        for uplo in [b'U', b'L'] {
            let mut a = DMatrix::<Real>::identity(6, 6);
            a[(position, position)] = value;
            let mut stored = Stored::new(&a, 0.0);
            let mut info = 0;
            // SAFETY: the arrays have the sizes passed.
            unsafe { potrf(&uplo, &6, stored.data.as_mut_ptr(), &stored.ld(), &mut info) };
            assert_eq!(info, int(position + 1));
        }
    }
}

#[test]
fn val_gesv_matches_nalgebra() {
    for n in [1, 4, 12] {
        for padding in PADDINGS {
            let mut matrix = random::<Real>(n, n, 22);
            if n > 1 {
                // Without an exchange of rows the first pivot would be zero.
                matrix[(0, 0)] = 0.0;
            }
            let before = Stored::new(&matrix, padding);
            let right_side = Stored::new(&random(n, 2, 23), padding);
            let (mut factors, mut solution) = (before.clone(), right_side.clone());
            let mut pivots = vec![0; n];
            let mut info = 7;
            // SAFETY: the arrays have the sizes passed.
            unsafe {
                gesv(
                    &int(n),
                    &2,
                    factors.data.as_mut_ptr(),
                    &factors.ld(),
                    pivots.as_mut_ptr(),
                    solution.data.as_mut_ptr(),
                    &solution.ld(),
                    &mut info,
                );
            }
            assert_eq!(info, 0);
            let lu = factors.matrix();
            let mut lower = only_triangle(b'L', &lu, 0.0);
            lower.fill_diagonal(1.0);
            let mut permuted = all_double(&matrix);
            for (row, &pivot) in pivots.iter().enumerate() {
                permuted.swap_rows(row, usize::try_from(pivot - 1).expect("counted from 1"));
            }
            assert_close(
                &(&lower * only_triangle(b'U', &lu, 0.0)),
                &permuted,
                TOLERANCE,
            );
            assert!(
                lower.amax() <= 1.0,
                "a pivot was not the largest of its column"
            );
            factors.assert_untouched(&before, |_, _| true);
            let expected = all_double(&matrix)
                .lu()
                .solve(&right_side.matrix())
                .expect("regular");
            assert_close(&solution.matrix(), &expected, SOLUTION_TOLERANCE);
            solution.assert_untouched(&right_side, |_, _| true);
        }
    }
}

#[test]
fn gesv_reports_the_first_zero_pivot_and_leaves_the_right_side() {
    // The third row is the sum of the others, exactly.
    let mut a: [Real; 9] = [1.0, 0.0, 1.0, 0.0, 2.0, 2.0, 0.0, 1.0, 1.0];
    let mut b: [Real; 3] = [5.0, 6.0, 7.0];
    let (mut pivots, mut info) = ([0; 3], 0);
    // SAFETY: the arrays have the sizes passed.
    unsafe {
        gesv(
            &3,
            &1,
            a.as_mut_ptr(),
            &3,
            pivots.as_mut_ptr(),
            b.as_mut_ptr(),
            &3,
            &mut info,
        );
    }
    assert_eq!((info, b), (3, [5.0, 6.0, 7.0]));
}

#[test]
fn illegal_arguments_are_reported_by_position() {
    let (mut a, mut b): ([Real; 16], [Real; 4]) = ([2.0; 16], [3.0; 4]);
    let (mut pivots, mut info) = ([0; 4], 0);
    let mut reported = vec![];
    // SAFETY: nothing is reached, as each call has an illegal argument.
    unsafe {
        for (uplo, n, ld) in [(b'X', 4, 4), (b'U', -1, 4), (b'L', 4, 3)] {
            potrf(&uplo, &n, a.as_mut_ptr(), &ld, &mut info);
            reported.push(info);
            potrs(
                &uplo,
                &n,
                &1,
                a.as_ptr(),
                &ld,
                b.as_mut_ptr(),
                &4,
                &mut info,
            );
            reported.push(info);
        }
        for (nrhs, ldb) in [(-1, 4), (1, 3)] {
            potrs(
                &b'L',
                &4,
                &nrhs,
                a.as_ptr(),
                &4,
                b.as_mut_ptr(),
                &ldb,
                &mut info,
            );
            reported.push(info);
        }
        for (n, nrhs, lda, ldb) in [(-1, 1, 4, 4), (4, -1, 4, 4), (4, 1, 3, 4), (4, 1, 4, 3)] {
            gesv(
                &n,
                &nrhs,
                a.as_mut_ptr(),
                &lda,
                pivots.as_mut_ptr(),
                b.as_mut_ptr(),
                &ldb,
                &mut info,
            );
            reported.push(info);
        }
    }
    assert_eq!(reported, [-1, -1, -2, -2, -4, -5, -3, -7, -1, -2, -4, -7]);
    assert_eq!((a, b), ([2.0; 16], [3.0; 4]));
}
