//! The scalars as lanes, one episode wide: `f64`, the reference, and `f32`, the twin of the GPU.

use super::lane::{Kernel, Lane, Real};
use super::{math, math_double};

impl Real for f64 {
    const MAX: Self = f64::MAX;
    const IS_REFERENCE: bool = true;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Real for f32 {
    const MAX: Self = f32::MAX;
    const IS_REFERENCE: bool = false;
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding to single precision is what this does"
    )]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Lane for f64 {
    type Real = f64;
    type Turns = u64;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        values[0]
    }
    #[inline(always)]
    fn store(self, out: &mut [f64]) {
        out[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        f64::floor(self)
    }
    #[inline(always)]
    fn select_le(left: Self, right: Self, yes: Self, no: Self) -> Self {
        if left <= right { yes } else { no }
    }
    #[inline(always)]
    fn turns(values: &[f64]) -> u64 {
        math::fixed_turns(values[0])
    }
    #[inline(always)]
    fn turns_add(phase: u64, step: u64) -> u64 {
        phase.wrapping_add(step)
    }
    #[inline(always)]
    fn turns_sin(phase: u64) -> Self {
        math_double::sin_folded(math_double::folded(phase))
    }
    #[inline(always)]
    fn turns_from_words(words: &[u32]) -> u64 {
        u64::from(words[0]) << 32
    }
    #[inline(always)]
    fn unit_from_words(words: &[u32]) -> Self {
        (f64::from(words[0] >> 9) + 0.5) * math::UNIT_SPACING
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        math_double::sin_cos(self)
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        math_double::tanh(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        math_double::atan2(self, x)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        let (mantissa, exponent) = math_double::split(self);
        math_double::ln_split(mantissa, exponent)
    }
    #[inline(never)]
    fn dispatch<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
}

impl Lane for f32 {
    type Real = f32;
    type Turns = u32;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        f32::from_f64(values[0])
    }
    #[inline(always)]
    fn store(self, out: &mut [f64]) {
        out[0] = f64::from(self);
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        f32::floor(self)
    }
    #[inline(always)]
    fn select_le(left: Self, right: Self, yes: Self, no: Self) -> Self {
        if left <= right { yes } else { no }
    }
    #[inline(always)]
    fn turns(values: &[f64]) -> u32 {
        math::fixed_turns_32(values[0])
    }
    #[inline(always)]
    fn turns_add(phase: u32, step: u32) -> u32 {
        phase.wrapping_add(step)
    }
    #[inline(always)]
    #[expect(
        clippy::cast_possible_wrap,
        clippy::cast_precision_loss,
        reason = "the signed reading of the phase is meant"
    )]
    fn turns_sin(phase: u32) -> Self {
        // Doubling the phase modulo one turn folds both half waves onto one quarter-turn range around zero; the half
        // wave that was turned over is told by the top bit of the phase moved on by a quarter turn.
        let folded = (phase << 1) as i32 as f32 * math::FOLD_SCALE;
        let sine = math::sin_folded(folded);
        f32::from_bits(sine.to_bits() ^ (phase.wrapping_add(math::QUARTER_TURN) & math::SIGN_BIT))
    }
    #[inline(always)]
    fn turns_from_words(words: &[u32]) -> u32 {
        words[0]
    }
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        reason = "23 bits and a half fit a single"
    )]
    fn unit_from_words(words: &[u32]) -> Self {
        ((words[0] >> 9) as f32 + 0.5) * f32::from_f64(math::UNIT_SPACING)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        math::sin_cos(self)
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        math::tanh(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        math::atan2(self, x)
    }
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_wrap,
        reason = "an exponent is a small integer"
    )]
    fn ln(self) -> Self {
        let shifted = self.to_bits().wrapping_sub(math::SQRT_HALF_BITS);
        let exponent = ((shifted as i32) >> 23) as f32;
        let mantissa =
            f32::from_bits((shifted & math::MANTISSA_BITS).wrapping_add(math::SQRT_HALF_BITS));
        math::ln_split(mantissa, exponent)
    }
    #[inline(never)]
    fn dispatch<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
}
