//! Singular value decomposition by one-sided Jacobi rotations.
//!
//! nalgebra's `SVD` lost whole singular values of rank-deficient matrices and produced NaN from
//! strongly graded ones. One-sided Jacobi does neither, finds small singular values at least as
//! accurately (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13, 1992) and is short.

use nalgebra::DMatrix;

/// Sweeps over all column pairs before giving up. Convergence is quadratic in the end, so that a
/// handful does.
const MAX_SWEEPS: usize = 60;

/// `A = U diag(values) V'`, with k = min(rows, columns) singular values in descending order.
pub(super) struct Svd {
    /// Left singular vectors, rows x k.
    pub(super) u: DMatrix<f64>,
    /// Singular values.
    pub(super) values: Vec<f64>,
    /// Right singular vectors, columns x k.
    pub(super) v: DMatrix<f64>,
}

/// Decomposes a finite matrix; `None` if the rotations have not converged.
pub(super) fn svd(a: DMatrix<f64>) -> Option<Svd> {
    if a.nrows() < a.ncols() {
        let Svd { u, values, v } = svd_of_tall(a.transpose())?;
        Some(Svd { u: v, values, v: u })
    } else {
        svd_of_tall(a)
    }
}

/// Extends `n x k` orthonormal columns to a basis of `size` columns: each time the axis that
/// lies farthest from their span, made orthogonal to it (twice, as once loses digits).
pub(super) fn complete_basis(columns: DMatrix<f64>, size: usize) -> DMatrix<f64> {
    let k = columns.ncols();
    let mut basis = columns.resize_horizontally(size, 0.0);
    for j in k..size {
        let (known, mut rest) = basis.columns_range_pair_mut(..j, j..);
        let mut column = rest.column_mut(0);
        column.fill(0.0);
        let covered = known.row_iter().map(|row| row.norm_squared()).enumerate();
        if let Some((axis, _)) = covered.min_by(|(_, a), (_, b)| a.total_cmp(b)) {
            column[axis] = 1.0;
        }
        for _ in 0..2 {
            let components = known.tr_mul(&column);
            column.gemv(-1.0, &known, &components, 1.0);
            column.normalize_mut();
        }
    }
    basis
}

/// Rotates pairs of columns of A until all are orthogonal: `A V = U diag(values)`.
fn svd_of_tall(mut a: DMatrix<f64>) -> Option<Svd> {
    let (rows, k) = a.shape();
    let scale = a.amax();
    if scale > 0.0 {
        a /= scale;
    }
    // Columns are orthogonal when their cosine is of the size of rounding errors. Columns this
    // short are zero beside the largest entry, which is now 1, and would underflow when squared.
    let epsilon = f64::EPSILON;
    let cosine_tolerance = epsilon * (rows as f64).sqrt();
    let null_square = epsilon.powi(4);

    let mut v = DMatrix::identity(k, k);
    let mut converged = false;
    for _ in 0..MAX_SWEEPS {
        converged = true;
        for p in 0..k {
            for q in p + 1..k {
                let square_p = a.column(p).norm_squared();
                let square_q = a.column(q).norm_squared();
                let product = a.column(p).dot(&a.column(q));
                if square_p > null_square
                    && square_q > null_square
                    && product.abs() > cosine_tolerance * (square_p * square_q).sqrt()
                {
                    converged = false;
                    let (cosine, sine) = rotation(square_p, square_q, product);
                    rotate(&mut a, p, q, cosine, sine);
                    rotate(&mut v, p, q, cosine, sine);
                }
            }
        }
        if converged {
            break;
        }
    }
    converged.then(|| sorted(&a, &v, scale, null_square.sqrt()))
}

/// Cosine and sine of the smaller angle that makes two columns orthogonal, from their squared
/// norms and inner product (Golub and Van Loan, section 8.5.2).
fn rotation(square_p: f64, square_q: f64, product: f64) -> (f64, f64) {
    let cotangent = (square_q - square_p) / (product + product);
    let tangent = 1f64.copysign(cotangent) / (cotangent.abs() + 1f64.hypot(cotangent));
    let cosine = 1.0 / 1f64.hypot(tangent);
    (cosine, cosine * tangent)
}

/// Rotates columns p < q.
fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, cosine: f64, sine: f64) {
    let rows = m.nrows();
    let (head, tail) = m.as_mut_slice().split_at_mut(q * rows);
    for (x, y) in head[p * rows..][..rows].iter_mut().zip(&mut tail[..rows]) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

/// Norms of the rotated columns as singular values (zero where within `null`), the columns
/// themselves as left vectors.
fn sorted(a: &DMatrix<f64>, v: &DMatrix<f64>, scale: f64, null: f64) -> Svd {
    let norms: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let mut order: Vec<usize> = (0..norms.len()).collect();
    order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));

    let rank = order.iter().take_while(|&&j| norms[j] > null).count();
    let mut u = a.select_columns(&order[..rank]);
    let mut values = vec![0.0; order.len()];
    for (i, &j) in order[..rank].iter().enumerate() {
        u.column_mut(i).unscale_mut(norms[j]);
        values[i] = norms[j] * scale;
    }
    Svd {
        u: complete_basis(u, order.len()),
        values,
        v: v.select_columns(&order),
    }
}
