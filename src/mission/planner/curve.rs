//! The points of a way (sigma_n) and the curve through them (sigma'_n).

use crate::mission::plane::{Point, between, count, distance, dot, length, minus, norm, number};
use crate::mission::planner::segment::Space;
use crate::reference::walk::Spline;

/// Distance of the curve's samples, m: the chord of an arc of radius 0.5 m is off it by 0.6 mm.
const SAMPLE_M: f64 = 0.05;
/// Cosine of 150 degrees: where points turn more, a spline through them loops.
const SHARPEST_TURN: f64 = -0.866_025_403_784_438_6;
/// How often the spacing of the points is halved before the way keeps its corners.
const HALVINGS: u32 = 3;

/// A line through samples, by arc length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    samples_m: Vec<Point>,
    arcs_m: Vec<f64>,
}

/// A way to walk.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// The points (sigma_n), m.
    pub points_m: Vec<Point>,
    /// The curve (sigma'_n).
    pub curve: Curve,
    /// Arc length of the curve at each of the points, m.
    pub arcs_m: Vec<f64>,
    /// Indices of the points between the ends at which the robot must rest, because the curve turns on the spot.
    pub rests: Vec<usize>,
}

impl Curve {
    /// The line through points.
    #[must_use]
    pub fn through(samples_m: Vec<Point>) -> Self {
        let mut arcs_m = Vec::with_capacity(samples_m.len());
        let mut arc_m = 0.0;
        for (index, &sample) in samples_m.iter().enumerate() {
            let before = index
                .checked_sub(1)
                .map_or(sample, |index| samples_m[index]);
            arc_m += distance(before, sample);
            arcs_m.push(arc_m);
        }
        Self { samples_m, arcs_m }
    }

    /// Its length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.arcs_m.last().copied().unwrap_or(0.0)
    }

    /// The samples, m.
    #[must_use]
    pub fn samples_m(&self) -> &[Point] {
        &self.samples_m
    }

    /// Place (m) and direction at an arc length; those of the ends beyond them.
    #[must_use]
    pub fn at(&self, arc_m: f64) -> (Point, [f64; 2]) {
        let right = self.arcs_m.partition_point(|&arc| arc <= arc_m);
        let right = right.min(self.arcs_m.len().saturating_sub(1)).max(1);
        match (
            self.samples_m.get(right - 1..=right),
            self.arcs_m.get(right - 1..=right),
        ) {
            (Some(&[a, b]), Some(&[from, to])) if to > from => {
                let share = ((arc_m - from) / (to - from)).clamp(0.0, 1.0);
                let direction = minus(b, a).map(|x| x / (to - from));
                (between(a, b, share), direction)
            }
            _ => (
                self.samples_m.last().copied().unwrap_or_default(),
                [1.0, 0.0],
            ),
        }
    }
}

impl Way {
    /// The way along a polyline: its points at most `spacing_m` apart, the curve a spline that keeps clear in `space`.
    ///
    /// Where the spline does not keep clear, or the points turn by more than 150 degrees, the spacing is halved, up to
    /// three times; after that the robot walks along the polyline itself and rests at its vertices.
    #[must_use]
    pub fn along(polyline: &[Point], spacing_m: f64, space: &Space<'_>) -> Self {
        let mut closer_m = spacing_m;
        for _ in 0..=HALVINGS {
            let points_m = points_along(polyline, closer_m);
            if !turns_sharply(&points_m) {
                let curve = smooth(&points_m);
                let clear = |&sample: &Point| space.excess_m(sample) >= 0.0;
                if curve.samples_m.iter().all(clear) {
                    return Self::on(points_m, curve, Vec::new());
                }
            }
            closer_m *= 0.5;
        }
        let points_m = points_along(polyline, spacing_m);
        let vertices = &polyline[1..polyline.len().saturating_sub(1).max(1)];
        let is_vertex = |point: &Point| vertices.contains(point);
        let rests = (1..points_m.len()).filter(|&index| is_vertex(&points_m[index]));
        let rests = rests.collect();
        Self::on(points_m.clone(), Curve::through(points_m), rests)
    }

    fn on(points_m: Vec<Point>, curve: Curve, rests: Vec<usize>) -> Self {
        // The curve is longer than the polyline through its points by a share that is the same everywhere, nearly.
        let longer = curve.length_m() / length(&points_m).max(f64::MIN_POSITIVE);
        let arcs_m = Curve::through(points_m.clone()).arcs_m;
        Self {
            arcs_m: arcs_m.into_iter().map(|arc_m| arc_m * longer).collect(),
            points_m,
            curve,
            rests,
        }
    }
}

/// The points of a polyline with every leg divided evenly into the fewest parts of at most `spacing_m`.
#[must_use]
pub fn points_along(polyline: &[Point], spacing_m: f64) -> Vec<Point> {
    let first = polyline.first().copied();
    let legs = polyline.windows(2).flat_map(|leg| {
        let (from, to) = (leg[0], leg[1]);
        // A leg of whole spacings, up to rounding, has no further part.
        let parts = count((distance(from, to) / spacing_m - 1e-9).ceil()).max(1);
        let inner = (1..parts).map(move |k| between(from, to, number(k) / number(parts)));
        // The vertex itself and not its rounding.
        inner.chain([to])
    });
    first.into_iter().chain(legs).collect()
}

fn turns_sharply(points: &[Point]) -> bool {
    points.windows(3).any(|corner| {
        let (before, after) = (minus(corner[1], corner[0]), minus(corner[2], corner[1]));
        dot(before, after) < SHARPEST_TURN * norm(before) * norm(after)
    })
}

/// The cubic spline over chord length through points, clamped along the first and the last leg.
fn smooth(points: &[Point]) -> Curve {
    let chords = Curve::through(points.to_vec()).arcs_m;
    let total_m = chords.last().copied().unwrap_or(0.0);
    let slope = |a: Point, b: Point| minus(b, a).map(|x| x / distance(a, b));
    let ends = [points.first_chunk(), points.last_chunk()];
    let slopes = ends.map(|leg| leg.map_or([0.0; 2], |&[a, b]| slope(a, b)));
    let spline = Spline::clamped(chords.into_iter().zip(points.iter().copied()), slopes);
    let samples = count((total_m / SAMPLE_M).ceil()).max(1);
    let inner = (0..samples).map(|k| spline.value(total_m / number(samples) * number(k)));
    Curve::through(inner.chain(points.last().copied()).collect())
}
