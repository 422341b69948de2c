//! Eigenvalues of symmetric matrices, singular values of any.
//!
//! Each unsafe routine asks of its caller what the symbols exported from it ask.

use nalgebra::{DMatrix, RealField, SymmetricEigen};

use super::arguments::{Outcome, is_lower, leading, lower_triangle, size, view, view_mut};
use super::jacobi::{Svd, complete_basis, svd};

pub(super) unsafe fn syevr<T: RealField + Copy>(
    jobz: u8,
    range: u8,
    uplo: u8,
    n: i32,
    a: *const T,
    lda: i32,
    vl: T,
    vu: T,
    il: i32,
    iu: i32,
    _abstol: T,
    m: *mut i32,
    w: *mut T,
    z: *mut T,
    ldz: i32,
    isuppz: *mut i32,
    work: *mut T,
    lwork: i32,
    iwork: *mut i32,
    liwork: i32,
) -> Outcome {
    let wants_vectors = match jobz.to_ascii_uppercase() {
        b'N' => false,
        b'V' => true,
        _ => return Err(-1),
    };
    let range = range.to_ascii_uppercase();
    if !matches!(range, b'A' | b'V' | b'I') {
        return Err(-2);
    }
    let lower = is_lower(uplo).ok_or(-3)?;
    let order = n;
    let n = size(n).ok_or(-4)?;
    let lda = leading(lda, n).ok_or(-6)?;
    check_range(range, order, (vl, vu), (il, iu))?;
    let ldz = leading(ldz, if wants_vectors { n } else { 0 }).ok_or(-15)?;
    let is_query = lwork == -1 || liwork == -1;
    if !is_query && lwork < 1 {
        return Err(-18);
    }
    if !is_query && liwork < 1 {
        return Err(-20);
    }
    // SAFETY: both hold at least one entry.
    unsafe {
        work.write(T::one());
        iwork.write(1);
    }
    if is_query {
        return Ok(());
    }

    // SAFETY: the dimensions are those the caller vouches for.
    let a = unsafe { view(a, (n, n), lda) };
    let Eigen { values, vectors } =
        symmetric_eigen(lower_triangle(&a, lower).map(double)).ok_or(1)?;
    let chosen = chosen_eigenvalues(&values, range, (double(vl), double(vu)), (il, iu));
    // SAFETY: `w` holds n entries, `z` as many columns as there are values chosen, `isuppz` twice
    // as many entries.
    unsafe {
        m.write(i32::try_from(chosen.len()).unwrap_or(i32::MAX));
        for (to, &from) in chosen.iter().enumerate() {
            w.add(to).write(nalgebra::convert(values[from]));
        }
        if wants_vectors {
            let mut z = view_mut(z, (n, chosen.len()), ldz);
            for (to, &from) in chosen.iter().enumerate() {
                z.column_mut(to)
                    .zip_apply(&vectors.column(from), |entry, value| {
                        *entry = nalgebra::convert(value)
                    });
                isuppz.add(2 * to).write(1);
                isuppz.add(2 * to + 1).write(order);
            }
        }
    }
    Ok(())
}

/// Refuses a range of eigenvalues, by value or by place from 1, that is none.
fn check_range<T: RealField>(
    range: u8,
    order: i32,
    (vl, vu): (T, T),
    (il, iu): (i32, i32),
) -> Outcome {
    if range == b'V' && order > 0 && vu <= vl {
        return Err(-8);
    }
    if range == b'I' && !(1..=order.max(1)).contains(&il) {
        return Err(-9);
    }
    if range == b'I' && !(order.min(il)..=order).contains(&iu) {
        return Err(-10);
    }
    Ok(())
}

/// The places of the eigenvalues in a range, by value (vl, vu] or by place il..=iu from 1, in ascending order.
fn chosen_eigenvalues(
    values: &[f64],
    range: u8,
    (vl, vu): (f64, f64),
    (il, iu): (i32, i32),
) -> Vec<usize> {
    let mut chosen: Vec<usize> = (0..values.len()).collect();
    chosen.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    match range {
        b'V' => chosen.retain(|&i| vl < values[i] && values[i] <= vu),
        b'I' => {
            chosen.truncate(size(iu).unwrap_or(0));
            chosen.drain(..size(il - 1).unwrap_or(0).min(chosen.len()));
        }
        _ => {}
    }
    chosen
}

pub(super) unsafe fn gesdd<T: RealField + Copy>(
    jobz: u8,
    m: i32,
    n: i32,
    a: *mut T,
    lda: i32,
    s: *mut T,
    u: *mut T,
    ldu: i32,
    vt: *mut T,
    ldvt: i32,
    work: *mut T,
    lwork: i32,
    _iwork: *mut i32,
) -> Outcome {
    // 'O' puts the longer of U and V' over A and the other, which is square, beside it.
    let (jobu, jobvt) = match (Job::parse(jobz).ok_or(-1)?, m >= n) {
        (Job::Overwrite, true) => (Job::Overwrite, Job::All),
        (Job::Overwrite, false) => (Job::All, Job::Overwrite),
        (job, _) => (job, job),
    };
    // The positions of the arguments are those of gesvd, which has one flag more.
    // SAFETY: the arguments are the caller's own.
    let outcome = unsafe { decompose(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork) };
    outcome.map_err(|info| if info < 0 { info + 1 } else { info })
}

pub(super) unsafe fn gesvd<T: RealField + Copy>(
    jobu: u8,
    jobvt: u8,
    m: i32,
    n: i32,
    a: *mut T,
    lda: i32,
    s: *mut T,
    u: *mut T,
    ldu: i32,
    vt: *mut T,
    ldvt: i32,
    work: *mut T,
    lwork: i32,
) -> Outcome {
    let jobu = Job::parse(jobu).ok_or(-1)?;
    let jobvt = Job::parse(jobvt).ok_or(-2)?;
    if jobu == Job::Overwrite && jobvt == Job::Overwrite {
        return Err(-2);
    }
    // SAFETY: the arguments are the caller's own.
    unsafe { decompose(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork) }
}

/// Which singular vectors of one side are wanted, and where.
#[derive(Clone, Copy, PartialEq)]
enum Job {
    /// A full basis.
    All,
    /// As many as there are singular values.
    Some,
    /// As many as there are singular values, over A.
    Overwrite,
    /// None.
    None,
}

impl Job {
    fn parse(flag: u8) -> Option<Self> {
        match flag.to_ascii_uppercase() {
            b'A' => Some(Self::All),
            b'S' => Some(Self::Some),
            b'O' => Some(Self::Overwrite),
            b'N' => Some(Self::None),
            _ => None,
        }
    }

    /// How many vectors go to their own array, of `k` singular values in dimension `n`.
    fn columns(self, k: usize, n: usize) -> usize {
        match self {
            Self::All => n,
            Self::Some => k,
            Self::Overwrite | Self::None => 0,
        }
    }
}

/// What gesdd and gesvd share; `Err` counts the arguments as gesvd does.
unsafe fn decompose<T: RealField + Copy>(
    jobu: Job,
    jobvt: Job,
    m: i32,
    n: i32,
    a: *mut T,
    lda: i32,
    s: *mut T,
    u: *mut T,
    ldu: i32,
    vt: *mut T,
    ldvt: i32,
    work: *mut T,
    lwork: i32,
) -> Outcome {
    let m = size(m).ok_or(-3)?;
    let n = size(n).ok_or(-4)?;
    let k = m.min(n);
    let u_columns = jobu.columns(k, m);
    let vt_rows = jobvt.columns(k, n);
    let lda = leading(lda, m).ok_or(-6)?;
    let ldu = leading(ldu, if u_columns > 0 { m } else { 0 }).ok_or(-9)?;
    let ldvt = leading(ldvt, vt_rows).ok_or(-11)?;
    if lwork != -1 && lwork < 1 {
        return Err(-13);
    }
    // SAFETY: `work` holds at least one entry.
    unsafe { work.write(T::one()) };
    if lwork == -1 || k == 0 {
        return Ok(());
    }

    // SAFETY: the dimensions are those the caller vouches for.
    let (mut a, mut u_out, mut vt_out) = unsafe {
        (
            view_mut(a, (m, n), lda),
            view_mut(u, (m, u_columns), ldu),
            view_mut(vt, (vt_rows, n), ldvt),
        )
    };
    let input = a.map(double);
    let Svd { u, values, v } = if is_finite(&input) {
        svd(input).ok_or(1)?
    } else {
        Svd {
            u: DMatrix::from_element(m, k, f64::NAN),
            values: vec![f64::NAN; k],
            v: DMatrix::from_element(n, k, f64::NAN),
        }
    };
    for (i, value) in values.iter().enumerate() {
        // SAFETY: `s` holds k entries.
        unsafe { s.add(i).write(nalgebra::convert(*value)) };
    }
    match jobu {
        Job::All => u_out.copy_from(&rounded(&complete_basis(u, m))),
        Job::Some => u_out.copy_from(&rounded(&u)),
        Job::Overwrite => a.columns_mut(0, k).copy_from(&rounded(&u)),
        Job::None => {}
    }
    match jobvt {
        Job::All => vt_out.tr_copy_from(&rounded(&complete_basis(v, n))),
        Job::Some => vt_out.tr_copy_from(&rounded(&v)),
        Job::Overwrite => a.rows_mut(0, k).tr_copy_from(&rounded(&v)),
        Job::None => {}
    }
    Ok(())
}

/// Eigenvalues, in no order, and their vectors.
struct Eigen {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

/// Decomposes a symmetric matrix given by its lower triangle; all NaN if an entry is not finite.
/// `None` if the iteration has not converged.
fn symmetric_eigen(mut a: DMatrix<f64>) -> Option<Eigen> {
    let n = a.nrows();
    if n == 0 || !is_finite(&a) {
        return Some(Eigen {
            values: vec![f64::NAN; n],
            vectors: DMatrix::from_element(n, n, f64::NAN),
        });
    }
    // Entries this small change nothing, but their squares underflow on the way and would turn
    // rotations into NaN.
    let negligible = a.amax() * f64::EPSILON * f64::EPSILON;
    a.apply(|entry| {
        if entry.abs() < negligible {
            *entry = 0.0;
        }
    });
    // Two or three iterations for each eigenvalue are usual.
    let eigen = SymmetricEigen::try_new(a, f64::EPSILON, 100 + 40 * n)?;
    Some(Eigen {
        values: eigen.eigenvalues.data.into(),
        vectors: eigen.eigenvectors,
    })
}

fn is_finite(a: &DMatrix<f64>) -> bool {
    a.iter().all(|entry| entry.is_finite())
}

/// A number in double precision.
fn double<T: RealField + Copy>(value: T) -> f64 {
    nalgebra::try_convert(value).unwrap_or(f64::NAN)
}

/// A matrix in the caller's precision.
fn rounded<T: RealField + Copy>(matrix: &DMatrix<f64>) -> DMatrix<T> {
    matrix.map(nalgebra::convert)
}
