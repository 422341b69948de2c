//! A reference that swings for ever.

use super::point::ReferencePoint;

/// r(t) = center + amplitude sin(frequency t + phase), in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Mean.
    pub center: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Phase at t = 0, rad.
    pub phase_rad: f64,
}

impl Sinusoid {
    /// The sinusoid at time `t_s`.
    #[must_use]
    pub fn at(&self, t_s: f64) -> ReferencePoint {
        let (sine, cosine) = (self.frequency_rad_s * t_s + self.phase_rad).sin_cos();
        let rate = self.amplitude * self.frequency_rad_s;
        ReferencePoint {
            value: self.center + self.amplitude * sine,
            rate: rate * cosine,
            acceleration: -rate * self.frequency_rad_s * sine,
        }
    }
}
