//! The centre of mass that makes the zero moment point follow its reference (paper, (6), (7)).

use nalgebra::{Matrix3, Matrix3x2, RowVector3, Vector3};

/// Standard gravity as the paper has it, m/s².
pub(super) const GRAVITY_M_S2: f64 = 9.81;
/// Weight Q of the tracking error, 1/m².
const ERROR_WEIGHT: f64 = 1.0;
/// Weight R of the input, the third derivative of the position, s⁶/m².
const JERK_WEIGHT: f64 = 1e-8;
/// Weight P of the last tracking error, 1/m².
const END_WEIGHT: f64 = 1.0;

/// The planned centre of mass at the sampling instants.
#[derive(Clone, Debug, PartialEq)]
pub struct CenterOfMass {
    /// (position, velocity, acceleration) of x and of y, m, m/s, m/s².
    pub states: Vec<[[f64; 3]; 2]>,
    /// The zero moment point of the pendulum, C x of (7), m.
    pub zmp_m: Vec<[f64; 2]>,
    /// The height z_c at which the pendulum moves, m.
    pub height_m: f64,
    /// Feedback gain of the first sample.
    pub first_gain: [f64; 3],
}

/// Finite-horizon discrete LQ tracker (Lewis, Optimal Control, Table 4.4-1) on (7), discretised
/// exactly under a constant input over `sampling_s`. x and y are decoupled and share the gains.
///
/// It starts at rest above the first reference point.
#[must_use]
pub fn track(reference: &[[f64; 2]], height_m: f64, sampling_s: f64) -> CenterOfMass {
    let h = sampling_s;
    let a = Matrix3::new(1.0, h, 0.5 * h * h, 0.0, 1.0, h, 0.0, 0.0, 1.0);
    let b = Vector3::new(h * h * h / 6.0, 0.5 * h * h, h);
    let c = RowVector3::new(1.0, 0.0, -height_m / GRAVITY_M_S2);
    let outer = c.transpose() * c;
    let pull = |r: &[f64; 2]| Matrix3x2::from_fn(|i, axis| c[i] * r[axis]);

    // Backward: S(N) = C'PC, v(N) = C'P r(N), and the gains K(k), Kᵛ(k) with v(k + 1).
    let last = reference.last().copied().unwrap_or_default();
    let mut s = outer * END_WEIGHT;
    let mut v = pull(&last) * END_WEIGHT;
    let mut gains = Vec::with_capacity(reference.len());
    for r in reference.iter().rev().skip(1) {
        let weight = (b.transpose() * s * b)[0] + JERK_WEIGHT;
        let feedback: RowVector3<f64> = b.transpose() * s * a / weight;
        let feedforward = b.transpose() * v / weight;
        gains.push((feedback, feedforward));
        let closed = a - b * feedback;
        s = a.transpose() * s * closed + outer * ERROR_WEIGHT;
        v = closed.transpose() * v + pull(r) * ERROR_WEIGHT;
    }

    // Forward: u = -K x + Kᵛ v.
    let start = reference.first().copied().unwrap_or_default();
    let mut x = Matrix3x2::from_fn(|i, axis| if i == 0 { start[axis] } else { 0.0 });
    let mut states = vec![x];
    for (feedback, feedforward) in gains.iter().rev() {
        x = a * x + b * (feedforward - feedback * x);
        states.push(x);
    }
    let first = gains.last().map(|(feedback, _)| *feedback);
    CenterOfMass {
        zmp_m: states
            .iter()
            .map(|x| (c * x).into())
            .map(|[[x], [y]]: [[f64; 1]; 2]| [x, y])
            .collect(),
        states: states.into_iter().map(Into::into).collect(),
        height_m,
        first_gain: first.map_or([0.0; 3], |k| [k[0], k[1], k[2]]),
    }
}
