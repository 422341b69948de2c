//! Dryden's model of turbulence at low altitude (MIL-F-8785C, 3.7.1 to 3.7.3): gust speeds as white noise through
//! rational filters, whose force is the drag of that speed.
//!
//! The field of gusts is frozen and swept at the airspeed. Near hovering that picture ends: at a small airspeed the
//! gusts grow slower without end, so the airspeed must be given, as that of a UAV that stands against the wind. Below 3
//! m (10 ft) the model is not defined.

use super::noise::Filter;
use crate::random::philox::Address;
use std::f64::consts::TAU;

const FOOT_M: f64 = 0.3048;

/// The wind in which a UAV flies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dryden {
    /// Mean wind speed 20 ft above the ground, m/s.
    pub(crate) wind_m_s: f64,
    /// Height above the ground, m.
    pub(crate) altitude_m: f64,
    /// Speed at which the field is swept, m/s.
    pub(crate) airspeed_m_s: f64,
}

impl Dryden {
    /// Standard deviation of the gusts along an axis (0 with the wind, 1 across, 2 up), m/s, and their length, m.
    fn gusts(&self, axis: usize) -> (f64, f64) {
        let height_ft = self.altitude_m / FOOT_M;
        let shape = 0.177 + 0.000_823 * height_ft;
        let upwards_m_s = 0.1 * self.wind_m_s;
        if axis == 2 {
            (upwards_m_s, self.altitude_m)
        } else {
            let length_ft = height_ft / shape.powf(1.2);
            (upwards_m_s / shape.powf(0.4), length_ft * FOOT_M)
        }
    }

    /// The filter along an axis; `gain_n_s_m` is the force per speed.
    ///
    /// With T = length / airspeed and w white, z1' = (w - z1)/T and z2' = (z1 - z2)/T, scaled so that z1 has the
    /// variance 1. Along the wind the gust is sigma z1, whose spectrum goes with 1/(1 + (T s)^2); across it, sigma
    /// (sqrt 3 z1 + (1 - sqrt 3) z2) / sqrt 2, for (1 + sqrt 3 T s)/(1 + T s)^2. Both have the variance sigma^2.
    pub(crate) fn filter(&self, axis: usize, gain_n_s_m: f64, step_s: f64) -> Filter<f64> {
        let (sigma_m_s, length_m) = self.gusts(axis);
        let share = step_s * self.airspeed_m_s / length_m;
        let keep = (-share).exp();
        let cross = share * keep;
        // What noise has to add in a step for the covariance [1, 1/2; 1/2, 1/2] to stay.
        let q11 = 1.0 - keep * keep;
        let q21 = 0.5 - keep * (cross + 0.5 * keep);
        let q22 = 0.5 - (cross * cross + cross * keep + 0.5 * keep * keep);
        let n11 = q11.sqrt();
        let n21 = q21 / n11;
        let n22 = (q22 - n21 * n21).max(0.0).sqrt();
        let force_n = gain_n_s_m * sigma_m_s;
        let root = 3.0_f64.sqrt();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        Filter {
            keep,
            cross,
            noise: [n11, n21, n22],
            output: if axis == 0 {
                [force_n, 0.0]
            } else {
                [force_n * root * half, force_n * (1.0 - root) * half]
            },
        }
    }
}

impl Filter<f64> {
    /// No gusts at all.
    pub(crate) fn still() -> Self {
        Self {
            keep: 0.0,
            cross: 0.0,
            noise: [0.0; 3],
            output: [0.0; 2],
        }
    }
}

/// z1 and z2 of a filter that has run forever, from the random words of an address: their covariance is [1, 1/2; 1/2,
/// 1/2].
pub(crate) fn at_rest(address: Address, seed: u64) -> [f64; 2] {
    let unit = |word: u32| (f64::from(word) + 0.5) / 4_294_967_296.0;
    let [word, turn, ..] = address.words(seed).map(unit);
    let radius = (-2.0 * word.ln()).sqrt();
    let (sine, cosine) = (TAU * turn).sin_cos();
    let [first, second] = [radius * cosine, radius * sine];
    [first, 0.5 * (first + second)]
}
