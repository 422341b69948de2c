//! The path through waypoints as a function of time: checks, duration, points.

use super::curve::{Curve, PEAK_RATE, PEAK_RATE_CHANGE, PathPoint};
use super::error::PathError;
use super::spline::{self, PathPiece, Vector, dot, norm, scale, subtract};

/// Default step of the linear interpolation, m.
///
/// Between long legs, steps h turn a right-angled corner into a bend of radius 0.20 h that leaves
/// the legs by up to 0.085 h (here 0.41 m and 0.17 m), and a turn by 135 degrees into one of radius
/// 0.045 h. Smaller steps follow the legs more closely but slow the whole path, because one time
/// law serves all of it and the tightest bend sets its duration. Legs shorter than 1.5 steps are
/// not divided: closely spaced waypoints give the plain spline through them, without the corners of
/// a polyline.
pub const DEFAULT_STEP_M: f64 = 2.0;

/// Shorter legs are coincident waypoints.
const MIN_LEG_M: f64 = 1e-6;

/// Beyond it f64 no longer resolves the 1e-10 m to which arc lengths are known.
const MAX_COORDINATE_M: f64 = 1e6;

/// Range of limits and step: wide enough for any vehicle, narrow enough that nothing overflows.
const RANGE: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// Cosine of the sharpest turn between two legs, 175 degrees. At a reversal the curve has a cusp.
const MIN_TURN_COSINE: f64 = -0.996_194_698_091_745_5;

/// Pieces of all legs together: some 30 MB.
const MAX_PIECES: u32 = 100_000;

/// Largest ratio of the duration to that of a straight path of the same length.
const MAX_SLOWDOWN: f64 = 20.0;

/// Relative lengthening of the duration, so that the limits hold in floating point too.
const ROUNDING_MARGIN: f64 = 1e-9;

/// A smooth path through waypoints with a rest-to-rest time law. SI units.
///
/// Position, velocity and acceleration are continuous, the latter two are the exact derivatives of
/// the first.
#[derive(Clone, Debug, PartialEq)]
pub struct WaypointPath {
    curve: Curve,
    duration_s: f64,
    start_m: Vector,
    end_m: Vector,
}

/// Largest speed and largest total (tangential and centripetal) acceleration on a path, each from
/// 1e-6 to 1e6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLimits {
    /// Largest speed, m/s.
    pub max_speed_m_s: f64,
    /// Largest norm of the acceleration vector, m/s².
    pub max_acceleration_m_s2: f64,
}

impl WaypointPath {
    /// Path through `points_m` (m) in their order, at rest in the first and in the last, as fast as
    /// `limits` allow, with [`DEFAULT_STEP_M`].
    ///
    /// # Errors
    /// See [`PathError`].
    pub fn new(points_m: &[[f64; 3]], limits: PathLimits) -> Result<Self, PathError> {
        Self::with_step(points_m, DEFAULT_STEP_M, limits)
    }

    /// As [`WaypointPath::new`], with the step of the linear interpolation (m, from 1e-6 to 1e6):
    /// every leg is divided evenly, into steps as near to it as possible but at most 1000.
    ///
    /// # Errors
    /// See [`PathError`].
    pub fn with_step(
        points_m: &[[f64; 3]],
        step_m: f64,
        limits: PathLimits,
    ) -> Result<Self, PathError> {
        let step = checked("step_m", step_m)?;
        let speed = checked("max_speed_m_s", limits.max_speed_m_s)?;
        let acceleration = checked("max_acceleration_m_s2", limits.max_acceleration_m_s2)?;
        let [start_m, .., end_m] = *points_m else {
            return Err(PathError::TooFewPoints {
                count: points_m.len(),
            });
        };
        let legs = checked_legs(points_m)?;

        let pieces: f64 = legs.iter().map(|leg| spline::steps(leg, step)).sum();
        if pieces > f64::from(MAX_PIECES) {
            return Err(PathError::TooLong {
                pieces,
                limit: MAX_PIECES,
            });
        }
        let curve = Curve::new(spline::through(&legs, step));
        let length = curve.length();
        let peak = curve.peak_acceleration();
        let duration = |peak_size: f64| {
            f64::max(
                PEAK_RATE * length / speed,
                (peak_size / acceleration).sqrt(),
            )
        };
        if duration(peak.size) > MAX_SLOWDOWN * duration(PEAK_RATE_CHANGE * length) {
            let index = nearest(points_m, curve.at_phase(peak.phase).position);
            return Err(PathError::TooSharp { index });
        }
        let duration_s = duration(peak.size) * (1.0 + ROUNDING_MARGIN);
        Ok(Self {
            curve,
            duration_s,
            start_m,
            end_m,
        })
    }

    /// Time at which the end is reached, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Arc length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.curve.length()
    }

    /// Reference at time `t_s` (s): at rest in the first waypoint before 0 and in the last one from
    /// the duration on.
    #[must_use]
    pub fn at(&self, t_s: f64) -> PathPoint {
        let held = |position| PathPoint {
            position,
            velocity: [0.0; 3],
            acceleration: [0.0; 3],
        };
        if t_s <= 0.0 {
            return held(self.start_m);
        }
        if t_s >= self.duration_s {
            return held(self.end_m);
        }
        let rate = 1.0 / self.duration_s;
        let PathPoint {
            position,
            velocity,
            acceleration,
        } = self.curve.at_phase(t_s * rate);
        let (velocity, acceleration) = (scale(rate, velocity), scale(rate * rate, acceleration));
        PathPoint {
            position,
            velocity,
            acceleration,
        }
    }
}

fn checked(name: &'static str, value: f64) -> Result<f64, PathError> {
    if RANGE.contains(&value) {
        Ok(value)
    } else {
        Err(PathError::OutOfRange { name, value })
    }
}

fn checked_legs(points: &[Vector]) -> Result<Vec<PathPiece>, PathError> {
    for (index, &point) in points.iter().enumerate() {
        if !point.iter().all(|x| x.abs() <= MAX_COORDINATE_M) {
            return Err(PathError::Coordinate { index, point });
        }
    }
    let mut legs: Vec<PathPiece> = Vec::with_capacity(points.len());
    for (index, pair) in points.windows(2).enumerate() {
        let chord = subtract(pair[1], pair[0]);
        let length = norm(chord);
        if length < MIN_LEG_M {
            return Err(PathError::Coincident { index: index + 1 });
        }
        let direction = scale(1.0 / length, chord);
        if legs
            .last()
            .is_some_and(|leg| dot(leg.direction, direction) < MIN_TURN_COSINE)
        {
            return Err(PathError::TooSharp { index });
        }
        legs.push(PathPiece {
            start: pair[0],
            direction,
            length,
        });
    }
    Ok(legs)
}

fn nearest(points: &[Vector], target: Vector) -> usize {
    let distances = points.iter().map(|&point| norm(subtract(point, target)));
    distances
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |(index, _)| index)
}
