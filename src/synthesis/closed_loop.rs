//! The closed loop (23) of one channel with the weights of (24), and its true H-infinity norm.

use super::channel::{
    Channel, ERROR_STATES, augmented_channel, estimation_weight, inputs, tracking_weight,
};
use super::design::ChannelDesign;
use super::gains::ControllerGains;
use super::linalg::join;
use super::margins::{peak, resolvent, sweep};
use nalgebra::{Complex, DMatrix, SymmetricEigen};

const MAX_EIGEN_ITERATIONS: usize = 10_000;

/// x' = A x + E v with the cost x' W x; x = [augmented error; estimation error], 2 s states.
#[derive(Clone, Debug)]
pub(super) struct ClosedLoop {
    /// A~ of (23).
    pub(super) a: DMatrix<f64>,
    /// Ones where a model error v enters: on the F rows of both halves.
    pub(super) e: DMatrix<f64>,
    /// Q + K~' R K~ of (27).
    pub(super) weight: DMatrix<f64>,
}

impl ClosedLoop {
    /// The closed loop of `gains`, which must have as many states as the design.
    pub(super) fn of(design: &ChannelDesign, gains: &ControllerGains) -> Self {
        Self::joined(
            &augmented_channel(design),
            [&gains.k_matrix(), &gains.l_matrix()],
            [&tracking_weight(design), &estimation_weight(design)],
            design.r,
            ERROR_STATES,
        )
    }

    /// The closed loop of a channel, or of several that share sensors, with K and L, Q1 and Q2, and R; the states after
    /// the first `errors` are those of faults.
    pub(super) fn joined(
        channel: &Channel,
        [k, l]: [&DMatrix<f64>; 2],
        [q1, q2]: [&DMatrix<f64>; 2],
        r: f64,
        errors: usize,
    ) -> Self {
        let s = channel.a.nrows();
        let bk = &channel.b * k;
        let zero = DMatrix::zeros(s, s);
        let a = join(&[
            [&(&channel.a + &bk), &-&bk],
            [&zero, &(&channel.a + l * &channel.c)],
        ]);
        let q = join(&[[q1, &zero], [&zero, q2]]);
        let k_tilde = join(&[[k, &-k]]);
        let fault_rows = (errors..s).chain(s + errors..2 * s);
        Self {
            a,
            e: inputs(2 * s, fault_rows),
            weight: q + k_tilde.transpose() * k_tilde * r,
        }
    }

    /// Only the listed states and the model errors that enter them.
    ///
    /// Exact if no listed state depends on one that is left out, and none left out is weighted.
    pub(super) fn restricted(&self, states: &[usize]) -> Self {
        let square = |m: &DMatrix<f64>| m.select_rows(states).select_columns(states);
        let e = self.e.select_rows(states);
        let entering: Vec<usize> = (0..e.ncols())
            .filter(|&j| e.column(j).iter().any(|&x| x != 0.0))
            .collect();
        Self {
            a: square(&self.a),
            e: e.select_columns(&entering),
            weight: square(&self.weight),
        }
    }

    /// The closed loop in coordinates `to` x, with `from` the inverse of `to`.
    pub(super) fn transformed(&self, to: &DMatrix<f64>, from: &DMatrix<f64>) -> Self {
        Self {
            a: to * &self.a * from,
            e: to * &self.e,
            weight: from.transpose() * &self.weight * from,
        }
    }

    /// The left side of (27) for P and an attenuation level.
    pub(super) fn inequality_27(&self, p: &DMatrix<f64>, rho: f64) -> DMatrix<f64> {
        let pe = p * &self.e;
        &self.weight + p * &self.a + self.a.transpose() * p + &pe * pe.transpose() / rho.powi(2)
    }

    /// The H-infinity norm from v to the weighted output and the frequency of
    /// its peak in rad/s, by a frequency sweep: a lower bound of every level that (27) certifies.
    pub(super) fn hinf_norm(&self) -> Option<(f64, f64)> {
        let a = self.a.map(Complex::from);
        let e = self.e.map(Complex::from);
        let weight = self.weight.map(Complex::from);
        let gain = |omega: f64| {
            let response = resolvent(&a, omega).solve(&e)?;
            let gram = response.adjoint() * &weight * &response;
            let eigen = SymmetricEigen::try_new(gram, f64::EPSILON, MAX_EIGEN_ITERATIONS)?;
            Some(eigen.eigenvalues.max().max(0.0).sqrt())
        };
        let at_rest = gain(0.0)?;
        let (peak_rad_s, peak_gain) = peak(&sweep(), gain)?;
        Some(if peak_gain > at_rest {
            (peak_gain, peak_rad_s)
        } else {
            (at_rest, 0.0)
        })
    }
}
