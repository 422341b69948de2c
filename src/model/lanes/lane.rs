//! What a lane type and its scalar can do.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The most lanes that one block has: the episodes that the CPU backend hands to a thread at once.
pub const MAX_WIDTH: usize = 16;

/// A scalar of the episode loop: `f32` or `f64`.
pub trait Real: Copy + Send + Sync + PartialOrd + Debug + Default + 'static {
    /// The largest finite value: what passes it is a divergence.
    const MAX: Self;
    /// Whether this is double precision, the reference; some controllers are compiled for it alone.
    const IS_REFERENCE: bool;
    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// The same value in double precision.
    fn to_f64(self) -> f64;
}

/// A value per episode, `WIDTH` episodes side by side.
pub trait Lane:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The scalar of one lane.
    type Real: Real;
    /// Phase as a fixed-point fraction of a turn, which wraps exactly: neither the length of a run nor where it is cut
    /// into pieces can change a bit of it.
    type Turns: Copy + Send + Sync;
    /// Episodes side by side.
    const WIDTH: usize;

    /// The same value in every lane.
    fn splat(value: Self::Real) -> Self;
    /// `WIDTH` values, each rounded to this precision.
    fn load(values: &[f64]) -> Self;
    /// The value of each lane, written to `out[..WIDTH]`.
    fn store(self, out: &mut [f64]);
    /// `self * factor + addend`, fused where the lane type has the instruction.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The larger value; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller value; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The largest integer not above the value.
    fn floor(self) -> Self;
    /// `yes` where `left <= right`, else `no` (so also where either is NaN).
    fn select_le(left: Self, right: Self, yes: Self, no: Self) -> Self;

    /// Fractions of a turn (any real number; whole turns drop out) as fixed point, `WIDTH` of them.
    fn turns(values: &[f64]) -> Self::Turns;
    /// `phase + step`, exact modulo one turn.
    fn turns_add(phase: Self::Turns, step: Self::Turns) -> Self::Turns;
    /// The sine of a phase.
    fn turns_sin(phase: Self::Turns) -> Self;
    /// Random words as phases uniform over a turn.
    fn turns_from_words(words: &[u32]) -> Self::Turns;
    /// Random words as numbers in (0, 1), on the grid of odd multiples of 2^-24 that both precisions hold exactly.
    fn unit_from_words(words: &[u32]) -> Self;

    /// Sine and cosine of an angle of at most a few turns, rad.
    fn sin_cos(self) -> (Self, Self);
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// The angle of the point (`x`, `self`), rad; 0 at the origin.
    fn atan2(self, x: Self) -> Self;
    /// Natural logarithm of a positive normal number.
    fn ln(self) -> Self;

    /// Runs `kernel` with the instructions that this lane type needs switched on.
    ///
    /// # Panics
    /// If this processor does not have them: [`crate::backend::cpu::Simd`] is the only way to a lane type.
    fn dispatch<K: Kernel>(kernel: K) -> K::Output;

    /// The same number in every lane.
    #[inline(always)]
    fn number(value: f64) -> Self {
        Self::splat(Self::Real::from_f64(value))
    }
}

/// Work whose inner loop is compiled once per instruction set; see [`Lane::dispatch`].
pub trait Kernel {
    /// What the work returns.
    type Output;
    /// The work itself; implementations are `#[inline(always)]`, else they would be compiled without the instructions.
    fn run(self) -> Self::Output;
}
