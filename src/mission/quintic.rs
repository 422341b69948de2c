//! The polynomial of fifth degree through position, velocity and acceleration at both ends of an epoch.

/// Coordinate, velocity and acceleration: x (m), x' (m/s), x'' (m/s²).
pub type AxisState = [f64; 3];

/// r(t) = Σ c_i t^i for t from 0 to the end of an epoch, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quintic {
    /// c_0 to c_5, m/s^i.
    pub coefficients: [f64; 6],
}

impl Quintic {
    /// The polynomial that is `from` at the time zero and `to` after `duration_s`.
    #[must_use]
    pub fn between(from: AxisState, to: AxisState, duration_s: f64) -> Self {
        let t = duration_s;
        let [p0, v0, a0] = from;
        let [p1, v1, a1] = to;
        // What the second-order expansion from the start leaves to reach, in m.
        let place = p1 - p0 - v0 * t - a0 * t * t / 2.0;
        let speed = (v1 - v0 - a0 * t) * t;
        let acceleration = (a1 - a0) * t * t;
        let (t3, t4, t5) = (t * t * t, t * t * t * t, t * t * t * t * t);
        Self {
            coefficients: [
                p0,
                v0,
                a0 / 2.0,
                (10.0 * place - 4.0 * speed + acceleration / 2.0) / t3,
                (-15.0 * place + 7.0 * speed - acceleration) / t4,
                (6.0 * place - 3.0 * speed + acceleration / 2.0) / t5,
            ],
        }
    }

    /// r, r' and r'' at a time of the epoch, s.
    #[must_use]
    pub fn at(&self, t: f64) -> AxisState {
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        [
            ((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0,
            (((5.0 * c5 * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1,
            ((20.0 * c5 * t + 12.0 * c4) * t + 6.0 * c3) * t + 2.0 * c2,
        ]
    }
}
