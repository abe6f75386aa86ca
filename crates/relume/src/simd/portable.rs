//! Vectors as arrays, for every machine; compilers turn them into what the machine has.

use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

use super::{Lanes, Mask};

const COUNT: usize = 8;

#[derive(Clone, Copy)]
pub struct F32x8([f32; COUNT]);

/// All ones or zero in each lane.
#[derive(Clone, Copy)]
pub struct Mask8([u32; COUNT]);

impl F32x8 {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> Mask8 {
        Mask8(std::array::from_fn(|i| {
            u32::from(f(self.0[i], other.0[i])).wrapping_neg()
        }))
    }
}

impl Lanes for F32x8 {
    const COUNT: usize = COUNT;
    type Mask = Mask8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; COUNT])
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let mut lanes = [0.0; COUNT];
        lanes.copy_from_slice(&from[..COUNT]);
        Self(lanes)
    }
    #[inline(always)]
    fn load_or_zero(from: &[f32]) -> Self {
        let mut lanes = [0.0; COUNT];
        let count = from.len().min(COUNT);
        lanes[..count].copy_from_slice(&from[..count]);
        Self(lanes)
    }
    #[inline(always)]
    fn prefetch(_: &[f32]) {}
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..COUNT].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self.zip(divisor, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a <= b)
    }
    #[inline(always)]
    fn below(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| {
            if mask.0[i] != 0 { yes.0[i] } else { no.0[i] }
        }))
    }
    #[inline(always)]
    fn split<const D: usize>(self, other: Self) -> (Self, Self) {
        let [a, b, c, d, e, f, g, h] = self.0;
        let [i, j, k, l, m, n, o, p] = other.0;
        match D {
            1 => (
                Self([a, c, i, k, e, g, m, o]),
                Self([b, d, j, l, f, h, n, p]),
            ),
            2 => (
                Self([a, b, i, j, e, f, m, n]),
                Self([c, d, k, l, g, h, o, p]),
            ),
            4 => (
                Self([a, b, c, d, i, j, k, l]),
                Self([e, f, g, h, m, n, o, p]),
            ),
            _ => unreachable!("eight lanes have no two runs of {D}"),
        }
    }
}

impl Add for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
            .iter()
            .enumerate()
            .fold(0, |bits, (i, lane)| bits | (lane & (1 << i)))
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(std::array::from_fn(|i| (bits >> i & 1).wrapping_neg()))
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }
}
