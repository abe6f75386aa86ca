//! Vectors of AVX2 and AVX-512.
#![allow(
    unsafe_code,
    reason = "instructions that not every processor has; a `Level` proves that this one does"
)]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

use super::{Kernel, Lanes, Level, Mask, folded};

/// Enters code compiled for AVX2; `_proof` says that the processor has it.
pub fn run_avx2<K: Kernel>(_proof: Level, kernel: K) -> K::Output {
    #[target_feature(enable = "avx2")]
    fn compiled<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }
    // SAFETY: a `Level` of AVX2 or more is only made where the processor was asked for it.
    unsafe { compiled(kernel) }
}

/// Enters code compiled for AVX-512; `_proof` says that the processor has it.
pub fn run_avx512<K: Kernel>(_proof: Level, kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,avx512f")]
    fn compiled<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx512>()
    }
    // SAFETY: a `Level` of AVX-512 is only made where the processor was asked for it.
    unsafe { compiled(kernel) }
}

/// For each sixteen of 48 interleaved numbers: where r and g come from (g's lanes counted from 16), then that mixture and b.
const TRIPLES: [([i32; 16], [i32; 16]); 3] = {
    let mut tables = [([0; 16], [0; 16]); 3];
    let mut k = 0;
    while k < 48 {
        let (part, i) = (k / 16, k % 16);
        let lane = folded(k / 3, 16) as i32;
        (tables[part].0[i], tables[part].1[i]) = match k % 3 {
            0 => (lane, i as i32),
            1 => (16 + lane, i as i32),
            _ => (0, 16 + lane),
        };
        k += 1;
    }
    tables
};

/// Eight lanes. Only [`run_avx2`] brings it to kernels.
#[derive(Clone, Copy)]
pub struct Avx2(__m256);

/// Sixteen lanes. Only [`run_avx512`] brings it to kernels.
#[derive(Clone, Copy)]
pub struct Avx512(__m512);

#[derive(Clone, Copy)]
pub struct Mask8(__m256);

#[derive(Clone, Copy)]
pub struct Mask16(__mmask16);

/// `Lanes` and the operators for a vector type, from its instructions.
macro_rules! lanes {
    ($name:ident, $mask:ident, $count:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident,
     $min:ident, $max:ident, |$a:ident, $b:ident| $at_most:expr, $below:expr, |$m:ident, $yes:ident, $no:ident| $select:expr,
     |$some:ident| $load_some:expr, |$u:ident, $v:ident| { $($distance:literal => $even:expr, $odd:expr;)* } $($more:item)*) => {
        impl Lanes for $name {
            const COUNT: usize = $count;
            type Mask = $mask;

            #[inline(always)]
            fn splat(x: f32) -> Self {
                // SAFETY: this type exists only where its instructions do.
                Self(unsafe { $splat(x) })
            }
            #[inline(always)]
            fn load(from: &[f32]) -> Self {
                let from = &from[..$count];
                // SAFETY: as above; `from` holds as many numbers as are read, and no alignment is asked for.
                Self(unsafe { $load(from.as_ptr()) })
            }
            #[inline(always)]
            fn load_or_zero(from: &[f32]) -> Self {
                let $some = &from[..from.len().min($count)];
                // SAFETY: as above; lanes behind the end are masked, and those are not read.
                Self(unsafe { $load_some })
            }
            #[inline(always)]
            fn prefetch(values: &[f32]) {
                for line in values.chunks(16) {
                    // SAFETY: a hint; it reads nothing.
                    unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) }
                }
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                let to = &mut to[..$count];
                // SAFETY: as above; `to` has as many places as are written.
                unsafe { $store(to.as_mut_ptr(), self.0) }
            }
            #[inline(always)]
            fn over(self, divisor: Self) -> Self {
                // SAFETY: this type exists only where its instructions do.
                Self(unsafe { $div(self.0, divisor.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: this type exists only where its instructions do.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn least(self, other: Self) -> Self {
                // SAFETY: as above. The second operand wins where either is NaN, as in `a < b ? a : b`.
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn most(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> $mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: as above.
                $mask(unsafe { $at_most })
            }
            #[inline(always)]
            fn below(self, other: Self) -> $mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: as above.
                $mask(unsafe { $below })
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                let ($m, $yes, $no) = (mask.0, yes.0, no.0);
                // SAFETY: as above.
                Self(unsafe { $select })
            }
            #[inline(always)]
            fn split<const D: usize>(self, other: Self) -> (Self, Self) {
                let ($u, $v) = (self.0, other.0);
                // SAFETY: as above.
                unsafe {
                    match D {
                        $($distance => (Self($even), Self($odd)),)*
                        _ => unreachable!("{} lanes have no two runs of {D}", $count),
                    }
                }
            }
            $($more)*
        }

        lanes!(operator, $name, Add, add, $add);
        lanes!(operator, $name, Sub, sub, $sub);
        lanes!(operator, $name, Mul, mul, $mul);
    };
    (operator, $name:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: this type exists only where its instructions do.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

lanes!(
    Avx2,
    Mask8,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_sqrt_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    |a, b| _mm256_cmp_ps::<_CMP_LE_OQ>(a, b),
    _mm256_cmp_ps::<_CMP_LT_OQ>(a, b),
    |mask, yes, no| _mm256_blendv_ps(no, yes, mask),
    |from| {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let mask = _mm256_cmpgt_epi32(_mm256_set1_epi32(from.len() as i32), lanes);
        _mm256_maskload_ps(from.as_ptr(), mask)
    },
    |a, b| {
        1 => _mm256_shuffle_ps::<0x88>(a, b), _mm256_shuffle_ps::<0xdd>(a, b);
        2 => _mm256_shuffle_ps::<0x44>(a, b), _mm256_shuffle_ps::<0xee>(a, b);
        4 => _mm256_permute2f128_ps::<0x20>(a, b), _mm256_permute2f128_ps::<0x31>(a, b);
    }
);

lanes!(
    Avx512,
    Mask16,
    16,
    _mm512_set1_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_sqrt_ps,
    _mm512_min_ps,
    _mm512_max_ps,
    |a, b| _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b),
    _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b),
    |mask, yes, no| _mm512_mask_blend_ps(mask, no, yes),
    |from| _mm512_maskz_loadu_ps(((1u32 << from.len()) - 1) as __mmask16, from.as_ptr()),
    |a, b| {
        1 => _mm512_shuffle_ps::<0x88>(a, b), _mm512_shuffle_ps::<0xdd>(a, b);
        2 => _mm512_shuffle_ps::<0x44>(a, b), _mm512_shuffle_ps::<0xee>(a, b);
        4 => _mm512_shuffle_f32x4::<0x88>(a, b), _mm512_shuffle_f32x4::<0xdd>(a, b);
        8 => _mm512_shuffle_f32x4::<0x44>(a, b), _mm512_shuffle_f32x4::<0xee>(a, b);
    }
    #[inline(always)]
    fn store_folded(r: Self, g: Self, b: Self, to: &mut [[f32; 3]]) {
        let to = to[..16].as_flattened_mut();
        for (part, (first, second)) in TRIPLES.iter().enumerate() {
            // SAFETY: this type exists only where its instructions do; the tables hold sixteen numbers each.
            let mixed = unsafe {
                let first = _mm512_loadu_si512(first.as_ptr().cast());
                let second = _mm512_loadu_si512(second.as_ptr().cast());
                let mixed = _mm512_permutex2var_ps(r.0, first, g.0);
                _mm512_permutex2var_ps(mixed, second, b.0)
            };
            Self(mixed).store(&mut to[16 * part..]);
        }
    }
);

impl Mask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: this type exists only where its instructions do.
        (unsafe { _mm256_movemask_ps(self.0) }) as u32
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        // SAFETY: as above.
        unsafe {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
            Self(_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, lanes)))
        }
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: this type exists only where its instructions do.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        // SAFETY: this type exists only where its instructions do.
        Self(unsafe { _mm256_or_ps(self.0, other.0) })
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u16)
    }
}

impl BitAnd for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
