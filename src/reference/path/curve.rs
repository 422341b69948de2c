//! Spline by arc length, under the quintic time law.

use std::array::from_fn;

use super::spline::{Piece, Vector, dot, norm, scale};

/// Peaks of |b'| and |b''| of the quintic law b, at τ = 1/2 and at τ = 1/2 ± √3/6 (10/√3).
pub(super) const PEAK_RATE: f64 = 1.875;
pub(super) const PEAK_RATE_CHANGE: f64 = 5.773_502_691_896_258;

/// Relative tolerance of the length of an arc; the rounding of the sum is a hundred times smaller.
const QUADRATURE_TOLERANCE: f64 = 1e-13;

/// Bound on the halvings of a piece, reached only by a cusp.
const MAX_HALVINGS: u32 = 40;

/// Positive nodes of the eight-point Gauss-Legendre rule on [-1, 1] and their weights.
const GAUSS_LEGENDRE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Spline with its arc length s(x) = ∫ |dr/dx| dx.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pieces: Vec<Piece>,
    arcs: Vec<Arc>,
    length: f64,
}

/// Part of a piece whose length one quadrature gives to [`QUADRATURE_TOLERANCE`].
#[derive(Clone, Debug, PartialEq)]
struct Arc {
    piece: usize,
    from: f64,
    to: f64,
    /// Arc length of the curve before this arc, m.
    start: f64,
}

/// Position at one instant with its first two time derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Acceleration, m/s².
    pub acceleration: [f64; 3],
}

/// A largest acceleration and where it occurs.
#[derive(Clone, Copy)]
pub(super) struct Peak {
    pub(super) phase: f64,
    pub(super) size: f64,
}

impl Curve {
    pub(super) fn new(pieces: Vec<Piece>) -> Self {
        let mut curve = Self {
            pieces: Vec::new(),
            arcs: Vec::new(),
            length: 0.0,
        };
        for (index, piece) in pieces.iter().enumerate() {
            curve.push_arcs(index, piece, [0.0, piece.length], MAX_HALVINGS);
        }
        Self { pieces, ..curve }
    }

    /// Arc length, m.
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Position and its first two derivatives in the phase τ = t / T, from 0 to 1.
    pub(super) fn at_phase(&self, phase: f64) -> PathPoint {
        let [s, rate, rate_change] = quintic(phase).map(|b| self.length * b);
        let (piece, x) = self.locate(s);
        let first = piece.first_derivative(x);
        let second = piece.second_derivative(x);
        let inverse_speed = 1.0 / norm(first);
        let tangent = scale(inverse_speed, first);
        // d²r/ds²: the part of d²r/dx² across the tangent, over (ds/dx)².
        let along = dot(second, tangent);
        let across: Vector = from_fn(|i| second[i] - along * tangent[i]);
        let curvature = scale(inverse_speed * inverse_speed, across);
        PathPoint {
            position: piece.position(x),
            velocity: scale(rate, tangent),
            acceleration: from_fn(|i| rate_change * tangent[i] + rate * rate * curvature[i]),
        }
    }

    /// Largest |d²r/dτ²|, m.
    ///
    /// It is smooth in every arc, for the kinks of the curvature are ends of pieces. Samples find
    /// its local maxima, golden sections on both sides of each the exact peak.
    pub(super) fn peak_acceleration(&self) -> Peak {
        const SAMPLES_PER_ARC: u32 = 16;
        let sample = |phase: f64| Peak {
            phase,
            size: norm(self.at_phase(phase).acceleration),
        };
        let starts = self
            .arcs
            .iter()
            .map(|arc| phase_of(arc.start / self.length));
        let mut ends = starts.clone().skip(1).chain([1.0]);
        let mut samples = Vec::new();
        for from in starts {
            let width = ends.next().map_or(0.0, |to| to - from) / f64::from(SAMPLES_PER_ARC);
            samples.extend((0..SAMPLES_PER_ARC).map(|k| sample(from + f64::from(k) * width)));
        }
        samples.push(sample(1.0));

        let is_maximum = |w: &&[Peak]| w[1].size >= w[0].size.max(w[2].size);
        let refine = |w: &[Peak]| [[w[0], w[1]], [w[1], w[2]]].map(|[a, b]| golden(sample, a, b));
        let refined = samples.windows(3).filter(is_maximum).flat_map(refine);
        refined.fold(samples[0], higher)
    }

    fn push_arcs(&mut self, index: usize, piece: &Piece, [from, to]: [f64; 2], halvings: u32) {
        let middle = 0.5 * (from + to);
        let whole = arc_length(piece, from, to);
        let halves = arc_length(piece, from, middle) + arc_length(piece, middle, to);
        if (whole - halves).abs() <= QUADRATURE_TOLERANCE * whole || halvings == 0 {
            self.arcs.push(Arc {
                piece: index,
                from,
                to,
                start: self.length,
            });
            self.length += whole;
        } else {
            self.push_arcs(index, piece, [from, middle], halvings - 1);
            self.push_arcs(index, piece, [middle, to], halvings - 1);
        }
    }

    /// Piece at arc length `s` and the x within it.
    fn locate(&self, s: f64) -> (&Piece, f64) {
        let next = self.arcs.partition_point(|arc| arc.start <= s).max(1);
        let arc = &self.arcs[next - 1];
        let end = self.arcs.get(next).map_or(self.length, |arc| arc.start);
        let piece = &self.pieces[arc.piece];
        let target = s - arc.start;
        // Newton's method in a shrinking bracket, with bisection where a step would leave it.
        let [mut low, mut high] = [arc.from, arc.to];
        let mut x = low + (high - low) * (target / (end - arc.start)).clamp(0.0, 1.0);
        for _ in 0..MAX_HALVINGS {
            let excess = arc_length(piece, arc.from, x) - target;
            let bound = if excess > 0.0 { &mut high } else { &mut low };
            *bound = x;
            let newton = x - excess / norm(piece.first_derivative(x));
            let inside = low <= newton && newton <= high;
            let step = if inside { newton } else { 0.5 * (low + high) } - x;
            x += step;
            // The error after a step is of the order of its square: below rounding.
            if step.abs() <= 1e-9 * (arc.to - arc.from) {
                break;
            }
        }
        (piece, x)
    }
}

fn arc_length(piece: &Piece, from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let speed = |x: f64| norm(piece.first_derivative(x));
    let terms = GAUSS_LEGENDRE
        .map(|(node, weight)| weight * (speed(middle - half * node) + speed(middle + half * node)));
    half * terms.iter().sum::<f64>()
}

/// Rest-to-rest law b(τ), from 0 to 1, and its first two derivatives.
fn quintic(phase: f64) -> [f64; 3] {
    let (p, q) = (phase, 1.0 - phase);
    [
        p * p * p * (10.0 - 15.0 * p + 6.0 * p * p),
        30.0 * p * p * q * q,
        60.0 * p * q * (q - p),
    ]
}

/// Phase at which the quintic law reaches `fraction`, by bisection to rounding.
fn phase_of(fraction: f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        let bound = if quintic(middle)[0] <= fraction {
            &mut low
        } else {
            &mut high
        };
        *bound = middle;
    }
    low
}

/// Maximum of a unimodal `sample` between two of its values, by golden-section search.
fn golden(sample: impl Fn(f64) -> Peak, mut low: Peak, mut high: Peak) -> Peak {
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let between = |a: Peak, b: Peak| sample(a.phase + SECTION * (b.phase - a.phase));
    let ends = higher(low, high);
    let [mut left, mut right] = [between(high, low), between(low, high)];
    // 0.618³⁰ = 5e-7 of the interval; a maximum is flat, so that its size is exact to rounding.
    for _ in 0..30 {
        if left.size > right.size {
            (high, right) = (right, left);
            left = between(high, low);
        } else {
            (low, left) = (left, right);
            right = between(low, high);
        }
    }
    higher(ends, higher(left, right))
}

fn higher(a: Peak, b: Peak) -> Peak {
    if b.size > a.size { b } else { a }
}
