//! Stability margins of one controller on one channel, loop broken at the plant input, and what it makes of noise.

use super::channel::{Channel, error_channel};
use super::gains::ControllerGains;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Frequencies the sweeps cover, rad/s: the slowest integral modes to well above every observer pole.
const SWEEP_RAD_S: [f64; 2] = [1e-4, 1e5];
const POINTS_PER_DECADE: u32 = 60;

/// Margins of the loop u -> e'' = u -> y -> observer -> K ehat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Margins {
    /// Largest magnitude Ms of the sensitivity 1 / (1 + loop gain).
    pub sensitivity_peak: f64,
    /// Smallest phase margin over all gain crossovers, degrees.
    pub phase_margin_deg: f64,
    /// Smallest dead time that destabilises the loop, ms.
    pub delay_margin_ms: f64,
    /// Gain crossover at which the delay margin is taken, rad/s.
    pub crossover_rad_s: f64,
    /// Largest gain over all frequencies from noise on what is sensed, x and x', one unit on each, to the feedback
    /// acceleration; the integral is computed and has none of its own.
    pub noise_peak: f64,
    /// The same in the root mean square: of white noise of unit density on x and on x', the standard deviation of the
    /// feedback acceleration.
    pub noise_h2: f64,
}

/// Margins of `gains` on a channel with as many states; `None` if the loop
/// gain never crosses one, which no stable loop around integrators does.
pub(super) fn margins(channel: &Channel, gains: &ControllerGains) -> Option<Margins> {
    let response = LoopGain::of(channel, gains);
    let loop_gain = |omega: f64| response.at(omega);
    let sensitivity = |omega: f64| Some((loop_gain(omega)? + 1.0).norm().recip());
    let grid = sweep();
    let (_, sensitivity_peak) = peak(&grid, sensitivity)?;
    let noise = |omega: f64| response.of_noise(omega);
    let (_, noise_peak) = peak(&grid, noise)?;

    let mut phase_margin_rad = f64::INFINITY;
    let mut delay_margin_s = f64::INFINITY;
    let mut crossover_rad_s = None;
    for pair in grid.windows(2) {
        let above = |omega: f64| Some(loop_gain(omega)?.norm() > 1.0);
        let (mut low, mut high) = (pair[0], pair[1]);
        let start = above(low)?;
        if start == above(high)? {
            continue;
        }
        while high / low > 1.0 + 1e-12 {
            let middle = (low * high).sqrt();
            if above(middle)? == start {
                low = middle;
            } else {
                high = middle;
            }
        }
        let phase = (loop_gain(high)?.arg() + PI).rem_euclid(TAU);
        // The phase may be lost by lag (delay) or, above 180 degrees, by lead.
        phase_margin_rad = phase_margin_rad.min(phase.min(TAU - phase));
        if phase / high < delay_margin_s {
            delay_margin_s = phase / high;
            crossover_rad_s = Some(high);
        }
    }
    Some(Margins {
        sensitivity_peak,
        phase_margin_deg: phase_margin_rad.to_degrees(),
        delay_margin_ms: delay_margin_s * 1e3,
        crossover_rad_s: crossover_rad_s?,
        noise_peak,
        noise_h2: root_of_power(&grid, noise)?,
    })
}

/// The H2 norm of a response of this size: the root of its squared size, integrated over all positive frequencies and
/// divided by pi. Below the grid it is taken as constant, above it as falling with the frequency.
fn root_of_power(grid: &[f64], size: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    // Over the logarithm of the frequency, in which the grid is even.
    let density = |&omega: &f64| Some(omega * size(omega)?.powi(2));
    let samples: Vec<f64> = grid.iter().map(density).collect::<Option<_>>()?;
    let pairs = grid.windows(2).zip(samples.windows(2));
    let within = pairs.map(|(at, of)| (at[1] / at[0]).ln() * f64::midpoint(of[0], of[1]));
    let beyond = samples.first()? + samples.last()?;
    Some(((within.sum::<f64>() + beyond) / PI).sqrt())
}

/// The loop gain with the sign of negative feedback.
pub(super) struct LoopGain {
    plant: Channel,
    /// Abar + Bbar K + L Cbar.
    observer: DMatrix<Complex<f64>>,
    k: DMatrix<Complex<f64>>,
    l: DMatrix<Complex<f64>>,
}

impl LoopGain {
    pub(super) fn of(channel: &Channel, gains: &ControllerGains) -> Self {
        let (k, l) = (gains.k_matrix(), gains.l_matrix());
        let observer = &channel.a + &channel.b * &k + &l * &channel.c;
        Self {
            plant: error_channel(),
            observer: observer.map(Complex::from),
            k: k.map(Complex::from),
            l: l.map(Complex::from),
        }
    }

    fn at(&self, omega: f64) -> Option<Complex<f64>> {
        Some((self.of_measurements(omega)? * self.of_error(omega)?)[(0, 0)])
    }

    /// The size of the closed loop's response u / noise, noise on x and x'.
    pub(super) fn of_noise(&self, omega: f64) -> Option<f64> {
        let open = self.of_measurements(omega)?;
        let gain = (&open * self.of_error(omega)?)[(0, 0)];
        Some(open.columns(1, 2).norm() / (gain + 1.0).norm())
    }

    /// The size of the error in answer to an acceleration, and in answer to an offset of what is measured, which enters
    /// there.
    pub(super) fn of_faults(&self, omega: f64, enters: &[f64; 3]) -> Option<[f64; 2]> {
        let (open, plant) = (self.of_measurements(omega)?, self.of_error(omega)?);
        let closed = (&open * &plant)[(0, 0)] + 1.0;
        // The states are the integral of e, e and e'.
        let error = plant[(1, 0)] / closed;
        let enters = DMatrix::from_column_slice(3, 1, enters).map(Complex::from);
        Some([error.norm(), (error * (open * enters)[(0, 0)]).norm()])
    }

    /// The measurements (3 x 1) in answer to the feedback acceleration.
    fn of_error(&self, omega: f64) -> Option<DMatrix<Complex<f64>>> {
        let plant = resolvent(&self.plant.a.map(Complex::from), omega);
        plant.solve(&self.plant.b.map(Complex::from))
    }

    /// The negative feedback acceleration in answer to each measurement (1 x 3): K (jw - Abar - Bbar K - L Cbar)^-1 L.
    fn of_measurements(&self, omega: f64) -> Option<DMatrix<Complex<f64>>> {
        Some(&self.k * resolvent(&self.observer, omega).solve(&self.l)?)
    }
}

/// The factored matrix j omega I - A.
pub(super) fn resolvent(
    a: &DMatrix<Complex<f64>>,
    omega: f64,
) -> nalgebra::LU<Complex<f64>, nalgebra::Dyn, nalgebra::Dyn> {
    let n = a.nrows();
    (DMatrix::from_diagonal_element(n, n, Complex::new(0.0, omega)) - a).lu()
}

/// A logarithmic grid of frequencies, rad/s.
pub(super) fn sweep() -> Vec<f64> {
    let [low, high] = SWEEP_RAD_S.map(f64::log10);
    let step = f64::from(POINTS_PER_DECADE).recip();
    let mut grid = Vec::new();
    for i in 0.. {
        let exponent = low + f64::from(i) * step;
        if exponent > high + step / 2.0 {
            break;
        }
        grid.push(10.0_f64.powf(exponent));
    }
    grid
}

/// The largest value over the grid, refined between the neighbours of the
/// largest sample: (frequency, value).
pub(super) fn peak(grid: &[f64], value: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let samples: Vec<f64> = grid.iter().map(|&w| value(w)).collect::<Option<_>>()?;
    let (best, _) = samples
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))?;
    let mut low = grid[best.saturating_sub(1)].ln();
    let mut high = grid[(best + 1).min(grid.len() - 1)].ln();
    // Golden section in the logarithm of the frequency.
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    while high - low > 1e-9 {
        let left = high - ratio * (high - low);
        let right = low + ratio * (high - low);
        if value(left.exp())? > value(right.exp())? {
            high = right;
        } else {
            low = left;
        }
    }
    let refined = low.midpoint(high).exp();
    let at_refined = value(refined)?;
    Some(if at_refined > samples[best] {
        (refined, at_refined)
    } else {
        (grid[best], samples[best])
    })
}
