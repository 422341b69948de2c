//! Lane blocks of single-precision episodes on x86-64: 8 lanes with AVX2, 16 with AVX-512. Both fuse every
//! multiply-add, so they give the same bits.
#![expect(
    unsafe_code,
    reason = "vector instructions are unsafe to call where the processor may lack them"
)]

use super::lane::{Kernel, Lane, Real};
use super::math;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight episodes side by side; needs AVX2 and FMA.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x8(__m256);

/// Sixteen episodes side by side; needs AVX-512 F and DQ.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x16(__m512);

/// Phases of eight episodes.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Turns8(__m256i);

/// Phases of sixteen episodes.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Turns16(__m512i);

// SAFETY (all blocks below): a value of these types only exists where `backend::cpu::Simd` found the instruction set,
// and `dispatch` asserts it again before any kernel runs; loads and stores go through arrays of the right length.

#[inline(always)]
unsafe fn select_le_8(left: __m256, right: __m256, yes: __m256, no: __m256) -> __m256 {
    unsafe { _mm256_blendv_ps(no, yes, _mm256_cmp_ps::<_CMP_LE_OQ>(left, right)) }
}

#[inline(always)]
unsafe fn select_le_16(left: __m512, right: __m512, yes: __m512, no: __m512) -> __m512 {
    unsafe { _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(left, right), no, yes) }
}

macro_rules! lane_block {
    ($lane:ident, $turns:ident, $width:literal, $float:ty, $int:ty, features: $features:literal, detected: $detected:expr,
     loadu: $loadu:ident, storeu: $storeu:ident, loadu_int: $loadu_int:ident, set1: $set1:ident, set1_int: $set1_int:ident,
     add: $add:ident, sub: $sub:ident, mul: $mul:ident, div: $div:ident, fmadd: $fmadd:ident, max: $max:ident, min: $min:ident,
     sqrt: $sqrt:ident, and: $and:ident, xor: $xor:ident, floor: $floor:expr, select_le: $select_le:ident,
     add_int: $add_int:ident, sub_int: $sub_int:ident, and_int: $and_int:ident,
     shl: $shl:expr, sar: $sar:expr, shr: $shr:expr, convert: $convert:ident, as_float: $as_float:ident, as_int: $as_int:ident) => {
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
            fn from_array(values: [f32; $width]) -> Self {
                Self(unsafe { $loadu(values.as_ptr()) })
            }
            #[inline(always)]
            fn to_array(self) -> [f32; $width] {
                let mut values = [0.0; $width];
                unsafe { $storeu(values.as_mut_ptr(), self.0) };
                values
            }
        }
        impl $turns {
            #[inline(always)]
            fn from_array(words: [u32; $width]) -> Self {
                Self(unsafe { $loadu_int(words.as_ptr().cast()) })
            }
        }
        impl Lane for $lane {
            type Real = f32;
            type Turns = $turns;
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(value: f32) -> Self {
                Self(unsafe { $set1(value) })
            }
            #[inline(always)]
            fn load(values: &[f64]) -> Self {
                Self::from_array(std::array::from_fn(|lane| f32::from_f64(values[lane])))
            }
            #[inline(always)]
            fn store(self, out: &mut [f64]) {
                for (out, value) in out.iter_mut().zip(self.to_array()) {
                    *out = f64::from(value);
                }
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                Self(unsafe { $fmadd(self.0, factor.0, addend.0) })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(unsafe { $and(self.0, $as_float($set1_int(i32::MAX))) })
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
                $turns::from_array(std::array::from_fn(|lane| {
                    math::fixed_turns_32(values[lane])
                }))
            }
            #[inline(always)]
            fn turns_add(phase: $turns, step: $turns) -> $turns {
                $turns(unsafe { $add_int(phase.0, step.0) })
            }
            #[inline(always)]
            #[expect(clippy::cast_possible_wrap, reason = "bit patterns")]
            fn turns_sin(phase: $turns) -> Self {
                // Twin of the scalar f32 version, which explains the folding.
                unsafe {
                    let folded = Self($mul($convert($shl(phase.0)), $set1(math::FOLD_SCALE)));
                    let sine = math::sin_folded(folded);
                    let flipped = $and_int(
                        $add_int(phase.0, $set1_int(math::QUARTER_TURN as i32)),
                        $set1_int(math::SIGN_BIT as i32),
                    );
                    Self($xor(sine.0, $as_float(flipped)))
                }
            }
            #[inline(always)]
            fn turns_from_words(words: &[u32]) -> $turns {
                $turns::from_array(std::array::from_fn(|lane| words[lane]))
            }
            #[inline(always)]
            fn unit_from_words(words: &[u32]) -> Self {
                unsafe {
                    let bits = $convert($shr(Self::turns_from_words(words).0));
                    Self($mul(
                        $add(bits, $set1(0.5)),
                        $set1(f32::from_f64(math::UNIT_SPACING)),
                    ))
                }
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
            #[expect(clippy::cast_possible_wrap, reason = "bit patterns")]
            fn ln(self) -> Self {
                unsafe {
                    let base = $set1_int(math::SQRT_HALF_BITS as i32);
                    let shifted = $sub_int($as_int(self.0), base);
                    let exponent = Self($convert($sar(shifted)));
                    let fraction = $and_int(shifted, $set1_int(math::MANTISSA_BITS as i32));
                    math::ln_split(Self($as_float($add_int(fraction, base))), exponent)
                }
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

lane_block!(F32x8, Turns8, 8, __m256, __m256i, features: "avx2,fma",
    detected: is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
    loadu: _mm256_loadu_ps, storeu: _mm256_storeu_ps, loadu_int: _mm256_loadu_si256, set1: _mm256_set1_ps,
    set1_int: _mm256_set1_epi32, add: _mm256_add_ps, sub: _mm256_sub_ps, mul: _mm256_mul_ps, div: _mm256_div_ps,
    fmadd: _mm256_fmadd_ps, max: _mm256_max_ps, min: _mm256_min_ps, sqrt: _mm256_sqrt_ps, and: _mm256_and_ps,
    xor: _mm256_xor_ps, floor: (_mm256_floor_ps),
    select_le: select_le_8,
    add_int: _mm256_add_epi32, sub_int: _mm256_sub_epi32, and_int: _mm256_and_si256,
    shl: (_mm256_slli_epi32::<1>), sar: (_mm256_srai_epi32::<23>), shr: (_mm256_srli_epi32::<9>),
    convert: _mm256_cvtepi32_ps, as_float: _mm256_castsi256_ps, as_int: _mm256_castps_si256);

lane_block!(F32x16, Turns16, 16, __m512, __m512i, features: "avx512f,avx512dq,avx2,fma",
    detected: is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq"),
    loadu: _mm512_loadu_ps, storeu: _mm512_storeu_ps, loadu_int: _mm512_loadu_si512, set1: _mm512_set1_ps,
    set1_int: _mm512_set1_epi32, add: _mm512_add_ps, sub: _mm512_sub_ps, mul: _mm512_mul_ps, div: _mm512_div_ps,
    fmadd: _mm512_fmadd_ps, max: _mm512_max_ps, min: _mm512_min_ps, sqrt: _mm512_sqrt_ps, and: _mm512_and_ps,
    xor: _mm512_xor_ps, floor: (_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>),
    select_le: select_le_16,
    add_int: _mm512_add_epi32, sub_int: _mm512_sub_epi32, and_int: _mm512_and_si512,
    shl: (_mm512_slli_epi32::<1>), sar: (_mm512_srai_epi32::<23>), shr: (_mm512_srli_epi32::<9>),
    convert: _mm512_cvtepi32_ps, as_float: _mm512_castsi512_ps, as_int: _mm512_castps_si512);
