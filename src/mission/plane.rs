//! Points, rectangles and discs of the plane.
//!
//! Distances are square roots of sums of squares: the rounding of `hypot` differs between standard libraries, and
//! decisions must not.

/// (x, y), m.
pub type Point = [f64; 2];

/// A disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its centre, m.
    pub centre_m: Point,
    /// Its radius, m.
    pub radius_m: f64,
}

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The corner of the smallest x and y, m.
    pub lower_m: Point,
    /// The corner of the largest x and y, m.
    pub upper_m: Point,
}

impl Rectangle {
    /// Its extent along x and y, m.
    #[must_use]
    pub fn size_m(&self) -> Point {
        minus(self.upper_m, self.lower_m)
    }

    /// Whether a point lies in it or on its border.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        let inside = |i: usize| self.lower_m[i] <= point[i] && point[i] <= self.upper_m[i];
        inside(0) && inside(1)
    }

    /// The point at a share of both extents.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> Point {
        let size = self.size_m();
        [self.lower_m[0] + x * size[0], self.lower_m[1] + y * size[1]]
    }

    /// The `index`-th of `count` equal parts along x.
    #[must_use]
    pub fn part(&self, index: usize, count: usize) -> Self {
        let width = self.size_m()[0] / number(count);
        let x = |index: usize| self.lower_m[0] + width * number(index);
        Self {
            lower_m: [x(index), self.lower_m[1]],
            upper_m: [x(index + 1), self.upper_m[1]],
        }
    }
}

/// a - b.
pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// a + factor b.
pub(crate) fn moved(a: Point, factor: f64, b: Point) -> Point {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

/// The point at a share of the way from `a` to `b`.
pub(crate) fn between(a: Point, b: Point, share: f64) -> Point {
    moved(a, share, minus(b, a))
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Distance of two points, m.
#[must_use]
pub fn distance(a: Point, b: Point) -> f64 {
    norm(minus(a, b))
}

/// Length of a line through points, m.
#[must_use]
pub fn length(points: &[Point]) -> f64 {
    let legs = points.windows(2).map(|leg| distance(leg[0], leg[1]));
    legs.sum()
}

/// A count as a real number.
#[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
pub(crate) fn number(count: usize) -> f64 {
    count as f64
}

/// A real number as a count: rounded towards zero, zero if it is negative or not a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates, and callers bound what they count"
)]
pub(crate) fn count(number: f64) -> usize {
    number as usize
}
