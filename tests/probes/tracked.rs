//! A lane that knows how far a shader may be off: the value of the lane type f32, and beside it a bound on the distance
//! to what any implementation of WGSL may compute from the same inputs (running error analysis; Higham, Accuracy and
//! Stability of Numerical Algorithms, section 3.3).
//!
//! The model is generic over lanes, so every twin runs on this one, and no tolerance is set by hand. What is assumed of
//! WGSL, section 15.7.4 "Floating point accuracy", is: sums, products and `fma` correctly rounded, which may be up or
//! down, the latter fused or not; quotients within 2.5 ulp; square roots within the 4.5 ulp of 1 / inverseSqrt; small
//! numbers flushed to zero.
//!
//! Operations are calls and not copies: every twin of every shape is compiled for this lane.

use crate::model::lanes::{Kernel, Lane, math};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A single, and how far the shader's may be from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracked {
    pub(super) value: f32,
    pub(super) error: f64,
}

/// Half an ulp here and one there, in ulp; the rest is for what differs in the second order.
const ROUNDED: f64 = 2.0;
/// The same for a quotient.
const DIVIDED: f64 = 3.5;
/// The same for a square root.
const ROOTED: f64 = 5.5;
/// Error of sine and cosine, ulp of one: their polynomials are sums of a few terms below two.
const SINE: f64 = 6.0;
/// Error of the hyperbolic tangent, ulp of one: two polynomials and a quotient.
const TANH: f64 = 12.0;
/// Error of reducing an angle by multiples of pi, ulp of the angle. A compiler that reassociates adds up the two parts
/// of pi and loses the second, as a software Vulkan was seen to do: a quarter of an ulp.
const REDUCED: f64 = 2.0;

/// Where the error of a stored single is: in bits of the double that no single has, and too low to round it to another.
/// What is stored is read again, as by a ring of samples.
const LOW_BITS: u64 = (1 << 28) - 1;
/// What tells these bits from those of a double that was never a single.
const MARK: u64 = 0xa5c3;

/// An error of some ulp of a value.
fn ulps(count: f64, value: f32) -> f64 {
    count * f64::from(f32::EPSILON) * f64::from(value.abs()) + f64::from(f32::MIN_POSITIVE)
}

fn size(value: f32) -> f64 {
    f64::from(value.abs())
}

/// A product of which nothing is left where one factor is nothing, however large the other: an error may be unbounded.
fn times(one: f64, other: f64) -> f64 {
    if one == 0.0 || other == 0.0 {
        return 0.0;
    }
    one * other
}

impl Tracked {
    /// A value that both sides know exactly.
    pub(super) const fn exact(value: f32) -> Self {
        Self { value, error: 0.0 }
    }

    fn new(value: f32, error: f64) -> Self {
        // What is not finite is so for all, or the probe's inputs are badly chosen.
        let error = if value.is_finite() { error } else { 0.0 };
        Self { value, error }
    }

    /// Whether it is known which of two values is the larger.
    fn apart(self, other: Self) -> bool {
        let distance = f64::from(self.value) - f64::from(other.value);
        let error = self.error + other.error;
        error == 0.0 || distance.abs() > error
    }

    /// One of two values, which may turn out to be the other one if `doubtful`.
    fn either(taken: Self, other: Self, doubtful: bool) -> Self {
        if !doubtful {
            return taken;
        }
        let distance = (f64::from(taken.value) - f64::from(other.value)).abs();
        Self {
            value: taken.value,
            error: taken.error.max(distance + other.error),
        }
    }
}

impl Add for Tracked {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let sum = self.value + other.value;
        Self::new(sum, self.error + other.error + ulps(ROUNDED, sum))
    }
}

impl Sub for Tracked {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Tracked {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }
}

impl Mul for Tracked {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let product = self.value * other.value;
        let error = times(size(self.value), other.error)
            + times(size(other.value), self.error)
            + times(self.error, other.error);
        Self::new(product, error + ulps(ROUNDED, product))
    }
}

impl Div for Tracked {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let least = (size(other.value) - other.error).max(0.0);
        let error = (self.error + size(quotient) * other.error) / least;
        Self::new(quotient, error + ulps(DIVIDED, quotient))
    }
}

impl Lane for Tracked {
    type Real = f32;
    type Turns = u32;
    const WIDTH: usize = 1;

    fn splat(value: f32) -> Self {
        Self::exact(value)
    }
    fn load(values: &[f64]) -> Self {
        let low = values[0].to_bits() & LOW_BITS;
        let error = if low >> 12 == MARK {
            f64::from(f32::from_bits((low as u32 & 0xfff) << 19))
        } else {
            0.0
        };
        Self::new(f32::load(values), error)
    }
    fn store(self, out: &mut [f64]) {
        self.value.store(out);
        if self.error > 0.0 {
            // Rounded up: sign, exponent and four bits of a single are in its first 13.
            let error = ((self.error as f32).to_bits() >> 19) + 1;
            let bits = out[0].to_bits() | (MARK << 12) | u64::from(error.min(0xff0));
            out[0] = f64::from_bits(bits);
        }
    }
    #[inline(never)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    fn abs(self) -> Self {
        Self {
            value: self.value.abs(),
            ..self
        }
    }
    #[inline(never)]
    fn max(self, other: Self) -> Self {
        let (taken, left) = if self.value > other.value {
            (self, other)
        } else {
            (other, self)
        };
        Self::either(taken, left, !self.apart(other) && !self.value.is_nan())
    }
    #[inline(never)]
    fn min(self, other: Self) -> Self {
        let (taken, left) = if self.value < other.value {
            (self, other)
        } else {
            (other, self)
        };
        Self::either(taken, left, !self.apart(other) && !self.value.is_nan())
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let error = (self.error / f64::from(root)).min(self.error.sqrt());
        Self::new(root, error + ulps(ROOTED, root))
    }
    #[inline(never)]
    fn floor(self) -> Self {
        let value = f64::from(self.value);
        let doubtful = (value - self.error).floor() != (value + self.error).floor();
        let error = if doubtful { 1.0 + self.error } else { 0.0 };
        Self::new(self.value.floor(), error)
    }
    #[inline(never)]
    fn select_le(left: Self, right: Self, yes: Self, no: Self) -> Self {
        let (taken, other) = if left.value <= right.value {
            (yes, no)
        } else {
            (no, yes)
        };
        Self::either(taken, other, !left.apart(right))
    }

    fn turns(values: &[f64]) -> u32 {
        f32::turns(values)
    }
    fn turns_add(phase: u32, step: u32) -> u32 {
        f32::turns_add(phase, step)
    }
    #[inline(never)]
    fn turns_sin(phase: u32) -> Self {
        // A phase is exact; what it becomes as a single is rounded.
        let folded = (phase << 1) as i32 as f32 * math::FOLD_SCALE;
        let sine = math::sin_folded(Self::new(folded, ulps(ROUNDED, folded)));
        Self::new(f32::turns_sin(phase), sine.error)
    }
    fn turns_from_words(words: &[u32]) -> u32 {
        f32::turns_from_words(words)
    }
    fn unit_from_words(words: &[u32]) -> Self {
        // Nothing is rounded here: the grid is of numbers that singles hold.
        Self::exact(f32::unit_from_words(words))
    }

    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = math::sin_cos(self.value);
        // Both have slopes of at most one, wherever the reduction jumps.
        let error = self.error + ulps(SINE, 1.0) + ulps(REDUCED, self.value);
        (Self::new(sine, error), Self::new(cosine, error))
    }
    #[inline(never)]
    fn tanh(self) -> Self {
        let tracked = math::tanh(self);
        // Its slope is one at most, and so is its size, however far its argument may be off.
        let most = self.error.min(2.0) + ulps(TANH, 1.0);
        let is_known = tracked.error <= most;
        Self::new(tracked.value, if is_known { tracked.error } else { most })
    }
    #[inline(never)]
    fn atan2(self, x: Self) -> Self {
        math::atan2(self, x)
    }
    #[inline(never)]
    fn ln(self) -> Self {
        let bits = self.value.to_bits().wrapping_sub(math::SQRT_HALF_BITS);
        let mantissa = (bits & math::MANTISSA_BITS).wrapping_add(math::SQRT_HALF_BITS);
        let exponent = ((bits as i32) >> 23) as f32;
        let split = math::ln_split(Self::exact(f32::from_bits(mantissa)), Self::exact(exponent));
        let moved = self.error / f64::from(self.value);
        Self::new(<f32 as Lane>::ln(self.value), split.error + moved)
    }

    #[inline(never)]
    fn dispatch<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
}
