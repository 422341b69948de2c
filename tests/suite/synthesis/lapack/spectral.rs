// Eigenvalues and singular values in the precision `Real`, against nalgebra's in double precision
// and against their definition.

use super::super::{PADDINGS, Stored, all_double, assert_close, double, int, only_triangle, random, random_symmetric};
use nalgebra::DMatrix;

/// Matrices of up to 12 rows with entries up to 10: some hundred roundings of numbers of that size.
const TOLERANCE: f64 = 2000.0 * EPSILON;

/// What one call of syevr asks for; ranges as LAPACK takes them.
#[derive(Clone, Copy)]
struct Wanted {
    jobz: u8,
    range: u8,
    uplo: u8,
    values: (Real, Real),
    positions: (i32, i32),
}

/// Eigenvalues and vectors; in the vectors' array what was not written is `padding`.
fn eigen(wanted: Wanted, matrix: &DMatrix<Real>, padding: f64) -> (Vec<f64>, Stored<Real>, i32) {
    let n = matrix.nrows();
    let mut a = Stored::new(&only_triangle(wanted.uplo, matrix, padding), padding);
    let filling = nalgebra::convert(padding);
    let mut vectors = Stored::new(&DMatrix::from_element(n, n, filling), padding);
    let (mut found, mut values, mut support) = (-7, vec![0.0; n], vec![0; 2 * n]);
    let (mut work, mut iwork, mut info) = ([0.0], [0], 7);
    // SAFETY: the arrays have the sizes passed.
    unsafe {
        syevr(
            &wanted.jobz,
            &wanted.range,
            &wanted.uplo,
            &int(n),
            a.data.as_mut_ptr(),
            &a.ld(),
            &wanted.values.0,
            &wanted.values.1,
            &wanted.positions.0,
            &wanted.positions.1,
            &-1.0,
            &mut found,
            values.as_mut_ptr(),
            vectors.data.as_mut_ptr(),
            &vectors.ld(),
            support.as_mut_ptr(),
            work.as_mut_ptr(),
            &1,
            iwork.as_mut_ptr(),
            &1,
            &mut info,
        );
    }
    values.truncate(usize::try_from(found).unwrap_or(0));
    if wanted.jobz == b'V' {
        // Every entry of a vector may be other than zero.
        let mut ranges = support[..2 * values.len()].chunks(2);
        assert!(ranges.all(|range| range == [1, int(n)]));
    }
    (values.into_iter().map(double).collect(), vectors, info)
}

#[test]
fn val_syevr_matches_nalgebra() {
    for n in [1, 4, 12] {
        let matrix = random_symmetric::<Real>(n, 24);
        let mut reference: Vec<f64> = all_double(&matrix)
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect();
        reference.sort_by(f64::total_cmp);
        // Two limits that fall between eigenvalues, and the same choice by position.
        let (low, high) = (n / 3, n - n / 4);
        let between = |k: usize| match k {
            0 => -100.0,
            k if k == n => 100.0,
            k => nalgebra::convert(0.5 * (reference[k - 1] + reference[k])),
        };
        for (jobz, uplo) in [b"NU", b"NL", b"VU", b"VL"].map(|&[j, u]| (j, u)) {
            for (range, padding) in [(b'A', 0), (b'V', 0), (b'I', 1), (b'A', 1), (b'i', 0)] {
                let padding = PADDINGS[padding];
                let wanted = Wanted {
                    jobz,
                    range,
                    uplo,
                    values: (between(low), between(high)),
                    positions: (int(low + 1), int(high)),
                };
                let (values, vectors, info) = eigen(wanted, &matrix, padding);
                assert_eq!(info, 0);
                let expected = if range == b'A' {
                    &reference[..]
                } else {
                    &reference[low..high]
                };
                assert_close(
                    &DMatrix::from_column_slice(values.len(), 1, &values),
                    &DMatrix::from_column_slice(expected.len(), 1, expected),
                    TOLERANCE,
                );
                let filling = nalgebra::convert(padding);
                let untouched = Stored::new(&DMatrix::from_element(n, n, filling), padding);
                vectors.assert_untouched(&untouched, |_, j| jobz == b'V' && j < values.len());
                if jobz == b'V' {
                    let z = vectors.matrix().columns(0, values.len()).into_owned();
                    let scaled = DMatrix::from_fn(n, values.len(), |i, j| z[(i, j)] * values[j]);
                    assert_close(&(all_double(&matrix) * &z), &scaled, TOLERANCE);
                    let identity = DMatrix::identity(values.len(), values.len());
                    assert_close(&z.tr_mul(&z), &identity, TOLERANCE);
                }
            }
        }
    }
}

/// Entries that shrink from the first to the last row and column, by 2^`exponent` in all.
fn graded(matrix: &DMatrix<f64>, exponent: f64) -> DMatrix<Real> {
    let n_steps = (matrix.nrows() + matrix.ncols() - 2) as f64;
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        nalgebra::convert(matrix[(i, j)] * (exponent * (i + j) as f64 / n_steps).exp2())
    })
}

#[test]
fn syevr_decomposes_graded_matrices_whose_squares_underflow() {
    for seed in 0..200 {
        let n = 28;
        // Down to the square root of the smallest number and beyond.
        let exponent = f64::from(Real::MIN_EXP) * (0.4 + 0.5 * seed as f64 / 200.0);
        let matrix = graded(&random_symmetric(n, seed), exponent);
        let wanted = Wanted {
            jobz: b'V',
            range: b'A',
            uplo: b'U',
            values: (0.0, 0.0),
            positions: (0, 0),
        };
        let (values, vectors, info) = eigen(wanted, &matrix, 0.0);
        assert_eq!(info, 0);
        let z = vectors.matrix();
        let scaled = DMatrix::from_fn(n, n, |i, j| z[(i, j)] * values[j]);
        assert_close(&(scaled * z.transpose()), &all_double(&matrix), TOLERANCE);
        assert_close(&z.tr_mul(&z), &DMatrix::identity(n, n), TOLERANCE);
    }
}

/// The outcome of gesdd or gesvd; absent vectors have no columns.
struct Decomposed {
    u: DMatrix<f64>,
    values: Vec<f64>,
    vt: DMatrix<f64>,
    info: i32,
}

/// Calls gesdd with one job, or gesvd with two.
fn decompose(jobs: &[u8], matrix: &DMatrix<Real>, padding: f64) -> Decomposed {
    let (m, n) = matrix.shape();
    let k = m.min(n);
    let (jobu, jobvt) = match jobs {
        [b'O'] if m >= n => (b'O', b'A'),
        [b'O'] => (b'A', b'O'),
        [job] => (*job, *job),
        jobs => (jobs[0], jobs[1]),
    };
    let count = |job, all| match job {
        b'A' => all,
        b'S' => k,
        _ => 0,
    };
    let filling: Real = nalgebra::convert(padding);
    let before = Stored::new(matrix, padding);
    let mut a = before.clone();
    let mut u = Stored::new(&DMatrix::from_element(m, count(jobu, m), filling), padding);
    let mut vt = Stored::new(&DMatrix::from_element(count(jobvt, n), n, filling), padding);
    let (u_before, vt_before) = (u.clone(), vt.clone());
    let (mut s, mut work, mut iwork, mut info) = (vec![0.0; k], [0.0], vec![0; 8 * k], 7);
    // SAFETY: the arrays have the sizes passed.
    unsafe {
        match jobs {
            [job] => gesdd(
                job,
                &int(m),
                &int(n),
                a.data.as_mut_ptr(),
                &a.ld(),
                s.as_mut_ptr(),
                u.data.as_mut_ptr(),
                &u.ld(),
                vt.data.as_mut_ptr(),
                &vt.ld(),
                work.as_mut_ptr(),
                &1,
                iwork.as_mut_ptr(),
                &mut info,
            ),
            _ => gesvd(
                &jobu,
                &jobvt,
                &int(m),
                &int(n),
                a.data.as_mut_ptr(),
                &a.ld(),
                s.as_mut_ptr(),
                u.data.as_mut_ptr(),
                &u.ld(),
                vt.data.as_mut_ptr(),
                &vt.ld(),
                work.as_mut_ptr(),
                &1,
                &mut info,
            ),
        }
    }
    a.assert_untouched(&before, |_, _| true);
    u.assert_untouched(&u_before, |_, _| true);
    vt.assert_untouched(&vt_before, |_, _| true);
    let over_a = a.matrix();
    Decomposed {
        u: if jobu == b'O' {
            over_a.columns(0, k).into_owned()
        } else {
            u.matrix()
        },
        vt: if jobvt == b'O' {
            over_a.rows(0, k).into_owned()
        } else {
            vt.matrix()
        },
        values: s.into_iter().map(double).collect(),
        info,
    }
}

/// Asserts that the factors are orthogonal, ordered, and multiply to the matrix.
fn assert_decomposes(svd: &Decomposed, matrix: &DMatrix<Real>) {
    assert_eq!(svd.info, 0);
    assert!(svd.values.is_sorted_by(|a, b| a >= b) && svd.values.iter().all(|&s| s >= 0.0));
    for (basis, size) in [
        (svd.u.clone(), svd.u.ncols()),
        (svd.vt.transpose(), svd.vt.nrows()),
    ] {
        assert_close(
            &basis.tr_mul(&basis),
            &DMatrix::identity(size, size),
            TOLERANCE,
        );
    }
    if svd.u.ncols() > 0 && svd.vt.nrows() > 0 {
        let sigma = DMatrix::from_fn(svd.u.ncols(), svd.vt.nrows(), |i, j| {
            if i == j { svd.values[i] } else { 0.0 }
        });
        assert_close(&(&svd.u * sigma * &svd.vt), &all_double(matrix), TOLERANCE);
    }
}

#[test]
fn val_gesdd_and_gesvd_match_nalgebra() {
    let jobs: [&[u8]; 13] = [
        b"A", b"S", b"O", b"N", b"AA", b"SS", b"AS", b"SA", b"OS", b"SO", b"NA", b"AN", b"NN",
    ];
    for (m, n) in [(4, 4), (9, 5), (5, 9), (1, 1), (12, 12)] {
        let matrix = random::<Real>(m, n, 25);
        let expected = all_double(&matrix).svd(false, false).singular_values;
        for jobs in jobs {
            for padding in PADDINGS {
                let svd = decompose(jobs, &matrix, padding);
                assert_decomposes(&svd, &matrix);
                assert_close(
                    &DMatrix::from_column_slice(m.min(n), 1, &svd.values),
                    &DMatrix::from_column_slice(m.min(n), 1, expected.as_slice()),
                    TOLERANCE,
                );
            }
        }
    }
}

#[test]
fn gesdd_decomposes_matrices_without_full_rank() {
    // nalgebra's own decomposition loses singular values of such matrices.
    for seed in 0..200 {
        for rank in [0, 1, 4, 8] {
            let matrix = random::<Real>(9, rank, seed) * random::<Real>(rank, 9, seed + 1000);
            let svd = decompose(b"S", &matrix, 0.0);
            assert_decomposes(&svd, &matrix);
            assert!(svd.values[rank..].iter().all(|&s| s < TOLERANCE));
        }
    }
}

#[test]
fn gesdd_decomposes_graded_and_repeated_singular_values() {
    for seed in 0..20 {
        let matrix = random::<f64>(10, 10, seed);
        let graded = graded(&matrix, f64::from(Real::MIN_EXP));
        assert_decomposes(&decompose(b"A", &graded, 0.0), &graded);
        let rotation = matrix.qr().q().map(nalgebra::convert);
        assert_decomposes(&decompose(b"A", &rotation, 0.0), &rotation);
    }
}

#[test]
fn matrices_that_are_not_finite_give_nan_without_an_error() {
    for poison in [Real::NAN, Real::INFINITY] {
        let mut matrix = random_symmetric::<Real>(5, 26);
        matrix[(1, 3)] = poison;
        matrix[(3, 1)] = poison;
        let wanted = Wanted {
            jobz: b'N',
            range: b'A',
            uplo: b'L',
            values: (0.0, 0.0),
            positions: (0, 0),
        };
        let (values, _, info) = eigen(wanted, &matrix, 0.0);
        assert!(info == 0 && values.len() == 5 && values.iter().all(|x| x.is_nan()));
        for jobs in [&b"A"[..], b"SS"] {
            let svd = decompose(jobs, &matrix, 0.0);
            assert!(svd.info == 0 && svd.values.iter().all(|x| x.is_nan()));
            assert!(svd.u.iter().chain(&svd.vt).all(|x| x.is_nan()));
        }
    }
}

#[test]
fn workspace_queries_answer_one_and_touch_nothing_else() {
    let (mut a, mut out): ([Real; 16], [Real; 16]) = ([2.0; 16], [3.0; 16]);
    let (mut work, mut iwork, mut info, mut found) = ([0.0], [0], 7, 8);
    // SAFETY: the arrays have the sizes passed; the two that one array stands for are not written.
    unsafe {
        let out = out.as_mut_ptr();
        syevr(
            &b'V',
            &b'A',
            &b'U',
            &4,
            a.as_mut_ptr(),
            &4,
            &0.0,
            &0.0,
            &0,
            &0,
            &-1.0,
            &mut found,
            out,
            out,
            &4,
            &mut found,
            work.as_mut_ptr(),
            &-1,
            iwork.as_mut_ptr(),
            &-1,
            &mut info,
        );
        assert_eq!((work, iwork, info), ([1.0], [1], 0));
        work[0] = 0.0;
        gesdd(
            &b'S',
            &4,
            &4,
            a.as_mut_ptr(),
            &4,
            out,
            out,
            &4,
            out,
            &4,
            work.as_mut_ptr(),
            &-1,
            iwork.as_mut_ptr(),
            &mut info,
        );
        assert_eq!((work, info), ([1.0], 0));
        work[0] = 0.0;
        gesvd(
            &b'S',
            &b'S',
            &4,
            &4,
            a.as_mut_ptr(),
            &4,
            out,
            out,
            &4,
            out,
            &4,
            work.as_mut_ptr(),
            &-1,
            &mut info,
        );
        assert_eq!((work, info), ([1.0], 0));
    }
    assert_eq!((a, out, found), ([2.0; 16], [3.0; 16], 8));
}

#[test]
fn illegal_arguments_are_reported_by_position() {
    let (mut a, mut out): ([Real; 16], [Real; 64]) = ([2.0; 16], [3.0; 64]);
    let (mut ints, mut info) = ([0; 32], 0);
    let (a, out, ints) = (a.as_mut_ptr(), out.as_mut_ptr(), ints.as_mut_ptr());
    let mut reported = vec![];
    // SAFETY: nothing is reached, as each call has an illegal argument.
    unsafe {
        for (flags, n, ld, (il, iu), ldz, lwork, liwork) in [
            (b"XAU", 4, 4, (1, 4), 4, 1, 1),
            (b"VXU", 4, 4, (1, 4), 4, 1, 1),
            (b"VAX", 4, 4, (1, 4), 4, 1, 1),
            (b"VAU", -1, 4, (1, 4), 4, 1, 1),
            (b"VAU", 4, 3, (1, 4), 4, 1, 1),
            (b"VVU", 4, 4, (1, 4), 4, 1, 1),
            (b"VIU", 4, 4, (0, 4), 4, 1, 1),
            (b"VIU", 4, 4, (3, 2), 4, 1, 1),
            (b"VIU", 4, 4, (1, 5), 4, 1, 1),
            (b"VAU", 4, 4, (1, 4), 3, 1, 1),
            (b"VAU", 4, 4, (1, 4), 4, 0, 1),
            (b"VAU", 4, 4, (1, 4), 4, 1, 0),
        ] {
            let [jobz, range, uplo] = flags;
            syevr(
                jobz, range, uplo, &n, a, &ld, &1.0, &0.0, &il, &iu, &0.0, ints, out, out, &ldz,
                ints, out, &lwork, ints, &liwork, &mut info,
            );
            reported.push(info);
        }
        assert_eq!(
            reported,
            [-1, -2, -3, -4, -6, -8, -9, -10, -10, -15, -18, -20]
        );
        reported.clear();
        for (jobs, m, n, [lda, ldu, ldvt], lwork) in [
            (b"XX", 4, 3, [4, 4, 3], 1),
            (b"SS", -1, 3, [4, 4, 3], 1),
            (b"SS", 4, -1, [4, 4, 3], 1),
            (b"SS", 4, 3, [3, 4, 3], 1),
            (b"SS", 4, 3, [4, 3, 3], 1),
            (b"SS", 4, 3, [4, 4, 2], 1),
            (b"SS", 4, 3, [4, 4, 3], 0),
            (b"OO", 4, 3, [4, 4, 2], 0),
        ] {
            gesdd(
                &jobs[0], &m, &n, a, &lda, out, out, &ldu, out, &ldvt, out, &lwork, ints, &mut info,
            );
            reported.push(info);
            gesvd(
                &jobs[0], &jobs[1], &m, &n, a, &lda, out, out, &ldu, out, &ldvt, out, &lwork,
                &mut info,
            );
            reported.push(info);
        }
        let expected = [
            -1, -1, -2, -3, -3, -4, -5, -6, -8, -9, -10, -11, -12, -13, -10, -2,
        ];
        assert_eq!(reported, expected);
    }
}
