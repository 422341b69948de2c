//! Straight flight from rest to rest, on the grid of epochs.

use crate::mission::plane::{Point, count, minus, moved, norm, number};
use crate::mission::quintic::Quintic;

/// Shorter legs are no legs, m.
const SHORTEST_M: f64 = 1e-9;
/// Peak of the ramp's acceleration over its mean: that of 3 x² - 2 x³.
const PEAK_OVER_MEAN: f64 = 1.5;
/// Durations and lengths of whole epochs, up to rounding, take no further one.
const ROUNDING: f64 = 1e-9;

/// How fast a UAV flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightLimits {
    /// Largest speed, m/s.
    pub speed_m_s: f64,
    /// Largest acceleration, m/s².
    pub acceleration_m_s2: f64,
}

/// Place, velocity and acceleration at the end of an epoch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Knot {
    /// (x, y), m.
    pub place_m: Point,
    /// m/s.
    pub velocity_m_s: [f64; 2],
    /// m/s².
    pub acceleration_m_s2: [f64; 2],
}

/// A straight leg: epochs in which the speed rises by v (3 x² - 2 x³), epochs at the speed v, and as many as of the
/// first kind in which it falls in the same way.
///
/// The ramps are quartics and the cruise is linear, so that the [`Quintic`] through the knots is the leg's very law and
/// its acceleration is continuous. Without its cruise the leg comes to rest earlier, on the same line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UavLeg {
    /// Epochs of each ramp.
    pub ramp: usize,
    /// Epochs of the cruise.
    pub cruise: usize,
    /// v, m/s.
    pub speed_m_s: f64,
    direction: [f64; 2],
    epoch_s: f64,
}

/// What a leg does in an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FlightPhase {
    /// The epoch of this index of the rise.
    Up(usize),
    Cruise,
    /// The epoch of this index of the fall.
    Down(usize),
}

/// An epoch of a leg and the knot at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FlightEpoch {
    pub(crate) leg: UavLeg,
    pub(crate) phase: FlightPhase,
    pub(crate) end: Knot,
}

impl Knot {
    /// At rest.
    #[must_use]
    pub fn at_rest(place_m: Point) -> Self {
        Self {
            place_m,
            ..Self::default()
        }
    }

    /// The motion from here to another knot in an epoch, along x and y.
    #[must_use]
    pub fn quintics_to(&self, to: &Self, epoch_s: f64) -> [Quintic; 2] {
        let state = |knot: &Self, i: usize| {
            [
                knot.place_m[i],
                knot.velocity_m_s[i],
                knot.acceleration_m_s2[i],
            ]
        };
        [0, 1].map(|i| Quintic::between(state(self, i), state(to, i), epoch_s))
    }
}

impl UavLeg {
    /// The leg between two places; none if they are the same.
    #[must_use]
    pub fn between(from: Point, to: Point, limits: &FlightLimits, epoch_s: f64) -> Option<Self> {
        let way = minus(to, from);
        let length_m = norm(way);
        if length_m < SHORTEST_M {
            return None;
        }
        let FlightLimits {
            speed_m_s,
            acceleration_m_s2,
        } = *limits;
        let ramp_s = PEAK_OVER_MEAN * speed_m_s / acceleration_m_s2;
        let ramp = count((ramp_s / epoch_s - ROUNDING).ceil());
        // Both ramps together go as far as one of them would at full speed.
        let ramps_m = speed_m_s * number(ramp) * epoch_s;
        let cruise = count(((length_m - ramps_m) / (speed_m_s * epoch_s) - ROUNDING).ceil());
        Some(Self {
            ramp,
            cruise,
            speed_m_s: length_m / (number(ramp + cruise) * epoch_s),
            direction: way.map(|x| x / length_m),
            epoch_s,
        })
    }

    /// Epochs that it takes.
    #[must_use]
    pub fn epochs(&self) -> usize {
        2 * self.ramp + self.cruise
    }

    /// The knots at the ends of its epochs if it begins at a place.
    #[must_use]
    pub fn knots(&self, from: Point) -> Vec<Knot> {
        let epochs = self.flight(from).into_iter();
        epochs.map(|epoch| epoch.end).collect()
    }

    /// Its epochs from a place.
    pub(crate) fn flight(&self, from: Point) -> Vec<FlightEpoch> {
        let up = (0..self.ramp).map(FlightPhase::Up);
        let cruise = std::iter::repeat_n(FlightPhase::Cruise, self.cruise);
        let down = (0..self.ramp).map(FlightPhase::Down);
        let phases = up.chain(cruise).chain(down);
        flight(from, phases.map(|phase| (*self, phase)))
    }

    /// The way of an epoch along the leg, m, and the speed (m/s) and acceleration (m/s²) at its end.
    fn step(&self, phase: FlightPhase) -> [f64; 3] {
        let v = self.speed_m_s;
        let ramp_s = number(self.ramp) * self.epoch_s;
        let share = |index: usize| number(index) / number(self.ramp);
        // ∫ 3 x² - 2 x³ dx
        let risen = |x: f64| x * x * x - x * x * x * x / 2.0;
        let speed = |x: f64| v * (3.0 * x * x - 2.0 * x * x * x);
        let acceleration = |x: f64| v / ramp_s * 6.0 * x * (1.0 - x);
        let way_m = |index: usize| v * ramp_s * (risen(share(index + 1)) - risen(share(index)));
        match phase {
            FlightPhase::Up(index) => {
                let x = share(index + 1);
                [way_m(index), speed(x), acceleration(x)]
            }
            FlightPhase::Cruise => [v * self.epoch_s, v, 0.0],
            FlightPhase::Down(index) => {
                let left = self.ramp - 1 - index;
                let x = share(left);
                [way_m(left), speed(x), -acceleration(x)]
            }
        }
    }
}

/// The epochs of phases of legs, one after the other from a place.
pub(crate) fn flight(
    from: Point,
    phases: impl Iterator<Item = (UavLeg, FlightPhase)>,
) -> Vec<FlightEpoch> {
    let mut place_m = from;
    let epochs = phases.map(|(leg, phase)| {
        let [way_m, speed, acceleration] = leg.step(phase);
        place_m = moved(place_m, way_m, leg.direction);
        let end = Knot {
            place_m,
            velocity_m_s: leg.direction.map(|x| x * speed),
            acceleration_m_s2: leg.direction.map(|x| x * acceleration),
        };
        FlightEpoch { leg, phase, end }
    });
    epochs.collect()
}
