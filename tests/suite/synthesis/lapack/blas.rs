// BLAS in the precision `Real`, against products formed by nalgebra in double precision.

use super::super::{PADDINGS, Stored, all_double, assert_close, double, in_triangle, int, only_triangle, random, random_symmetric};
use nalgebra::DMatrix;

/// The cases that BLAS treats apart, and one that it does not.
const FACTORS: [Real; 3] = [0.0, 1.0, -0.75];

/// Sums of at most 20 products of numbers up to 2, each rounded once, and some for the reference.
const TOLERANCE: f64 = 100.0 * EPSILON;

fn op(trans: u8, matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if trans.eq_ignore_ascii_case(&b'N') {
        matrix.clone()
    } else {
        matrix.transpose()
    }
}

/// A random matrix stored so that op gives it the shape asked for.
fn operand(trans: u8, rows: usize, columns: usize, seed: u64) -> DMatrix<Real> {
    if trans.eq_ignore_ascii_case(&b'N') {
        random(rows, columns, seed)
    } else {
        random(columns, rows, seed)
    }
}

/// Zero times anything is zero in BLAS, as it is not read: NaN must not get through.
fn unless_ignored(factor: Real, matrix: &DMatrix<Real>) -> DMatrix<Real> {
    if factor == 0.0 {
        matrix.map(|_| Real::NAN)
    } else {
        matrix.clone()
    }
}

/// Zero where the factor is, even times NaN.
fn scaled(factor: Real, matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.map(|x| {
        if factor == 0.0 {
            0.0
        } else {
            double(factor) * x
        }
    })
}

fn factors() -> impl Iterator<Item = (Real, Real, f64)> {
    FACTORS.into_iter().flat_map(|alpha| {
        FACTORS
            .into_iter()
            .flat_map(move |beta| PADDINGS.map(|padding| (alpha, beta, padding)))
    })
}

#[test]
fn val_gemm_matches_nalgebra() {
    // Below and above the size from which nalgebra multiplies in blocks; without a sum.
    for (m, n, k) in [(3, 4, 2), (9, 7, 8), (20, 20, 20), (1, 1, 1), (6, 7, 0)] {
        for (transa, transb) in
            [b"NN", b"NT", b"TN", b"TT", b"nc", b"CN", b"tt"].map(|&[a, b]| (a, b))
        {
            for (alpha, beta, padding) in factors() {
                let a = unless_ignored(alpha, &operand(transa, m, k, 1));
                let b = unless_ignored(alpha, &operand(transb, k, n, 2));
                let c = unless_ignored(beta, &random(m, n, 3));
                let expected = scaled(
                    alpha,
                    &(op(transa, &all_double(&a)) * op(transb, &all_double(&b))),
                ) + scaled(beta, &all_double(&c));

                let (a, b) = (Stored::new(&a, padding), Stored::new(&b, padding));
                let before = Stored::new(&c, padding);
                let mut c = before.clone();
                // SAFETY: the arrays have the sizes passed.
                unsafe {
                    gemm(
                        &transa,
                        &transb,
                        &int(m),
                        &int(n),
                        &int(k),
                        &alpha,
                        a.data.as_ptr(),
                        &a.ld(),
                        b.data.as_ptr(),
                        &b.ld(),
                        &beta,
                        c.data.as_mut_ptr(),
                        &c.ld(),
                    );
                }
                assert_close(&c.matrix(), &expected, TOLERANCE);
                c.assert_untouched(&before, |_, _| true);
            }
        }
    }
}

#[test]
fn gemm_tells_a_matrix_from_its_transpose() {
    let a = Stored::new(&random(7, 7, 4), 0.0);
    let product = |trans: u8| {
        let mut c = Stored::new(&DMatrix::zeros(7, 7), 0.0);
        // SAFETY: the arrays have the sizes passed.
        unsafe {
            gemm(
                &trans,
                &b'N',
                &7,
                &7,
                &7,
                &1.0,
                a.data.as_ptr(),
                &a.ld(),
                a.data.as_ptr(),
                &a.ld(),
                &0.0,
                c.data.as_mut_ptr(),
                &c.ld(),
            );
        }
        c.matrix()
    };
    // Far above the tolerance of the comparison with nalgebra, which would thus notice a mix-up.
    assert!((product(b'N') - product(b'T')).amax() > 1e4 * TOLERANCE);
}

#[test]
fn val_syrk_and_syr2k_match_nalgebra() {
    for (n, k) in [(4, 3), (9, 7), (12, 20), (3, 0)] {
        for (uplo, trans) in [b"UN", b"UT", b"LN", b"LT", b"LC"].map(|&[u, t]| (u, t)) {
            for (alpha, beta, padding) in factors() {
                let a = unless_ignored(alpha, &operand(trans, n, k, 5));
                let b = unless_ignored(alpha, &operand(trans, n, k, 6));
                let c = unless_ignored(beta, &random_symmetric(n, 7));
                let (op_a, op_b) = (op(trans, &all_double(&a)), op(trans, &all_double(&b)));
                let square = &op_a * op_a.transpose();
                let mixed = &op_a * op_b.transpose() + &op_b * op_a.transpose();
                let increased = |product| scaled(alpha, &product) + scaled(beta, &all_double(&c));

                let (a, b) = (Stored::new(&a, padding), Stored::new(&b, padding));
                let before = Stored::new(&only_triangle(uplo, &c, padding), padding);
                let (mut rank_k, mut rank_2k) = (before.clone(), before.clone());
                // SAFETY: the arrays have the sizes passed.
                unsafe {
                    syrk(
                        &uplo,
                        &trans,
                        &int(n),
                        &int(k),
                        &alpha,
                        a.data.as_ptr(),
                        &a.ld(),
                        &beta,
                        rank_k.data.as_mut_ptr(),
                        &before.ld(),
                    );
                    syr2k(
                        &uplo,
                        &trans,
                        &int(n),
                        &int(k),
                        &alpha,
                        a.data.as_ptr(),
                        &a.ld(),
                        b.data.as_ptr(),
                        &b.ld(),
                        &beta,
                        rank_2k.data.as_mut_ptr(),
                        &before.ld(),
                    );
                }
                for (updated, expected) in
                    [(rank_k, increased(square)), (rank_2k, increased(mixed))]
                {
                    assert_close(
                        &only_triangle(uplo, &updated.matrix(), 0.0),
                        &only_triangle(uplo, &expected, 0.0),
                        TOLERANCE,
                    );
                    updated.assert_untouched(&before, |i, j| in_triangle(uplo, i, j));
                }
            }
        }
    }
}

/// What lies between the entries of a vector.
const GAP: Real = -3.5;

/// A vector in memory: entries `step` apart, backwards if negative, numbers between them.
fn spread(vector: &DMatrix<Real>, step: i32) -> Vec<Real> {
    let stride = step.unsigned_abs() as usize;
    let mut memory = vec![GAP; vector.len() * stride];
    for (i, &x) in vector.iter().enumerate() {
        let place = if step < 0 { vector.len() - 1 - i } else { i };
        memory[place * stride] = x;
    }
    memory
}

#[test]
fn val_gemv_and_symv_match_nalgebra() {
    for (m, n) in [(3, 5), (8, 7), (1, 1)] {
        for (incx, incy) in [(1, 1), (2, -1), (-3, 2)] {
            for (alpha, beta, padding) in factors() {
                for trans in [b'N', b'T', b'c'] {
                    let a = unless_ignored(alpha, &random(m, n, 8));
                    let op_a = op(trans, &all_double(&a));
                    let x = unless_ignored(alpha, &random(op_a.ncols(), 1, 9));
                    let y = unless_ignored(beta, &random(op_a.nrows(), 1, 10));
                    let expected =
                        scaled(alpha, &(op_a * all_double(&x))) + scaled(beta, &all_double(&y));
                    let a = Stored::new(&a, padding);
                    let (x, mut result) = (spread(&x, incx), spread(&y, incy));
                    // SAFETY: the arrays have the sizes passed.
                    unsafe {
                        gemv(
                            &trans,
                            &int(m),
                            &int(n),
                            &alpha,
                            a.data.as_ptr(),
                            &a.ld(),
                            x.as_ptr(),
                            &incx,
                            &beta,
                            result.as_mut_ptr(),
                            &incy,
                        );
                    }
                    assert_spread(&result, &expected, incy);
                }
                for uplo in [b'U', b'L'] {
                    let a = unless_ignored(alpha, &random_symmetric(n, 11));
                    let x = unless_ignored(alpha, &random(n, 1, 12));
                    let y = unless_ignored(beta, &random(n, 1, 13));
                    let expected = scaled(alpha, &(all_double(&a) * all_double(&x)))
                        + scaled(beta, &all_double(&y));
                    let a = Stored::new(&only_triangle(uplo, &a, padding), padding);
                    let (x, mut result) = (spread(&x, incx), spread(&y, incy));
                    // SAFETY: the arrays have the sizes passed.
                    unsafe {
                        symv(
                            &uplo,
                            &int(n),
                            &alpha,
                            a.data.as_ptr(),
                            &a.ld(),
                            x.as_ptr(),
                            &incx,
                            &beta,
                            result.as_mut_ptr(),
                            &incy,
                        );
                    }
                    assert_spread(&result, &expected, incy);
                }
            }
        }
    }
}

/// Asserts the entries of a vector in memory, and that nothing between them was written.
fn assert_spread(memory: &[Real], expected: &DMatrix<f64>, step: i32) {
    let stride = step.unsigned_abs() as usize;
    let entries = DMatrix::from_fn(expected.nrows(), 1, |i, _| {
        let place = if step < 0 {
            expected.nrows() - 1 - i
        } else {
            i
        };
        double(memory[place * stride])
    });
    assert_close(&entries, expected, TOLERANCE);
    let gaps = memory.iter().enumerate().filter(|(i, _)| i % stride != 0);
    gaps.for_each(|(i, &x)| assert_eq!(x.to_bits(), GAP.to_bits(), "{i} lies between two entries"));
}

#[test]
fn products_with_illegal_arguments_change_nothing() {
    let a = [1.0 as Real; 9];
    let mut c = [2.0 as Real; 9];
    // SAFETY: nothing beyond 3 x 3 is reached, whichever of the arguments is wrong.
    unsafe {
        for (transa, m, ldc, inc) in [(b'X', 3, 3, 1), (b'N', -1, 3, 1), (b'N', 3, 2, 0)] {
            gemm(
                &transa,
                &b'N',
                &m,
                &3,
                &3,
                &1.0,
                a.as_ptr(),
                &3,
                a.as_ptr(),
                &3,
                &0.0,
                c.as_mut_ptr(),
                &ldc,
            );
            syrk(
                &transa,
                &b'N',
                &m,
                &3,
                &1.0,
                a.as_ptr(),
                &3,
                &0.0,
                c.as_mut_ptr(),
                &ldc,
            );
            syr2k(
                &transa,
                &b'N',
                &m,
                &3,
                &1.0,
                a.as_ptr(),
                &3,
                a.as_ptr(),
                &3,
                &0.0,
                c.as_mut_ptr(),
                &ldc,
            );
            gemv(
                &transa,
                &m,
                &3,
                &1.0,
                a.as_ptr(),
                &3,
                a.as_ptr(),
                &1,
                &0.0,
                c.as_mut_ptr(),
                &inc,
            );
            symv(
                &transa,
                &m,
                &1.0,
                a.as_ptr(),
                &3,
                a.as_ptr(),
                &1,
                &0.0,
                c.as_mut_ptr(),
                &inc,
            );
        }
    }
    assert_eq!(c.map(Real::to_bits), [2.0; 9].map(Real::to_bits));
}
