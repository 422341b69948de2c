//! The BLAS and LAPACK routines behind Clarabel, against nalgebra and against semidefinite
//! programs with known optima. A new test of one routine belongs in the file of `lapack/` with the
//! name of its source, which runs in both precisions.
#![expect(unsafe_code, reason = "the routines under test take raw pointers")]

use clarabel::algebra::{CscMatrix, FloatT};
use clarabel::solver::SupportedConeT::{PSDTriangleConeT, ZeroConeT};
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolution, DefaultSolver, IPSolver, SolverStatus,
};
use nalgebra::{DMatrix, RealField};
use urts_mc::synthesis::lapack::ensure_linked;

/// The routines in double precision.
mod double {
    type Real = f64;
    const EPSILON: f64 = f64::EPSILON;
    mod blas {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{
            dgemm_ as gemm, dgemv_ as gemv, dsymv_ as symv, dsyr2k_ as syr2k, dsyrk_ as syrk,
        };
        include!("lapack/blas.rs");
    }
    mod solve {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{dgesv_ as gesv, dpotrf_ as potrf, dpotrs_ as potrs};
        include!("lapack/solve.rs");
    }
    mod spectral {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{dgesdd_ as gesdd, dgesvd_ as gesvd, dsyevr_ as syevr};
        include!("lapack/spectral.rs");
    }
}

/// The routines in single precision.
mod single {
    type Real = f32;
    const EPSILON: f64 = f32::EPSILON as f64;
    mod blas {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{
            sgemm_ as gemm, sgemv_ as gemv, ssymv_ as symv, ssyr2k_ as syr2k, ssyrk_ as syrk,
        };
        include!("lapack/blas.rs");
    }
    mod solve {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{sgesv_ as gesv, spotrf_ as potrf, spotrs_ as potrs};
        include!("lapack/solve.rs");
    }
    mod spectral {
        use super::{EPSILON, Real};
        use urts_mc::synthesis::lapack::{sgesdd_ as gesdd, sgesvd_ as gesvd, ssyevr_ as syevr};
        include!("lapack/spectral.rs");
    }
}

/// Rows between the columns of a stored matrix that do not belong to it.
const N_PADDING_ROWS: usize = 3;

/// What fills memory a routine must neither read nor write: NaN spoils what reads it, a number
/// shows what overwrites it.
const PADDINGS: [f64; 2] = [f64::NAN, 8191.0];

/// A matrix in column-major storage with padding below each column.
#[derive(Clone)]
struct Stored<T> {
    data: Vec<T>,
    rows: usize,
    columns: usize,
}

impl<T: RealField + Copy> Stored<T> {
    fn new(matrix: &DMatrix<T>, padding: f64) -> Self {
        let mut padded = matrix.clone();
        padded =
            padded.resize_vertically(matrix.nrows() + N_PADDING_ROWS, nalgebra::convert(padding));
        Self {
            data: padded.data.into(),
            rows: matrix.nrows(),
            columns: matrix.ncols(),
        }
    }

    fn ld(&self) -> i32 {
        int(self.rows + N_PADDING_ROWS)
    }

    /// The matrix alone, in double precision.
    fn matrix(&self) -> DMatrix<f64> {
        self.padded().rows(0, self.rows).into_owned()
    }

    fn padded(&self) -> DMatrix<f64> {
        DMatrix::from_iterator(
            self.rows + N_PADDING_ROWS,
            self.columns,
            self.data.iter().map(|&x| double(x)),
        )
    }

    /// Asserts that every entry outside `written` is bit for bit what it was.
    fn assert_untouched(&self, before: &Self, written: impl Fn(usize, usize) -> bool) {
        let (now, then) = (self.padded(), before.padded());
        for j in 0..self.columns {
            for i in (0..now.nrows()).filter(|&i| i >= self.rows || !written(i, j)) {
                let (now, then) = (now[(i, j)], then[(i, j)]);
                assert_eq!(
                    now.to_bits(),
                    then.to_bits(),
                    "({i}, {j}): {then} became {now}"
                );
            }
        }
    }
}

fn int(n: usize) -> i32 {
    i32::try_from(n).expect("test matrices are small")
}

fn double<T: RealField>(value: T) -> f64 {
    nalgebra::try_convert(value).expect("every precision here fits into double")
}

fn all_double<T: RealField>(matrix: &DMatrix<T>) -> DMatrix<f64> {
    matrix.map(double)
}

/// Entries between -1 and 1 (Steele, Lea and Flood, OOPSLA 2014), the same for the same seed.
fn random<T: RealField>(rows: usize, columns: usize, seed: u64) -> DMatrix<T> {
    let mut state = seed;
    DMatrix::from_fn(rows, columns, |_, _| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        nalgebra::convert(((z ^ (z >> 31)) >> 11) as f64 / 2f64.powi(52) - 1.0)
    })
}

fn random_symmetric<T: RealField>(n: usize, seed: u64) -> DMatrix<T> {
    let a = random::<T>(n, n, seed);
    &a + a.transpose()
}

/// Positive definite with eigenvalues of at least 1, so that rounding cannot spoil a pivot.
fn random_definite<T: RealField>(n: usize, seed: u64) -> DMatrix<T> {
    let a = random::<T>(n, n, seed);
    &a * a.transpose() + DMatrix::identity(n, n)
}

/// Whether an entry lies in the triangle that `uplo` names.
fn in_triangle(uplo: u8, i: usize, j: usize) -> bool {
    if uplo == b'L' { i >= j } else { i <= j }
}

/// The matrix with everything outside one triangle replaced.
fn only_triangle<T: RealField>(uplo: u8, matrix: &DMatrix<T>, other: f64) -> DMatrix<T> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        if in_triangle(uplo, i, j) {
            matrix[(i, j)].clone()
        } else {
            nalgebra::convert(other)
        }
    })
}

fn assert_close(actual: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64) {
    assert_eq!(actual.shape(), expected.shape());
    let distance = (actual - expected).amax();
    let finite = actual.iter().all(|x| x.is_finite());
    assert!(
        finite && distance <= tolerance,
        "off by {distance:e}, more than {tolerance:e}:\n{actual}{expected}"
    );
}

/// min <C, X> with tr X = `trace` (or every diagonal entry 1 if `None`), X positive semidefinite.
fn solve_sdp<T: FloatT>(
    c: &DMatrix<f64>,
    trace: Option<f64>,
    settings: DefaultSettings<T>,
) -> DefaultSolution<T> {
    ensure_linked();
    let n = c.nrows();
    let number = |x: f64| T::from_f64(x).expect("finite");
    // The upper triangle column by column, entries off the diagonal scaled by sqrt 2.
    let triangle: Vec<(usize, usize)> = (0..n).flat_map(|j| (0..=j).map(move |i| (i, j))).collect();
    let n_equalities = if trace.is_some() { 1 } else { n };
    let cost: Vec<T> = triangle
        .iter()
        .map(|&(i, j)| {
            number(if i == j {
                c[(i, j)]
            } else {
                2f64.sqrt() * c[(i, j)]
            })
        })
        .collect();
    let (mut rows, mut columns, mut values) = (vec![], vec![], vec![]);
    for (k, &(i, j)) in triangle.iter().enumerate() {
        if i == j {
            rows.push(if trace.is_some() { 0 } else { i });
            columns.push(k);
            values.push(number(1.0));
        }
        rows.push(n_equalities + k);
        columns.push(k);
        values.push(number(-1.0));
    }
    let n_rows = n_equalities + triangle.len();
    let a = CscMatrix::new_from_triplets(n_rows, triangle.len(), rows, columns, values);
    let mut b = vec![number(0.0); n_rows];
    b[..n_equalities].fill(number(trace.unwrap_or(1.0)));
    let cones = [ZeroConeT(n_equalities), PSDTriangleConeT(n)];
    let p = CscMatrix::zeros((triangle.len(), triangle.len()));
    let mut solver = DefaultSolver::new(&p, &cost, &a, &b, &cones, settings).expect("consistent");
    solver.solve();
    solver.solution
}

/// Clarabel's defaults with every tolerance set.
fn settings<T: FloatT>(tolerance: f64) -> DefaultSettings<T> {
    let tolerance = T::from_f64(tolerance).expect("finite");
    DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(tolerance)
        .tol_gap_rel(tolerance)
        .tol_feas(tolerance)
        .build()
        .expect("valid settings")
}

/// Second differences: the eigenvalues are 2 - 2 cos(k pi / (n + 1)), k = 1..n.
fn second_differences(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    })
}

#[test]
fn val_clarabel_finds_the_smallest_eigenvalue() {
    // From 4 rows on Clarabel calls the routines; 12 rows pass through the blocked products too.
    for n in [4, 12, 25] {
        let solution = solve_sdp::<f64>(&second_differences(n), Some(1.0), settings(1e-9));
        let expected = 2.0 - 2.0 * (std::f64::consts::PI / (n as f64 + 1.0)).cos();
        assert_eq!(solution.status, SolverStatus::Solved);
        // The solver stops at a gap of 1e-9 and leaves as much again infeasible.
        assert!(
            (solution.obj_val - expected).abs() < 2e-9,
            "{n}: {} {expected}",
            solution.obj_val
        );
    }
}

#[test]
fn val_clarabel_bounds_the_maximum_cut_of_a_five_cycle() {
    // Goemans and Williamson, J. ACM 42 (1995): the relaxation of the 5-cycle has the value
    // 5 (1 + cos(pi / 5)) / 2, while the largest cut has 4 edges.
    let laplacian = DMatrix::from_fn(5, 5, |i, j| match (i + 5 - j) % 5 {
        0 => 2.0,
        1 | 4 => -1.0,
        _ => 0.0,
    });
    let solution = solve_sdp::<f64>(&(-laplacian / 4.0), None, settings(1e-9));
    let expected = 2.5 * (1.0 + (std::f64::consts::PI / 5.0).cos());
    assert_eq!(solution.status, SolverStatus::Solved);
    // The solver stops at a gap of 1e-9 of the optimum, which is 4.5.
    assert!(
        (-solution.obj_val - expected).abs() < 1e-8,
        "{} {expected}",
        solution.obj_val
    );
}

#[test]
fn val_clarabel_solves_in_single_precision() {
    // The pivots that Clarabel corrects by default are below single precision.
    let settings = DefaultSettings {
        dynamic_regularization_eps: 1e-7,
        dynamic_regularization_delta: 1e-4,
        ..settings(1e-4)
    };
    let solution = solve_sdp::<f32>(&second_differences(6), Some(1.0), settings);
    let expected = 2.0 - 2.0 * (std::f64::consts::PI / 7.0).cos();
    assert_eq!(solution.status, SolverStatus::Solved);
    // The solver stops at a gap of 1e-4 and leaves as much again infeasible.
    assert!((f64::from(solution.obj_val) - expected).abs() < 2e-4);
}

#[test]
fn clarabel_recognises_an_infeasible_program() {
    // No semidefinite matrix has a negative trace.
    let solution = solve_sdp::<f64>(&second_differences(5), Some(-1.0), settings(1e-9));
    assert_eq!(solution.status, SolverStatus::PrimalInfeasible);
}
