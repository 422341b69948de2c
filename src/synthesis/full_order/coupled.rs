//! The augmented system (19) of a group of n channels that share sensors and o sensor faults: its states are
//! [int e (n), e (n), e' (n), F1 (n by tap), F2 (o by tap)].
//!
//! A and B are Kronecker products with the identity whatever the sensors are, so that the feedback of step 1 is that of
//! a channel alone; only C couples, and with it the filter of step 2.

use super::sensors::Sensors;
use crate::synthesis::channel::{Channel, ERROR_STATES, error_channel, inputs};
use crate::synthesis::closed_loop::ClosedLoop;
use crate::synthesis::design::ChannelDesign;
use crate::synthesis::linalg::diagonal;
use crate::synthesis::observer::ObserverProblem;
use nalgebra::DMatrix;

/// A group of channels with the weights of one of them and its sensors.
#[derive(Clone, Debug)]
pub(super) struct CoupledChannels<'a> {
    design: &'a ChannelDesign,
    channels: usize,
    faults: usize,
    /// Noise weights nu, one per sensor.
    noise: Vec<f64>,
    /// Abar (N x N), Bbar (N x n) and Cbar (l x N) of (19).
    pub(super) system: Channel,
}

impl<'a> CoupledChannels<'a> {
    /// The system of `sensors` with the smoothing models of `design`.
    pub(super) fn new(design: &'a ChannelDesign, sensors: &Sensors) -> Self {
        let (n, o) = (sensors.channels().len(), sensors.faults().len());
        let [taps1, taps2] = design.smoothing.taps();
        let [errors, f1, f2] = [0, ERROR_STATES * n, (ERROR_STATES + taps1) * n];
        let states = f2 + taps2 * o;
        let error = error_channel();
        let of_channels = |m: &DMatrix<f64>| m.kronecker(&DMatrix::<f64>::identity(n, n));
        let of_faults = |m: &DMatrix<f64>| m.kronecker(&DMatrix::<f64>::identity(o, o));

        let mut a = DMatrix::zeros(states, states);
        let mut b = DMatrix::zeros(states, n);
        let mut c = DMatrix::zeros(sensors.rows().len(), states);
        let b0 = of_channels(&error.b);
        for (row, column, block) in [
            (errors, errors, of_channels(&error.a)),
            // B C1: the newest tap of the actuator fault accelerates.
            (errors, f1, b0.clone()),
            (f1, f1, of_channels(&design.smoothing.matrix(taps1))),
            (f2, f2, of_faults(&design.smoothing.matrix(taps2))),
        ] {
            a.view_mut((row, column), block.shape()).copy_from(&block);
        }
        b.view_mut((0, 0), b0.shape()).copy_from(&b0);
        let (of_errors, b2) = (sensors.c(), sensors.b2());
        c.view_mut((0, errors), of_errors.shape())
            .copy_from(&of_errors);
        // B2 C2: the newest tap of each sensor fault is what sensors show of it.
        c.view_mut((0, f2), b2.shape()).copy_from(&b2);
        Self {
            design,
            channels: n,
            faults: o,
            noise: sensors.rows().iter().map(|row| row.noise).collect(),
            system: Channel { a, b, c },
        }
    }

    /// Number of states N = 3 n + (w1 + 1) n + (w2 + 1) o.
    pub(super) fn states(&self) -> usize {
        self.system.a.nrows()
    }

    /// K (n x N) of all channels from that of one (1 x s), which has none on the sensor fault.
    pub(super) fn feedback(&self, k: &DMatrix<f64>) -> DMatrix<f64> {
        let own = ERROR_STATES + self.design.smoothing.taps()[0];
        let identity = DMatrix::<f64>::identity(self.channels, self.channels);
        // Negative gains times zero are negative zeros.
        let k = k.columns(0, own).kronecker(&identity).add_scalar(0.0);
        k.resize(self.channels, self.states(), 0.0)
    }

    /// The filter problem of step 2 for K (n x N): Qf = Q2 + R K'K, E = [1 on the newest taps F1, eps2 on those of F2].
    pub(super) fn filter(&self, k: &DMatrix<f64>) -> ObserverProblem {
        let f1 = ERROR_STATES * self.channels;
        let f2 = f1 + self.design.smoothing.taps()[0] * self.channels;
        let newest = (f1..f1 + self.channels).chain(f2..f2 + self.faults);
        let mut e = inputs(self.states(), newest);
        e.columns_mut(self.channels, self.faults)
            .scale_mut(self.design.eps2);
        ObserverProblem {
            channel: self.system.clone(),
            q: self.estimation_weight() + k.transpose() * k * self.design.r,
            e,
            noise: self.noise.clone(),
        }
    }

    /// The closed loop (23) of K (n x N) and L (N x l) with the weights of (24).
    pub(super) fn closed_loop(&self, k: &DMatrix<f64>, l: &DMatrix<f64>) -> ClosedLoop {
        let mut tracking = self.design.q1.to_vec();
        tracking.resize(self.design.states(), 0.0);
        ClosedLoop::joined(
            &self.system,
            [k, l],
            [&self.of_states(&tracking), &self.estimation_weight()],
            self.design.r,
            ERROR_STATES * self.channels,
        )
    }

    /// The states of the tracking half that reach the weighted output: the error and the taps of F1 that feed back.
    /// The others neither drive these nor are weighted.
    pub(super) fn seen_states(&self) -> usize {
        (ERROR_STATES + self.design.smoothing.active_taps()) * self.channels
    }

    /// Q2 of (24) on all states.
    fn estimation_weight(&self) -> DMatrix<f64> {
        self.of_states(&self.design.q2)
    }

    /// The diagonal matrix of the weights of a channel's states (s), repeated for every channel and fault.
    fn of_states(&self, weights: &[f64]) -> DMatrix<f64> {
        let own = ERROR_STATES + self.design.smoothing.taps()[0];
        let weights = weights.iter().enumerate().flat_map(|(state, &weight)| {
            let count = if state < own {
                self.channels
            } else {
                self.faults
            };
            std::iter::repeat_n(weight, count)
        });
        diagonal(&weights.collect::<Vec<_>>())
    }
}
