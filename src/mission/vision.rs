//! What agents see: time within range of a target, line of sight, and the closed forms of searching.

use crate::mission::plane::{Point, dot, minus};

/// Below it the square of a motion's length counts as no motion, m².
const STILL_M2: f64 = 1e-18;

/// A sensor that finds a target within its range at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// m.
    pub range_m: f64,
    /// Finds per second while a target is within range.
    pub rate_per_s: f64,
}

/// The part [u, v] of a straight motion from `from` (0) to `to` (1) that lies within `range_m` of a point; none if the
/// motion does not come so near.
#[must_use]
pub fn chord(from: Point, to: Point, centre: Point, range_m: f64) -> Option<[f64; 2]> {
    let (way, place) = (minus(to, from), minus(from, centre));
    // |place + u way|² = range²
    let (a, b) = (dot(way, way), dot(place, way));
    let c = dot(place, place) - range_m * range_m;
    if a < STILL_M2 {
        return (c <= 0.0).then_some([0.0, 1.0]);
    }
    let discriminant = b * b - a * c;
    if discriminant.is_nan() || discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let [u, v] = [((-b - root) / a).max(0.0), ((-b + root) / a).min(1.0)];
    (v > u).then_some([u, v])
}

/// The probability that a sensor that passes a target on a straight line at a speed finds it, by the distance of the
/// line (Koopman, "Search and Screening", 1946).
#[must_use]
pub fn lateral_probability(sensor: &Sensor, speed_m_s: f64, distance_m: f64) -> f64 {
    let half_m2 = sensor.range_m * sensor.range_m - distance_m * distance_m;
    let within_s = 2.0 * half_m2.max(0.0).sqrt() / speed_m_s;
    -(-sensor.rate_per_s * within_s).exp_m1()
}

/// Sweep width: the integral of [`lateral_probability`] over all distances, m.
#[must_use]
pub fn sweep_width_m(sensor: &Sensor, speed_m_s: f64) -> f64 {
    // With the distance R sin φ the integrand is smooth.
    let integrand = |phi: f64| {
        let (sine, cosine) = phi.sin_cos();
        let distance_m = sensor.range_m * sine;
        lateral_probability(sensor, speed_m_s, distance_m) * sensor.range_m * cosine
    };
    2.0 * simpson(integrand, 0.0, std::f64::consts::FRAC_PI_2)
}

/// The probability that one sweep in many parallel lanes finds a target somewhere between two of them.
#[must_use]
pub fn lanes_probability(sensor: &Sensor, speed_m_s: f64, spacing_m: f64) -> f64 {
    let rate = 2.0 * sensor.rate_per_s / speed_m_s;
    let lanes = (sensor.range_m / spacing_m).ceil() + 1.0;
    let missed = |y: f64| {
        let mut exposure = 0.0;
        let mut lane = -lanes;
        while lane <= lanes + 1.0 {
            let distance_m = y - lane * spacing_m;
            let half_m2 = sensor.range_m * sensor.range_m - distance_m * distance_m;
            exposure += rate * half_m2.max(0.0).sqrt();
            lane += 1.0;
        }
        (-exposure).exp()
    };
    // The exposure has kinks where a lane comes into range; the substitution sin² flattens each piece's ends.
    let mut kinks = vec![0.0, spacing_m];
    let mut lane = -lanes;
    while lane <= lanes + 1.0 {
        let ends = [-1.0, 1.0].map(|side| lane * spacing_m + side * sensor.range_m);
        kinks.extend(ends.into_iter().filter(|&y| 0.0 < y && y < spacing_m));
        lane += 1.0;
    }
    kinks.sort_by(f64::total_cmp);
    let piece = |ends: &[f64]| {
        let width = ends[1] - ends[0];
        let integrand = |phi: f64| {
            let (sine, cosine) = phi.sin_cos();
            missed(ends[0] + width * sine * sine) * 2.0 * width * sine * cosine
        };
        simpson(integrand, 0.0, std::f64::consts::FRAC_PI_2)
    };
    let missed: f64 = kinks.windows(2).map(piece).sum();
    1.0 - missed / spacing_m
}

/// ∫ f by Simpson's rule; the integrands here are smooth, its error is below 1e-9 of them.
fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PIECES: u32 = 400;
    let h = (to - from) / f64::from(PIECES);
    let weight = |k: u32| match k {
        0 | PIECES => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let terms = (0..=PIECES).map(|k| weight(k) * f(from + h * f64::from(k)));
    terms.sum::<f64>() * h / 3.0
}
