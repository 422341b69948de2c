//! Linear systems: Cholesky factor and solution, LU solution.
//!
//! Each unsafe routine asks of its caller what the symbols exported from it ask.

use nalgebra::{DMatrix, DMatrixViewMut, RealField};

use super::arguments::{Outcome, is_lower, leading, lower_triangle, size, view, view_mut};

pub(super) unsafe fn potrf<T: RealField + Copy>(uplo: u8, n: i32, a: *mut T, lda: i32) -> Outcome {
    let lower = is_lower(uplo).ok_or(-1)?;
    let n = size(n).ok_or(-2)?;
    let lda = leading(lda, n).ok_or(-4)?;
    // SAFETY: the dimensions are those the caller vouches for.
    let mut a = unsafe { view_mut(a, (n, n), lda) };
    let mut factor = lower_triangle(&a.as_view(), lower);
    let outcome = cholesky(&mut factor);
    // A = U'U, with U = L' in place of the upper triangle.
    for j in 0..n {
        for i in j..n {
            a[if lower { (i, j) } else { (j, i) }] = factor[(i, j)];
        }
    }
    outcome.map_err(position)
}

pub(super) unsafe fn potrs<T: RealField + Copy>(
    uplo: u8,
    n: i32,
    nrhs: i32,
    a: *const T,
    lda: i32,
    b: *mut T,
    ldb: i32,
) -> Outcome {
    let lower = is_lower(uplo).ok_or(-1)?;
    let n = size(n).ok_or(-2)?;
    let nrhs = size(nrhs).ok_or(-3)?;
    let lda = leading(lda, n).ok_or(-5)?;
    let ldb = leading(ldb, n).ok_or(-7)?;
    // SAFETY: the dimensions are those the caller vouches for.
    let (a, mut b) = unsafe { (view(a, (n, n), lda), view_mut(b, (n, nrhs), ldb)) };
    let factor = lower_triangle(&a, lower);
    factor.solve_lower_triangular_unchecked_mut(&mut b);
    factor.tr_solve_lower_triangular_unchecked_mut(&mut b);
    Ok(())
}

pub(super) unsafe fn gesv<T: RealField + Copy>(
    n: i32,
    nrhs: i32,
    a: *mut T,
    lda: i32,
    ipiv: *mut i32,
    b: *mut T,
    ldb: i32,
) -> Outcome {
    let n = size(n).ok_or(-1)?;
    let nrhs = size(nrhs).ok_or(-2)?;
    let lda = leading(lda, n).ok_or(-4)?;
    let ldb = leading(ldb, n).ok_or(-7)?;
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the dimensions are those the caller vouches for.
    let (mut a, mut b) = unsafe { (view_mut(a, (n, n), lda), view_mut(b, (n, nrhs), ldb)) };
    let pivots = lu(&mut a);
    for (k, &pivot) in pivots.iter().enumerate() {
        // SAFETY: `ipiv` holds n entries.
        unsafe { ipiv.add(k).write(position(pivot)) };
    }
    if let Some(zero) = (0..n).find(|&k| a[(k, k)].is_zero()) {
        return Err(position(zero));
    }
    for (k, &pivot) in pivots.iter().enumerate() {
        b.swap_rows(k, pivot);
    }
    a.solve_lower_triangular_with_diag_unchecked_mut(&mut b, T::one());
    a.solve_upper_triangular_unchecked_mut(&mut b);
    Ok(())
}

/// Fortran's position of an index. Sizes came from an `i32`, so none is lost.
fn position(index: usize) -> i32 {
    i32::try_from(index + 1).unwrap_or(i32::MAX)
}

/// Replaces the lower triangle by its Cholesky factor, column by column (Golub and Van Loan,
/// Matrix Computations, 4th ed., algorithm 4.2.1). `Err` is the index of the first column whose
/// pivot is not positive; a pivot that is NaN counts as such.
fn cholesky<T: RealField + Copy>(a: &mut DMatrix<T>) -> Result<(), usize> {
    for j in 0..a.nrows() {
        for k in 0..j {
            let factor = -a[(j, k)];
            let (mut column, earlier) = a.columns_range_pair_mut(j, k);
            column
                .rows_range_mut(j..)
                .axpy(factor, &earlier.rows_range(j..), T::one());
        }
        let pivot = a[(j, j)];
        if pivot > T::zero() {
            let root = pivot.sqrt();
            a[(j, j)] = root;
            a.view_range_mut(j + 1.., j).apply(|entry| *entry /= root);
        } else {
            return Err(j);
        }
    }
    Ok(())
}

/// Replaces a square matrix by its factors L (unit diagonal, not stored) and U, rows exchanged so
/// that each pivot is the largest of its column. Returns the row exchanged with each row in turn.
fn lu<T: RealField + Copy>(a: &mut DMatrixViewMut<'_, T>) -> Vec<usize> {
    let n = a.nrows();
    let mut pivots = Vec::with_capacity(n);
    for k in 0..n {
        let pivot = k + a.view_range(k.., k).icamax();
        pivots.push(pivot);
        a.swap_rows(k, pivot);
        let divisor = a[(k, k)];
        if divisor.is_zero() {
            continue;
        }
        a.view_range_mut(k + 1.., k)
            .apply(|entry| *entry /= divisor);
        for j in k + 1..n {
            let factor = -a[(k, j)];
            let (mut column, multipliers) = a.columns_range_pair_mut(j, k);
            column
                .rows_range_mut(k + 1..)
                .axpy(factor, &multipliers.rows_range(k + 1..), T::one());
        }
    }
    pivots
}
