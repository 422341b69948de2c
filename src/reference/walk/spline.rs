//! Clamped cubic spline of several channels: the line to walk, a swing, the pelvis, the joints.

use crate::reference::point::ReferencePoint;
use std::array::from_fn;

/// Cubic spline through values at increasing knots, with continuous first and second derivatives.
///
/// It is held by its second derivatives at the knots (de Boor, A Practical Guide to Splines,
/// ch. IV).
#[derive(Clone, Debug, PartialEq)]
pub struct Spline<const N: usize> {
    knots: Vec<Knot<N>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot<const N: usize> {
    at: f64,
    value: [f64; N],
    second: [f64; N],
}

impl<const N: usize> Spline<N> {
    /// Spline through points (knot, value), at rest at both ends.
    ///
    /// A point whose knot is not above the one before it, or not a number, is left out.
    #[must_use]
    pub fn at_rest(points: impl IntoIterator<Item = (f64, [f64; N])>) -> Self {
        Self::clamped(points, [[0.0; N]; 2])
    }

    /// As [`Spline::at_rest`], with the first derivatives `slopes` at the two ends.
    #[must_use]
    pub fn clamped(
        points: impl IntoIterator<Item = (f64, [f64; N])>,
        slopes: [[f64; N]; 2],
    ) -> Self {
        let mut knots: Vec<Knot<N>> = Vec::new();
        for (at, value) in points {
            if at.is_finite() && knots.last().is_none_or(|last| last.at < at) {
                let second = [0.0; N];
                knots.push(Knot { at, value, second });
            }
        }
        let second = second_derivatives(&knots, slopes);
        for (knot, second) in knots.iter_mut().zip(second) {
            knot.second = second;
        }
        Self { knots }
    }

    /// The first and the last knot.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let ends = [self.knots.first(), self.knots.last()];
        ends.map(|knot| knot.map_or(0.0, |knot| knot.at))
    }

    /// Value and first two derivatives at `x`. Before the first and after the last knot: the value
    /// there, at rest.
    #[must_use]
    pub fn at(&self, x: f64) -> [ReferencePoint; N] {
        let above = self.knots.partition_point(|knot| knot.at <= x);
        let right = above.min(self.knots.len().saturating_sub(1)).max(1);
        match self.knots.get(right - 1..=right) {
            Some([a, b]) if a.at <= x && x <= b.at => between(a, b, x),
            _ if above == 0 => held(self.knots.first()),
            _ => held(self.knots.last()),
        }
    }

    /// The value alone, see [`Spline::at`].
    #[must_use]
    pub fn value(&self, x: f64) -> [f64; N] {
        self.at(x).map(|point| point.value)
    }
}

fn held<const N: usize>(knot: Option<&Knot<N>>) -> [ReferencePoint; N] {
    from_fn(|i| ReferencePoint {
        value: knot.map_or(0.0, |knot| knot.value[i]),
        ..ReferencePoint::default()
    })
}

/// The cubic between two knots: the chord, plus what the second derivatives add to it.
fn between<const N: usize>(a: &Knot<N>, b: &Knot<N>, x: f64) -> [ReferencePoint; N] {
    let h = b.at - a.at;
    let (v, w) = ((b.at - x) / h, (x - a.at) / h);
    from_fn(|i| {
        let (ma, mb) = (a.second[i], b.second[i]);
        let bend = (v * v * v - v) * ma + (w * w * w - w) * mb;
        let turn = (1.0 - 3.0 * v * v) * ma + (3.0 * w * w - 1.0) * mb;
        ReferencePoint {
            value: v * a.value[i] + w * b.value[i] + h * h / 6.0 * bend,
            rate: (b.value[i] - a.value[i]) / h + h / 6.0 * turn,
            acceleration: v * ma + w * mb,
        }
    })
}

/// Second derivatives M at the knots: with distances h and chord slopes d before (-) and after (+)
/// a knot, h₋ M₋ + 2 (h₋ + h₊) M + h₊ M₊ = 6 (d₊ - d₋). At an end the missing distance is zero and
/// the missing slope is the one given.
fn second_derivatives<const N: usize>(knots: &[Knot<N>], slopes: [[f64; N]; 2]) -> Vec<[f64; N]> {
    let chord = |from: usize| -> Option<(f64, [f64; N])> {
        let (a, b) = (knots.get(from)?, knots.get(from + 1)?);
        let h = b.at - a.at;
        Some((h, from_fn(|i| (b.value[i] - a.value[i]) / h)))
    };
    // Thomas algorithm; the system is diagonally dominant. First M = offset - ratio M₊ ...
    let mut rows: Vec<(f64, [f64; N])> = Vec::with_capacity(knots.len());
    for k in 0..knots.len() {
        let before = k.checked_sub(1).and_then(chord);
        let (h0, d0) = before.unwrap_or((0.0, slopes[0]));
        let (h1, d1) = chord(k).unwrap_or((0.0, slopes[1]));
        let (ratio, offset) = rows.last().copied().unwrap_or((0.0, [0.0; N]));
        let pivot = 2.0 * (h0 + h1) - h0 * ratio;
        let row = from_fn(|i| (6.0 * (d1[i] - d0[i]) - h0 * offset[i]) / pivot);
        rows.push((h1 / pivot, row));
    }
    // ... then M from the last knot to the first.
    let mut second = [0.0; N];
    for (ratio, offset) in rows.iter_mut().rev() {
        second = from_fn(|i| offset[i] - *ratio * second[i]);
        *offset = second;
    }
    rows.into_iter().map(|(_, second)| second).collect()
}
