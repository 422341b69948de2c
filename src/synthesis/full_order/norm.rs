//! The H-infinity norm of the closed loop (23) of many states, by a sweep over frequencies.
//!
//! The loop is triangular: the estimation error drives the tracking error, not the other way round. So both halves are
//! solved one after the other, and the largest singular value is found by power iteration without forming the response.

use crate::synthesis::closed_loop::ClosedLoop;
use crate::synthesis::margins::resolvent;
use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};
use std::f64::consts::PI;

/// Frequencies of the sweep, rad/s: from the slowest integral modes to above every observer pole.
const SWEEP_RAD_S: [f64; 2] = [1e-4, 1e4];
/// Width of the bracket around a peak that ends its refinement, in the logarithm of the frequency: a peak's value
/// changes by its square.
const BRACKET: f64 = 1e-5;
const MAX_ITERATIONS: usize = 1000;
/// Relative changes of the gain from one power iteration to the next that end it: in the sweep, which only looks for
/// the peak, and at the peak.
const SETTLED: [f64; 2] = [1e-6, 1e-10];

/// The largest gain over the frequencies of a sweep of so many a decade, refined about the largest, and its frequency
/// in rad/s; a lower bound of the norm, which a certificate just above it confirms. The first `tracking` states are
/// those of the tracking half.
pub(super) fn hinf_norm(
    closed_loop: &ClosedLoop,
    tracking: usize,
    points_per_decade: u32,
) -> Option<(f64, f64)> {
    let response = &Response::new(closed_loop, tracking);
    let [coarse, fine] =
        SETTLED.map(|settled| move |log_omega: f64| response.gain(log_omega.exp(), settled));
    let at_rest = (response.gain(0.0, SETTLED[1])?, 0.0);
    let [low, high] = SWEEP_RAD_S.map(f64::ln);
    let step = std::f64::consts::LN_10 / f64::from(points_per_decade);
    let mut best = (f64::NEG_INFINITY, low);
    let mut at = low;
    while at < high + step {
        let found = coarse(at)?;
        if found > best.0 {
            best = (found, at);
        }
        at += step;
    }
    let (value, at) = refined(fine, best, step)?;
    let peak = (value, at.exp());
    Some(if peak.0 > at_rest.0 { peak } else { at_rest })
}

/// The largest gain at some frequencies, rad/s, to a few digits.
pub(super) fn largest_gain(
    closed_loop: &ClosedLoop,
    tracking: usize,
    omegas_rad_s: &[f64],
) -> Option<f64> {
    let response = Response::new(closed_loop, tracking);
    let gains = omegas_rad_s
        .iter()
        .map(|&omega| response.gain(omega, SETTLED[0]));
    gains
        .collect::<Option<Vec<f64>>>()?
        .into_iter()
        .reduce(f64::max)
}

/// The maximum within one step of the best sample, by golden section.
fn refined(value: impl Fn(f64) -> Option<f64>, best: (f64, f64), step: f64) -> Option<(f64, f64)> {
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (best.1 - step, best.1 + step);
    let (mut left, mut right) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_left, mut at_right) = (value(left)?, value(right)?);
    while high - low > BRACKET {
        if at_left > at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - ratio * (high - low);
            at_left = value(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + ratio * (high - low);
            at_right = value(right)?;
        }
    }
    let inner = if at_left > at_right {
        (at_left, left)
    } else {
        (at_right, right)
    };
    Some(if inner.0 > best.0 { inner } else { best })
}

type Complexes = DMatrix<Complex<f64>>;
type Factors = LU<Complex<f64>, Dyn, Dyn>;

/// The closed loop as blocks of its two halves, ready for a frequency.
struct Response {
    /// A + B K and A + L C.
    halves: [Complexes; 2],
    /// How the estimation error drives the tracking error, -B K.
    drive: Complexes,
    weight: Complexes,
    /// One where a model error enters, zero elsewhere.
    entering: DVector<f64>,
}

impl Response {
    fn new(closed_loop: &ClosedLoop, tracking: usize) -> Self {
        let n = closed_loop.a.nrows();
        let estimation = n - tracking;
        let block =
            |(row, column), shape| closed_loop.a.view((row, column), shape).map(Complex::from);
        Self {
            halves: [
                block((0, 0), (tracking, tracking)),
                block((tracking, tracking), (estimation, estimation)),
            ],
            drive: block((0, tracking), (tracking, estimation)),
            weight: closed_loop.weight.map(Complex::from),
            entering: DVector::from_fn(n, |row, _| closed_loop.e.row(row).sum()),
        }
    }

    /// The largest singular value of the response to model errors at a frequency in rad/s, until it changes by a share
    /// of `settled` only.
    fn gain(&self, omega: f64, settled: f64) -> Option<f64> {
        let [tracking, estimation] = [0, 1].map(|half| resolvent(&self.halves[half], omega));
        let [tracking_of, estimation_of] = [&tracking, &estimation].map(Triangles::new);
        let m = self.drive.nrows();
        let mut v = self.start();
        let mut gain: f64 = 0.0;
        for _ in 0..MAX_ITERATIONS {
            // x = (j omega - A)^-1 E v
            let below = estimation.solve(&v.rows_range(m..))?;
            let above = tracking.solve(&(v.rows_range(..m) + &self.drive * &below))?;
            let mut x = v.clone();
            x.rows_range_mut(..m).copy_from(&above);
            x.rows_range_mut(m..).copy_from(&below);
            // E' (j omega - A)^-* W x
            let weighted = &self.weight * &x;
            let next = x.dotc(&weighted).re.max(0.0).sqrt();
            let above = tracking_of.solve_adjoint(weighted.rows_range(..m).into_owned())?;
            let driven = weighted.rows_range(m..) + self.drive.ad_mul(&above);
            let below = estimation_of.solve_adjoint(driven)?;
            v.rows_range_mut(..m).copy_from(&above);
            v.rows_range_mut(m..).copy_from(&below);
            self.let_in(&mut v);
            let change = (next - gain).abs();
            gain = next;
            if change <= settled * gain || v.norm() == 0.0 {
                break;
            }
            v.normalize_mut();
        }
        gain.is_finite().then_some(gain)
    }

    /// Model errors of one length in no direction that the loop could be symmetric about.
    fn start(&self) -> DVector<Complex<f64>> {
        let mut angle = 0.0;
        let mut v = DVector::from_fn(self.entering.len(), |_, _| {
            // The golden angle never repeats.
            angle += PI * (3.0 - 5.0_f64.sqrt());
            Complex::from_polar(1.0, angle)
        });
        self.let_in(&mut v);
        v.normalize_mut();
        v
    }

    /// Only what enters.
    fn let_in(&self, v: &mut DVector<Complex<f64>>) {
        v.zip_apply(&self.entering, |v, entering| *v *= entering);
    }
}

/// The triangular factors of a matrix, to solve with its adjoint.
struct Triangles<'a> {
    factors: &'a Factors,
    lower: Complexes,
    upper: Complexes,
}

impl<'a> Triangles<'a> {
    fn new(factors: &'a Factors) -> Self {
        Self {
            factors,
            lower: factors.l(),
            upper: factors.u(),
        }
    }

    /// The solution of M* x = y, with P M = L U.
    fn solve_adjoint(&self, y: DVector<Complex<f64>>) -> Option<DVector<Complex<f64>>> {
        let mut x = self.upper.ad_solve_upper_triangular(&y)?;
        x = self.lower.ad_solve_lower_triangular(&x)?;
        self.factors.p().inv_permute_rows(&mut x);
        Some(x)
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;
    use crate::synthesis::{ControllerGains, Preset, feedback_riccati, observer_riccati};

    #[test]
    fn val_norm_of_a_channel_is_that_of_the_dense_response() {
        for preset in Preset::ALL {
            let design = preset.designs()[0].1.clone();
            let k = feedback_riccati(&design).unwrap().gain;
            let l = observer_riccati(&design, &k).unwrap().gain;
            let gains = ControllerGains::from_matrices(&k, &l);
            let closed_loop = ClosedLoop::of(&design, &gains);
            let (expected, _) = closed_loop.hinf_norm().unwrap();
            let (found, _) = hinf_norm(&closed_loop, design.states(), 8).unwrap();
            // Both refine the peak until its value no longer changes in nine digits.
            assert!(
                (found / expected - 1.0).abs() < 1e-8,
                "{preset:?}: {found} {expected}"
            );
        }
    }
}
