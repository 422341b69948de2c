//! Lane blocks of double-precision episodes on x86-64: 4 lanes with AVX2, 8 with AVX-512. Every operation is that of
//! the scalar in every lane, products and sums rounded one by one, so that the reference has the same bits in every
//! layout.
#![expect(
    unsafe_code,
    reason = "vector instructions are unsafe to call where the processor may lack them"
)]

use super::lane::{Kernel, Lane};
use super::math_double;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four episodes side by side; needs AVX2.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x4(__m256d);

/// Eight episodes side by side; needs AVX-512 F and DQ.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x8(__m512d);

/// Phases of four episodes.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Turns4(__m256i);

/// Phases of eight episodes.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Turns8(__m512i);

// SAFETY (all blocks below): a value of these types only exists where `backend::cpu::Simd` found the instruction set,
// and `dispatch` asserts it again before any kernel runs; loads and stores go through arrays of the right length.

#[inline(always)]
unsafe fn select_le_4(left: __m256d, right: __m256d, yes: __m256d, no: __m256d) -> __m256d {
    unsafe { _mm256_blendv_pd(no, yes, _mm256_cmp_pd::<_CMP_LE_OQ>(left, right)) }
}

#[inline(always)]
unsafe fn select_le_8(left: __m512d, right: __m512d, yes: __m512d, no: __m512d) -> __m512d {
    unsafe { _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(left, right), no, yes) }
}

macro_rules! lane_block {
    ($lane:ident, $turns:ident, $width:literal, features: $features:literal, detected: $detected:expr,
     loadu: $loadu:ident, storeu: $storeu:ident, loadu_int: $loadu_int:ident, storeu_int: $storeu_int:ident,
     set1: $set1:ident, add: $add:ident, sub: $sub:ident, mul: $mul:ident, div: $div:ident, max: $max:ident,
     min: $min:ident, sqrt: $sqrt:ident, andnot: $andnot:ident, xor: $xor:ident, floor: $floor:expr,
     select_le: $select_le:ident, add_int: $add_int:ident) => {
        impl Add for $lane {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(unsafe { $add(self.0, other.0) })
            }
        }
        impl Sub for $lane {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(unsafe { $sub(self.0, other.0) })
            }
        }
        impl Mul for $lane {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(unsafe { $mul(self.0, other.0) })
            }
        }
        impl Div for $lane {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self(unsafe { $div(self.0, other.0) })
            }
        }
        impl Neg for $lane {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(unsafe { $xor(self.0, $set1(-0.0)) })
            }
        }
        impl $lane {
            #[inline(always)]
            fn from_array(values: [f64; $width]) -> Self {
                Self(unsafe { $loadu(values.as_ptr()) })
            }
            #[inline(always)]
            fn to_array(self) -> [f64; $width] {
                let mut values = [0.0; $width];
                unsafe { $storeu(values.as_mut_ptr(), self.0) };
                values
            }
        }
        impl $turns {
            #[inline(always)]
            fn from_array(words: [u64; $width]) -> Self {
                Self(unsafe { $loadu_int(words.as_ptr().cast()) })
            }
            #[inline(always)]
            fn to_array(self) -> [u64; $width] {
                let mut words = [0; $width];
                unsafe { $storeu_int(words.as_mut_ptr().cast(), self.0) };
                words
            }
        }
        impl Lane for $lane {
            type Real = f64;
            type Turns = $turns;
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self(unsafe { $set1(value) })
            }
            #[inline(always)]
            fn load(values: &[f64]) -> Self {
                Self::from_array(std::array::from_fn(|lane| values[lane]))
            }
            #[inline(always)]
            fn store(self, out: &mut [f64]) {
                out[..$width].copy_from_slice(&self.to_array());
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(unsafe { $andnot($set1(-0.0), self.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn floor(self) -> Self {
                Self(unsafe { $floor(self.0) })
            }
            #[inline(always)]
            fn select_le(left: Self, right: Self, yes: Self, no: Self) -> Self {
                Self(unsafe { $select_le(left.0, right.0, yes.0, no.0) })
            }
            #[inline(always)]
            fn turns(values: &[f64]) -> $turns {
                $turns::from_array(std::array::from_fn(|lane| f64::turns(&values[lane..])))
            }
            #[inline(always)]
            fn turns_add(phase: $turns, step: $turns) -> $turns {
                $turns(unsafe { $add_int(phase.0, step.0) })
            }
            #[inline(always)]
            fn turns_sin(phase: $turns) -> Self {
                math_double::sin_folded(Self::from_array(phase.to_array().map(math_double::folded)))
            }
            #[inline(always)]
            fn turns_from_words(words: &[u32]) -> $turns {
                let of_lane = |lane| f64::turns_from_words(&words[lane..]);
                $turns::from_array(std::array::from_fn(of_lane))
            }
            #[inline(always)]
            fn unit_from_words(words: &[u32]) -> Self {
                let of_lane = |lane| f64::unit_from_words(&words[lane..]);
                Self::from_array(std::array::from_fn(of_lane))
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
                let parts = self.to_array().map(math_double::split);
                let [mantissa, exponent] = [parts.map(|part| part.0), parts.map(|part| part.1)];
                math_double::ln_split(Self::from_array(mantissa), Self::from_array(exponent))
            }
            fn dispatch<K: Kernel>(kernel: K) -> K::Output {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn with_features<K: Kernel>(kernel: K) -> K::Output {
                    kernel.run()
                }
                assert!($detected, "the processor lacks {}", $features);
                unsafe { with_features(kernel) }
            }
        }
    };
}

lane_block!(F64x4, Turns4, 4, features: "avx2", detected: is_x86_feature_detected!("avx2"),
    loadu: _mm256_loadu_pd, storeu: _mm256_storeu_pd, loadu_int: _mm256_loadu_si256,
    storeu_int: _mm256_storeu_si256, set1: _mm256_set1_pd, add: _mm256_add_pd, sub: _mm256_sub_pd,
    mul: _mm256_mul_pd, div: _mm256_div_pd, max: _mm256_max_pd, min: _mm256_min_pd, sqrt: _mm256_sqrt_pd,
    andnot: _mm256_andnot_pd, xor: _mm256_xor_pd, floor: (_mm256_floor_pd), select_le: select_le_4,
    add_int: _mm256_add_epi64);

lane_block!(F64x8, Turns8, 8, features: "avx512f,avx512dq,avx2",
    detected: is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq"),
    loadu: _mm512_loadu_pd, storeu: _mm512_storeu_pd, loadu_int: _mm512_loadu_si512,
    storeu_int: _mm512_storeu_si512, set1: _mm512_set1_pd, add: _mm512_add_pd, sub: _mm512_sub_pd,
    mul: _mm512_mul_pd, div: _mm512_div_pd, max: _mm512_max_pd, min: _mm512_min_pd, sqrt: _mm512_sqrt_pd,
    andnot: _mm512_andnot_pd, xor: _mm512_xor_pd,
    floor: (_mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>), select_le: select_le_8,
    add_int: _mm512_add_epi64);
