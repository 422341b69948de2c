//! Products of matrices and vectors (BLAS levels 2 and 3).
//!
//! Each unsafe routine asks of its caller what the symbols exported from it ask.

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, DVector, RealField};

use super::arguments::{
    Outcome, is_lower, is_transposed, leading, lower_triangle, size, view, view_mut,
};

pub(super) unsafe fn gemm<T: RealField + Copy>(
    transa: u8,
    transb: u8,
    m: i32,
    n: i32,
    k: i32,
    alpha: T,
    a: *const T,
    lda: i32,
    b: *const T,
    ldb: i32,
    beta: T,
    c: *mut T,
    ldc: i32,
) -> Outcome {
    let transa = is_transposed(transa).ok_or(-1)?;
    let transb = is_transposed(transb).ok_or(-2)?;
    let m = size(m).ok_or(-3)?;
    let n = size(n).ok_or(-4)?;
    let k = size(k).ok_or(-5)?;
    let lda = leading(lda, if transa { k } else { m }).ok_or(-8)?;
    let ldb = leading(ldb, if transb { n } else { k }).ok_or(-10)?;
    let ldc = leading(ldc, m).ok_or(-13)?;
    // SAFETY: the dimensions are those the caller vouches for.
    let (a, b, mut c) = unsafe {
        (
            view(a, stored(transa, m, k), lda),
            view(b, stored(transb, k, n), ldb),
            view_mut(c, (m, n), ldc),
        )
    };
    if k == 0 || alpha.is_zero() {
        c.apply(|entry| *entry = scaled(beta, entry));
        return Ok(());
    }
    let (a_transposed, b_transposed);
    let a = if transa {
        a_transposed = a.transpose();
        a_transposed.as_view()
    } else {
        a
    };
    let b = if transb {
        b_transposed = b.transpose();
        b_transposed.as_view()
    } else {
        b
    };
    c.gemm(alpha, &a, &b, beta);
    Ok(())
}

pub(super) unsafe fn gemv<T: RealField + Copy>(
    trans: u8,
    m: i32,
    n: i32,
    alpha: T,
    a: *const T,
    lda: i32,
    x: *const T,
    incx: i32,
    beta: T,
    y: *mut T,
    incy: i32,
) -> Outcome {
    let trans = is_transposed(trans).ok_or(-1)?;
    let m = size(m).ok_or(-2)?;
    let n = size(n).ok_or(-3)?;
    let lda = leading(lda, m).ok_or(-6)?;
    let incx = increment(incx).ok_or(-8)?;
    let incy = increment(incy).ok_or(-11)?;
    if m == 0 || n == 0 {
        return Ok(());
    }
    let (rows, columns) = stored(trans, m, n);
    // SAFETY: the dimensions and increments are those the caller vouches for.
    unsafe {
        let a = view(a, (m, n), lda);
        update_vector(y, incy, rows, beta, |sum| match (alpha.is_zero(), trans) {
            (true, _) => {}
            (false, false) => sum.gemv(alpha, &a, &gather(x, incx, columns), T::one()),
            (false, true) => sum.gemv_tr(alpha, &a, &gather(x, incx, columns), T::one()),
        });
    }
    Ok(())
}

pub(super) unsafe fn symv<T: RealField + Copy>(
    uplo: u8,
    n: i32,
    alpha: T,
    a: *const T,
    lda: i32,
    x: *const T,
    incx: i32,
    beta: T,
    y: *mut T,
    incy: i32,
) -> Outcome {
    let lower = is_lower(uplo).ok_or(-1)?;
    let n = size(n).ok_or(-2)?;
    let lda = leading(lda, n).ok_or(-5)?;
    let incx = increment(incx).ok_or(-7)?;
    let incy = increment(incy).ok_or(-10)?;
    // SAFETY: the dimensions and increments are those the caller vouches for.
    unsafe {
        let a = view(a, (n, n), lda);
        update_vector(y, incy, n, beta, |sum| {
            if !alpha.is_zero() {
                let a = lower_triangle(&a, lower);
                sum.sygemv(alpha, &a, &gather(x, incx, n), T::one());
            }
        });
    }
    Ok(())
}

pub(super) unsafe fn syrk<T: RealField + Copy>(
    uplo: u8,
    trans: u8,
    n: i32,
    k: i32,
    alpha: T,
    a: *const T,
    lda: i32,
    beta: T,
    c: *mut T,
    ldc: i32,
) -> Outcome {
    let lower = is_lower(uplo).ok_or(-1)?;
    let trans = is_transposed(trans).ok_or(-2)?;
    let n = size(n).ok_or(-3)?;
    let k = size(k).ok_or(-4)?;
    let lda = leading(lda, if trans { k } else { n }).ok_or(-7)?;
    let ldc = leading(ldc, n).ok_or(-10)?;
    // SAFETY: the dimensions are those the caller vouches for.
    let (a, mut c) = unsafe { (view(a, stored(trans, n, k), lda), view_mut(c, (n, n), ldc)) };
    let product = outer_product(trans, alpha, &a, &a);
    update_triangle(&mut c, lower, beta, |i, j| product[(i, j)]);
    Ok(())
}

pub(super) unsafe fn syr2k<T: RealField + Copy>(
    uplo: u8,
    trans: u8,
    n: i32,
    k: i32,
    alpha: T,
    a: *const T,
    lda: i32,
    b: *const T,
    ldb: i32,
    beta: T,
    c: *mut T,
    ldc: i32,
) -> Outcome {
    let lower = is_lower(uplo).ok_or(-1)?;
    let trans = is_transposed(trans).ok_or(-2)?;
    let n = size(n).ok_or(-3)?;
    let k = size(k).ok_or(-4)?;
    let stored_rows = if trans { k } else { n };
    let lda = leading(lda, stored_rows).ok_or(-7)?;
    let ldb = leading(ldb, stored_rows).ok_or(-9)?;
    let ldc = leading(ldc, n).ok_or(-12)?;
    // SAFETY: the dimensions are those the caller vouches for.
    let (a, b, mut c) = unsafe {
        (
            view(a, stored(trans, n, k), lda),
            view(b, stored(trans, n, k), ldb),
            view_mut(c, (n, n), ldc),
        )
    };
    // The second term is the transpose of the first, so one product serves both.
    let product = outer_product(trans, alpha, &a, &b);
    update_triangle(&mut c, lower, beta, |i, j| {
        product[(i, j)] + product[(j, i)]
    });
    Ok(())
}

/// The shape in which the matrix A is stored whose `op(A)` has the given one.
fn stored(transposed: bool, rows: usize, columns: usize) -> (usize, usize) {
    if transposed {
        (columns, rows)
    } else {
        (rows, columns)
    }
}

/// `alpha op(A) op(B)'`; A and B are not read where `alpha` is zero.
fn outer_product<T: RealField + Copy>(
    transposed: bool,
    alpha: T,
    a: &DMatrixView<'_, T>,
    b: &DMatrixView<'_, T>,
) -> DMatrix<T> {
    let (n, k) = stored(transposed, a.nrows(), a.ncols());
    let mut product = DMatrix::zeros(n, n);
    if k > 0 && !alpha.is_zero() {
        if transposed {
            product.gemm(alpha, &a.transpose(), b, T::zero());
        } else {
            product.gemm(alpha, a, &b.transpose(), T::zero());
        }
    }
    product
}

/// `C = increase + beta C` in one triangle of C, the diagonal included.
fn update_triangle<T: RealField + Copy>(
    c: &mut DMatrixViewMut<'_, T>,
    lower: bool,
    beta: T,
    increase: impl Fn(usize, usize) -> T,
) {
    let n = c.nrows();
    for j in 0..n {
        for i in if lower { j..n } else { 0..j + 1 } {
            c[(i, j)] = increase(i, j) + scaled(beta, &c[(i, j)]);
        }
    }
}

/// `beta y`; y is not read where `beta` is zero, as it may not be set yet.
fn scaled<T: RealField + Copy>(beta: T, y: &T) -> T {
    if beta.is_zero() { beta } else { beta * *y }
}

/// The step from one vector entry to the next, which must not be zero.
fn increment(step: i32) -> Option<isize> {
    isize::try_from(step).ok().filter(|&step| step != 0)
}

/// Where entry `i` of a vector of length `n` lies: a negative step walks back from the far end.
fn offset(i: usize, n: usize, step: isize) -> isize {
    let steps = if step < 0 { n - 1 - i } else { i };
    steps.cast_signed() * step.abs()
}

/// A copy of the vector at `x`.
///
/// # Safety
/// `n` entries, `step` apart, must be readable.
unsafe fn gather<T: Copy + nalgebra::Scalar>(x: *const T, step: isize, n: usize) -> DVector<T> {
    // SAFETY: the offsets are those of the n entries.
    DVector::from_fn(n, |i, _| unsafe { *x.offset(offset(i, n, step)) })
}

/// `y = beta y`, then what `add` adds to it.
///
/// # Safety
/// `n` entries, `step` apart, must be writable, and readable where `beta` is not zero.
unsafe fn update_vector<T: RealField + Copy>(
    y: *mut T,
    step: isize,
    n: usize,
    beta: T,
    add: impl FnOnce(&mut DVector<T>),
) {
    // SAFETY: the offsets are those of the n entries.
    let entry = |i| unsafe { y.offset(offset(i, n, step)) };
    // SAFETY: as above; read only where the caller has to have set it.
    let mut sum = DVector::from_fn(n, |i, _| unsafe { scaled(beta, &*entry(i)) });
    add(&mut sum);
    for (i, value) in sum.iter().enumerate() {
        // SAFETY: as above.
        unsafe { entry(i).write(*value) };
    }
}
