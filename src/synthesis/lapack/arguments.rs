//! The arguments of BLAS and LAPACK routines as Rust has them: flags, sizes, views of matrices.

use nalgebra::{
    Const, DMatrix, DMatrixView, DMatrixViewMut, Dyn, Matrix, RealField, ViewStorage,
    ViewStorageMut,
};

/// `Err` holds LAPACK's `info`: -i for an illegal i-th argument, positive for a numerical failure.
pub(super) type Outcome = Result<(), i32>;

/// Whether `op` transposes; conjugation is nothing for real matrices.
pub(super) fn is_transposed(flag: u8) -> Option<bool> {
    match flag.to_ascii_uppercase() {
        b'N' => Some(false),
        b'T' | b'C' => Some(true),
        _ => None,
    }
}

/// Whether the stored triangle is the lower one.
pub(super) fn is_lower(flag: u8) -> Option<bool> {
    match flag.to_ascii_uppercase() {
        b'L' => Some(true),
        b'U' => Some(false),
        _ => None,
    }
}

/// A number of rows or columns.
pub(super) fn size(n: i32) -> Option<usize> {
    usize::try_from(n).ok()
}

/// The leading dimension of a matrix with `rows` stored rows.
pub(super) fn leading(ld: i32, rows: usize) -> Option<usize> {
    size(ld).filter(|&ld| rows.max(1) <= ld)
}

/// The column-major matrix of the given shape (rows, columns) and leading dimension at `data`.
/// Its rows have stride 1, always: with any other, nalgebra 0.35 walks past the end of a vector
/// (dimforge/nalgebra issue 1616).
///
/// # Safety
/// Each entry must be readable for as long as the view is used, and none written meanwhile.
pub(super) unsafe fn view<'a, T>(
    data: *const T,
    shape: (usize, usize),
    ld: usize,
) -> DMatrixView<'a, T> {
    let shape = (Dyn(shape.0), Dyn(shape.1));
    // SAFETY: no slice is made of the whole, so the padding between columns is never touched.
    Matrix::from_data(unsafe { ViewStorage::from_raw_parts(data, shape, (Const::<1>, Dyn(ld))) })
}

/// As `view`, for an output.
///
/// # Safety
/// Each entry must be valid for as long as the view is used, and reached in no other way meanwhile.
pub(super) unsafe fn view_mut<'a, T>(
    data: *mut T,
    shape: (usize, usize),
    ld: usize,
) -> DMatrixViewMut<'a, T> {
    let shape = (Dyn(shape.0), Dyn(shape.1));
    // SAFETY: as in `view`.
    Matrix::from_data(unsafe { ViewStorageMut::from_raw_parts(data, shape, (Const::<1>, Dyn(ld))) })
}

/// The stored triangle of a square matrix as a lower triangle, transposed if it is the upper one.
/// The other triangle may hold anything and is not read; in the copy it is zero.
pub(super) fn lower_triangle<T: RealField + Copy>(
    a: &DMatrixView<'_, T>,
    lower: bool,
) -> DMatrix<T> {
    DMatrix::from_fn(a.nrows(), a.nrows(), |i, j| match (i >= j, lower) {
        (true, true) => a[(i, j)],
        (true, false) => a[(j, i)],
        (false, _) => T::zero(),
    })
}
