//! The few dense operations the synthesis needs beyond nalgebra's own, all
//! returning `None` where the input has no answer instead of panicking.

use nalgebra::{Complex, DMatrix, DVector, Schur, SymmetricEigen};

/// Iterations after which an eigenvalue computation is given up.
const MAX_EIGEN_ITERATIONS: usize = 10_000;

/// `m + m'`, the operator Sym of the paper.
pub(super) fn sym(m: DMatrix<f64>) -> DMatrix<f64> {
    let transpose = m.transpose();
    m + transpose
}

/// Joins a grid of blocks into one matrix; rows of blocks share a height.
pub(super) fn join<const C: usize>(rows: &[[&DMatrix<f64>; C]]) -> DMatrix<f64> {
    let height = rows.iter().map(|row| row[0].nrows()).sum();
    let width = rows
        .first()
        .map_or(0, |row| row.iter().map(|b| b.ncols()).sum());
    let mut whole = DMatrix::zeros(height, width);
    let mut top = 0;
    for row in rows {
        let mut left = 0;
        for block in row {
            whole.view_mut((top, left), block.shape()).copy_from(*block);
            left += block.ncols();
        }
        top += row[0].nrows();
    }
    whole
}

/// The square diagonal matrix of `entries`.
pub(super) fn diagonal(entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&DVector::from_column_slice(entries))
}

/// The largest absolute entry.
pub(super) fn max_abs(m: &DMatrix<f64>) -> f64 {
    m.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Eigenvalues of a square matrix, sorted by real, then imaginary part.
pub(super) fn eigenvalues(m: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(m.clone(), f64::EPSILON, MAX_EIGEN_ITERATIONS)?;
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    Some(values)
}

/// Eigenvalues of a symmetric matrix, ascending; only the symmetric part of `m` is seen.
pub(super) fn symmetric_eigenvalues(m: &DMatrix<f64>) -> Option<Vec<f64>> {
    if m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let symmetric = sym(m.clone()) * 0.5;
    let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, MAX_EIGEN_ITERATIONS)?;
    let mut values: Vec<_> = eigen.eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    Some(values)
}

/// The symmetric solution X of the Lyapunov equation `A' X + X A + Q = 0`, Q symmetric.
///
/// Solved directly in the n (n + 1) / 2 independent entries: n is at most a
/// few dozen here, and the direct solution loses no accuracy to a Schur form of
/// the defective matrices that smoothing models produce.
pub(super) fn lyapunov(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    // Entry (i, j), i <= j, of the upper triangle stacked by columns.
    let index = |i: usize, j: usize| {
        let (low, high) = (i.min(j), i.max(j));
        high * (high + 1) / 2 + low
    };
    let size = n * (n + 1) / 2;
    let mut system = DMatrix::zeros(size, size);
    let mut right = DVector::zeros(size);
    for j in 0..n {
        for i in 0..=j {
            let row = index(i, j);
            right[row] = -q[(i, j)];
            for k in 0..n {
                system[(row, index(k, j))] += a[(k, i)];
                system[(row, index(i, k))] += a[(k, j)];
            }
        }
    }
    let solution = system.lu().solve(&right)?;
    Some(DMatrix::from_fn(n, n, |i, j| solution[index(i, j)]))
}

/// (U, U^-1) with P = U' U: coordinates U x in which P is the identity.
pub(super) fn square_roots(p: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let upper = p.clone().cholesky()?.l().transpose();
    let inverse = upper.clone().try_inverse()?;
    Some((upper, inverse))
}

/// The power of two nearest to x in the logarithm; 1 where x is zero or not finite.
pub(super) fn power_of_two_near(x: f64) -> f64 {
    if x.is_finite() && x > 0.0 {
        x.log2().round().exp2()
    } else {
        1.0
    }
}
