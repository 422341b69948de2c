//! Cubic spline through a polyline whose legs are divided evenly.
//!
//! The parameter x is the cumulative chord length (de Boor, A Practical Guide to Splines, ch. IV).
//! The spline is clamped along the first and the last leg: the vehicle leaves and arrives in the
//! direction that the waypoints give, so that a vertical take-off stays vertical.

use std::array::from_fn;

pub(super) type Vector = [f64; 3];

/// Bound on memory: a leg of more steps gets longer ones, and wider bends.
const MAX_STEPS_PER_LEG: u32 = 1000;

/// Added to a number of steps before rounding, so that legs of 2.5 or 3.5 steps are divided alike
/// wherever the path lies: agents with offset paths then fly the same shape.
const ROUNDING_BIAS: f64 = 1e-6;

/// Straight line between two waypoints, with its unit direction.
pub(super) struct PathPiece {
    pub(super) start: Vector,
    pub(super) direction: Vector,
    pub(super) length: f64,
}

/// One cubic, over the distance x in [0, length] along the chord between two points.
///
/// It is the chord plus what the second derivatives at both ends add to it: where these vanish, the
/// piece is exactly straight.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    start: Vector,
    direction: Vector,
    pub(super) length: f64,
    second: [Vector; 2],
}

impl Piece {
    pub(super) fn position(&self, x: f64) -> Vector {
        let (a, b) = self.barycentric(x);
        let weight = self.length * self.length / 6.0;
        let (wa, wb) = (weight * (a * a * a - a), weight * (b * b * b - b));
        let [ma, mb] = &self.second;
        from_fn(|i| self.start[i] + x * self.direction[i] + wa * ma[i] + wb * mb[i])
    }

    /// dr/dx, of size near one.
    pub(super) fn first_derivative(&self, x: f64) -> Vector {
        let (a, b) = self.barycentric(x);
        let weight = self.length / 6.0;
        let (wa, wb) = (weight * (1.0 - 3.0 * a * a), weight * (3.0 * b * b - 1.0));
        let [ma, mb] = &self.second;
        from_fn(|i| self.direction[i] + wa * ma[i] + wb * mb[i])
    }

    /// d²r/dx², 1/m.
    pub(super) fn second_derivative(&self, x: f64) -> Vector {
        let (a, b) = self.barycentric(x);
        let [ma, mb] = &self.second;
        from_fn(|i| a * ma[i] + b * mb[i])
    }

    fn barycentric(&self, x: f64) -> (f64, f64) {
        let b = x / self.length;
        (1.0 - b, b)
    }
}

/// Spline through the legs, each divided into equal steps as near to `step` as possible.
///
/// Its second derivatives M solve, at every point with steps h and directions d before (-) and
/// after (+) it, h₋ M₋ + 2 (h₋ + h₊) M + h₊ M₊ = 6 (d₊ - d₋). At the two ends the missing step
/// has length zero and the missing direction is the chord's.
pub(super) fn through(legs: &[PathPiece], step: f64) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = legs.iter().flat_map(|leg| divide(leg, step)).collect();

    // Thomas algorithm; the system is diagonally dominant. First M = offset - ratio M₊ ...
    let mut rows: Vec<(f64, Vector)> = Vec::with_capacity(pieces.len() + 1);
    for k in 0..=pieces.len() {
        let before = k.checked_sub(1).and_then(|k| pieces.get(k));
        let after = pieces.get(k);
        let length = |piece: Option<&Piece>| piece.map_or(0.0, |piece| piece.length);
        let (h0, h1) = (length(before), length(after));
        let turn = match (before, after) {
            (Some(before), Some(after)) => subtract(after.direction, before.direction),
            _ => [0.0; 3],
        };
        let (ratio, offset) = rows.last().copied().unwrap_or_default();
        let pivot = 2.0 * (h0 + h1) - h0 * ratio;
        rows.push((
            h1 / pivot,
            from_fn(|i| (6.0 * turn[i] - h0 * offset[i]) / pivot),
        ));
    }
    // ... then M from the last point to the first.
    let mut second = [0.0; 3];
    for (k, (ratio, offset)) in rows.into_iter().enumerate().rev() {
        second = from_fn(|i| offset[i] - ratio * second[i]);
        if let Some(after) = pieces.get_mut(k) {
            after.second[0] = second;
        }
        if let Some(before) = k.checked_sub(1).and_then(|k| pieces.get_mut(k)) {
            before.second[1] = second;
        }
    }
    pieces
}

/// How many pieces a leg is divided into.
pub(super) fn steps(leg: &PathPiece, step: f64) -> f64 {
    let steps = leg.length / step + ROUNDING_BIAS;
    steps.round().clamp(1.0, f64::from(MAX_STEPS_PER_LEG))
}

/// Straight pieces of equal length, as near to `step` as possible.
fn divide(leg: &PathPiece, step: f64) -> impl Iterator<Item = Piece> {
    let steps = steps(leg, step);
    let length = leg.length / steps;
    let count = (0..MAX_STEPS_PER_LEG)
        .map(f64::from)
        .take_while(move |&k| k < steps);
    count.map(move |k| Piece {
        start: from_fn(|i| leg.start[i] + k * length * leg.direction[i]),
        direction: leg.direction,
        length,
        second: [[0.0; 3]; 2],
    })
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn scale(factor: f64, a: Vector) -> Vector {
    a.map(|x| factor * x)
}

pub(super) fn subtract(a: Vector, b: Vector) -> Vector {
    from_fn(|i| a[i] - b[i])
}
