//! Linear matrix inequalities on Clarabel's semidefinite cones.
//!
//! An inequality is written as the paper prints it, as a function from the
//! decision variables to a symmetric matrix that must be positive
//! semidefinite. Its coefficients follow from evaluating the function, which
//! must be affine, at zero and at every unit vector.

use super::error::{Step, SynthesisError};
use super::lapack;
use super::linalg::{max_abs, power_of_two_near};
use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::PSDTriangleConeT;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus};
use nalgebra::DMatrix;
use std::f64::consts::SQRT_2;
use std::iter::zip;

const EQUILIBRATION_ROUNDS: usize = 10;

/// A matrix of decision variables inside the vector of all of them.
#[derive(Clone, Copy, Debug)]
pub(super) enum Unknown {
    /// A symmetric n x n matrix, its upper triangle stacked by columns.
    Symmetric { first: usize, n: usize },
    /// A full matrix, stacked by columns.
    Full {
        first: usize,
        rows: usize,
        columns: usize,
    },
}

/// Hands out places in the vector of decision variables.
#[derive(Debug, Default)]
pub(super) struct Unknowns {
    count: usize,
}

impl Unknowns {
    /// Number of scalar variables handed out.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// A new symmetric n x n matrix.
    pub(super) fn symmetric(&mut self, n: usize) -> Unknown {
        let first = self.count;
        self.count += n * (n + 1) / 2;
        Unknown::Symmetric { first, n }
    }

    /// A new full matrix.
    pub(super) fn full(&mut self, rows: usize, columns: usize) -> Unknown {
        let first = self.count;
        self.count += rows * columns;
        Unknown::Full {
            first,
            rows,
            columns,
        }
    }
}

impl Unknown {
    /// The matrix at the point `x`.
    pub(super) fn at(self, x: &[f64]) -> DMatrix<f64> {
        match self {
            Self::Symmetric { first, n } => DMatrix::from_fn(n, n, |i, j| {
                let (low, high) = (i.min(j), i.max(j));
                x[first + high * (high + 1) / 2 + low]
            }),
            Self::Full {
                first,
                rows,
                columns,
            } => DMatrix::from_column_slice(rows, columns, &x[first..first + rows * columns]),
        }
    }
}

/// An affine, symmetric-matrix-valued function that must be positive semidefinite.
pub(super) type Inequality<'a> = &'a dyn Fn(&[f64]) -> DMatrix<f64>;

/// Where the solver stopped.
#[derive(Clone, Debug)]
pub(super) struct Optimum {
    pub(super) status: SolverStatus,
    pub(super) iterations: u32,
    pub(super) solve_time_s: f64,
    pub(super) x: Vec<f64>,
}

impl Optimum {
    /// Itself if `x` may be used at all: solved, or nearly so.
    pub(super) fn usable(self, step: Step) -> Result<Self, SynthesisError> {
        match self.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(self),
            status => Err(SynthesisError::SolverFailed {
                step,
                status: format!("{status:?}"),
                iterations: self.iterations,
            }),
        }
    }
}

/// Minimises the affine `cost` subject to every inequality.
///
/// `None` if Clarabel refuses the problem's data.
pub(super) fn minimise(
    variables: usize,
    cost: &dyn Fn(&[f64]) -> f64,
    inequalities: &[Inequality<'_>],
) -> Option<Optimum> {
    lapack::ensure_linked();
    let zero = vec![0.0; variables];
    let blocks = inequalities
        .iter()
        .map(|inequality| Block::new(inequality, variables));
    let (blocks, columns) = equilibrated(blocks.collect(), variables);
    let (constraints, right) = stacked(&blocks, &columns);
    let linear: Vec<f64> = columns
        .iter()
        .enumerate()
        .map(|(k, scale)| (cost(&unit(variables, k)) - cost(&zero)) * scale)
        .collect();
    let cones: Vec<_> = blocks
        .iter()
        .map(|block| PSDTriangleConeT(block.rows.len()))
        .collect();

    let no_quadratic = CscMatrix::zeros((variables, variables));
    let mut solver = DefaultSolver::new(
        &no_quadratic,
        &linear,
        &constraints,
        &right,
        &cones,
        settings(),
    )
    .ok()?;
    solver.solve();
    Some(Optimum {
        status: solver.solution.status,
        iterations: solver.solution.iterations,
        solve_time_s: solver.solution.solve_time,
        x: zip(solver.solution.x, columns)
            .map(|(x, scale)| x * scale)
            .collect(),
    })
}

/// The point whose only entry that is not zero is the k-th, a one.
fn unit(variables: usize, k: usize) -> Vec<f64> {
    let mut x = vec![0.0; variables];
    x[k] = 1.0;
    x
}

/// How Clarabel is to solve.
fn settings() -> DefaultSettings<f64> {
    // One thread and no time limit: the same problem always ends in the same bits.
    DefaultSettings {
        verbose: false,
        max_threads: 1,
        equilibrate_enable: false,
        direct_solve_method: "qdldl".into(),
        chordal_decomposition_enable: false,
        ..DefaultSettings::default()
    }
}

/// A and b of A x + s = b with s = svec F(x) in the cone: b = svec F_0, column k of A = -svec F_k.
fn stacked(blocks: &[Block], columns: &[f64]) -> (CscMatrix<f64>, Vec<f64>) {
    let mut column_start = vec![0];
    let mut row = Vec::new();
    let mut value = Vec::new();
    for (k, scale) in columns.iter().enumerate() {
        let column = blocks
            .iter()
            .flat_map(|block| svec(&block.scaled(&block.coefficients[k])));
        for (i, coefficient) in column.enumerate() {
            if coefficient != 0.0 {
                row.push(i);
                value.push(-coefficient * scale);
            }
        }
        column_start.push(row.len());
    }
    let right: Vec<f64> = blocks
        .iter()
        .flat_map(|block| svec(&block.scaled(&block.constant)))
        .collect();
    let constraints = CscMatrix::new(right.len(), columns.len(), column_start, row, value);
    (constraints, right)
}

/// An inequality `F_0 + sum of x_k F_k >= 0`, seen as `diag(rows) F diag(rows) >= 0`.
struct Block {
    constant: DMatrix<f64>,
    coefficients: Vec<DMatrix<f64>>,
    rows: Vec<f64>,
}

impl Block {
    /// The coefficients of an affine function of so many variables, not yet scaled.
    fn new(inequality: Inequality<'_>, variables: usize) -> Self {
        let constant = inequality(&vec![0.0; variables]);
        let coefficients = (0..variables)
            .map(|k| inequality(&unit(variables, k)) - &constant)
            .collect();
        Self {
            rows: vec![1.0; constant.nrows()],
            constant,
            coefficients,
        }
    }

    fn scaled(&self, m: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| {
            m[(i, j)] * self.rows[i] * self.rows[j]
        })
    }
}

/// Scales rows by congruence and variables until the largest coefficient in
/// each is near one, in exact powers of two: Ruiz's equilibration, which Clarabel's
/// own cannot do inside a semidefinite cone.
fn equilibrated(mut blocks: Vec<Block>, variables: usize) -> (Vec<Block>, Vec<f64>) {
    let mut columns = vec![1.0; variables];
    for _ in 0..EQUILIBRATION_ROUNDS {
        let mut column_max = vec![0.0_f64; variables];
        for block in &mut blocks {
            let mut row_max = vec![0.0_f64; block.rows.len()];
            for ((coefficient, largest), scale) in
                zip(&block.coefficients, &mut column_max).zip(&columns)
            {
                let scaled = block.scaled(coefficient) * *scale;
                *largest = largest.max(max_abs(&scaled));
                for (largest, row) in zip(&mut row_max, scaled.row_iter()) {
                    *largest = row.iter().fold(*largest, |m, x| m.max(x.abs()));
                }
            }
            for (row, largest) in zip(&mut block.rows, row_max) {
                *row *= power_of_two_near(largest.sqrt().recip());
            }
        }
        for (column, largest) in zip(&mut columns, column_max) {
            *column *= power_of_two_near(largest.sqrt().recip());
        }
    }
    (blocks, columns)
}

/// Upper triangle stacked by columns, off-diagonal entries times sqrt 2, so
/// that the inner product of vectors is that of matrices.
fn svec(m: &DMatrix<f64>) -> Vec<f64> {
    let mut stacked = Vec::with_capacity(m.ncols() * (m.ncols() + 1) / 2);
    for j in 0..m.ncols() {
        stacked.extend((0..j).map(|i| m[(i, j)] * SQRT_2));
        stacked.push(m[(j, j)]);
    }
    stacked
}
