//! The line to walk: waypoints smoothed, with a heading at every point (paper, section III-B).

use super::error::WalkError;
use super::gait::Gait;
use super::samples::{MAX_SAMPLES, count, floor};
use super::spline::Spline;
use std::f64::consts::TAU;

/// Shorter legs are coincident waypoints.
const MIN_LEG_M: f64 = 1e-6;
/// Largest size of a coordinate.
const MAX_COORDINATE_M: f64 = 1e4;
/// Beyond it the spline turns on a point.
const MAX_TURN_DEG: f64 = 150.0;
/// Distance between the samples of the line; the chord of an arc of radius 0.5 m is short by 2e-5
/// of its length.
const SAMPLE_M: f64 = 0.005;

/// A point and a direction in the ground plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// (x, y), m.
    pub position_m: [f64; 2],
    /// Angle of the direction from the x axis, counterclockwise and not wrapped, rad.
    pub heading_rad: f64,
}

/// The smoothed line σ'ₙ with its body directions COₙ, sampled evenly by arc length.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    samples: Vec<Placement>,
    length_m: f64,
}

impl Placement {
    /// The point at (ahead, to the left) of this one, m.
    #[must_use]
    pub fn point(&self, [ahead, left]: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = self.heading_rad.sin_cos();
        let [x, y] = self.position_m;
        [
            x + cosine * ahead - sine * left,
            y + sine * ahead + cosine * left,
        ]
    }

    /// (ahead, to the left) of a point, m: the inverse of [`Placement::point`].
    #[must_use]
    pub fn local(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = self.heading_rad.sin_cos();
        let (dx, dy) = (x - self.position_m[0], y - self.position_m[1]);
        [cosine * dx + sine * dy, cosine * dy - sine * dx]
    }

    /// A placement of the same direction at (ahead, to the left) of this one.
    #[must_use]
    pub fn beside(&self, offset: [f64; 2]) -> Self {
        Self {
            position_m: self.point(offset),
            ..*self
        }
    }
}

impl Course {
    /// The line through `waypoints` (x, y), m.
    ///
    /// Every leg is divided evenly; a cubic spline over the chord length, clamped along the first
    /// and the last leg, passes through the points; its samples by arc length give the heading by
    /// central differences.
    ///
    /// # Errors
    /// What [`WalkError`] says of waypoints.
    pub fn new(waypoints: &[[f64; 2]], gait: &Gait) -> Result<Self, WalkError> {
        gait.check()?;
        let legs = legs(waypoints)?;
        let chord_m: f64 = legs.iter().map(|leg| leg.length).sum();
        let rough = chord_m / SAMPLE_M;
        if rough > f64::from(MAX_SAMPLES) {
            return Err(WalkError::TooLong {
                samples: rough,
                limit: MAX_SAMPLES,
            });
        }
        let curve = curve(&legs, gait.smoothing_step_m);
        let (points, length_m) = even_samples(&curve);
        Ok(Self {
            samples: with_headings(&points),
            length_m,
        })
    }

    /// Arc length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The samples, evenly spaced from the first waypoint to the last.
    #[must_use]
    pub fn samples(&self) -> &[Placement] {
        &self.samples
    }

    /// The placement at arc length `s_m`; the first or the last one outside the line.
    #[must_use]
    pub fn at(&self, s_m: f64) -> Placement {
        let last = self.samples.len().saturating_sub(1);
        let place = (s_m / self.length_m).clamp(0.0, 1.0) * count(last);
        let left = floor(place).min(last.saturating_sub(1));
        let weight = place - count(left);
        match self.samples.get(left..) {
            Some([a, b, ..]) => {
                let mix = |a: f64, b: f64| (1.0 - weight) * a + weight * b;
                Placement {
                    position_m: std::array::from_fn(|i| mix(a.position_m[i], b.position_m[i])),
                    heading_rad: mix(a.heading_rad, b.heading_rad),
                }
            }
            _ => Placement {
                position_m: [0.0; 2],
                heading_rad: 0.0,
            },
        }
    }
}

/// A straight line between two waypoints.
struct CoursePiece {
    start: [f64; 2],
    direction: [f64; 2],
    length: f64,
}

fn legs(waypoints: &[[f64; 2]]) -> Result<Vec<CoursePiece>, WalkError> {
    let count = waypoints.len();
    if count < 2 {
        return Err(WalkError::TooFewWaypoints { count });
    }
    for (index, &point_m) in waypoints.iter().enumerate() {
        if !point_m.iter().all(|x| x.abs() <= MAX_COORDINATE_M) {
            return Err(WalkError::Waypoint { index, point_m });
        }
    }
    let mut legs: Vec<CoursePiece> = Vec::with_capacity(count);
    for (index, pair) in waypoints.windows(2).enumerate() {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let length = dx.hypot(dy);
        if length < MIN_LEG_M {
            return Err(WalkError::Coincident { index: index + 1 });
        }
        let direction = [dx / length, dy / length];
        let turn_deg = legs.last().map_or(0.0, |leg| {
            let [x, y] = leg.direction;
            let (along, across) = (x * dx + y * dy, x * dy - y * dx);
            across.atan2(along).to_degrees().abs()
        });
        if turn_deg > MAX_TURN_DEG {
            return Err(WalkError::Reversal {
                index,
                turn_deg,
                limit_deg: MAX_TURN_DEG,
            });
        }
        legs.push(CoursePiece {
            start: pair[0],
            direction,
            length,
        });
    }
    Ok(legs)
}

fn curve(legs: &[CoursePiece], step: f64) -> Spline<2> {
    let mut points = Vec::new();
    let mut from = 0.0;
    for leg in legs {
        let pieces = (leg.length / step).round().max(1.0);
        let piece = leg.length / pieces;
        points.extend((0..=floor(pieces)).map(|k| {
            let x = count(k) * piece;
            let at = std::array::from_fn(|i| leg.start[i] + x * leg.direction[i]);
            (from + x, at)
        }));
        // The next leg starts with this point.
        points.pop();
        from += leg.length;
    }
    let end =
        |leg: &CoursePiece| std::array::from_fn(|i| leg.start[i] + leg.length * leg.direction[i]);
    points.extend(legs.last().map(|leg| (from, end(leg))));
    let slopes = [legs.first(), legs.last()].map(|leg| leg.map_or([0.0; 2], |leg| leg.direction));
    Spline::clamped(points, slopes)
}

/// Points of the curve at even arc length, and its length.
fn even_samples(curve: &Spline<2>) -> (Vec<[f64; 2]>, f64) {
    let [from, to] = curve.range();
    let pieces = ((to - from) / SAMPLE_M).ceil().max(2.0);
    let parameter = |k: usize| from + (to - from) * (count(k) / pieces);
    // Arc length at every parameter, by chords.
    let mut arcs = vec![(0.0, from)];
    let (mut arc, mut last) = (0.0, curve.value(from));
    for x in (1..=floor(pieces)).map(parameter) {
        let point = curve.value(x);
        arc += (point[0] - last[0]).hypot(point[1] - last[1]);
        arcs.push((arc, x));
        last = point;
    }
    let steps = (arc / SAMPLE_M - 1e-6).ceil().max(2.0);
    let samples = (0..=floor(steps)).map(|k| {
        let target = arc * (count(k) / steps);
        let right = arcs.partition_point(|&(arc, _)| arc < target);
        let right = right.min(arcs.len() - 1).max(1);
        let ((s0, x0), (s1, x1)) = (arcs[right - 1], arcs[right]);
        let weight = if s0 < s1 {
            (target - s0) / (s1 - s0)
        } else {
            0.0
        };
        curve.value(x0 + weight * (x1 - x0))
    });
    (samples.collect(), arc)
}

fn with_headings(points: &[[f64; 2]]) -> Vec<Placement> {
    let mut samples: Vec<Placement> = Vec::with_capacity(points.len());
    for (k, &position_m) in points.iter().enumerate() {
        let a = points[k.saturating_sub(1)];
        let b = points[(k + 1).min(points.len() - 1)];
        let angle = (b[1] - a[1]).atan2(b[0] - a[0]);
        let last = samples.last().map_or(angle, |last| last.heading_rad);
        // The turn from the last sample, to the nearest side: the heading passes ±π unbroken.
        let turn = angle - last;
        samples.push(Placement {
            position_m,
            heading_rad: last + turn - TAU * (turn / TAU).round(),
        });
    }
    samples
}
