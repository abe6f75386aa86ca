//! Vectors of f32 for the kernels: written once over [`Lanes`], compiled for each instruction set, chosen when the program runs.
//!
//! Every operation is one IEEE operation per lane (no fused multiply-add, no reciprocal estimates), and kernels add in an order that does
//! not depend on the width of a vector, so all instruction sets give the same bits.
//!
//! `unsafe` stands here alone: the compiler cannot know that a function compiled for AVX-512 is only called where the processor has it. A
//! [`Level`] is the proof: it is made by asking the processor, and only [`Level::run`] enters such functions.

mod portable;
mod transpose;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::fmt::{self, Display, Formatter};
use std::ops::{Add, BitAnd, BitOr, Mul, Sub};
use std::str::FromStr;

pub(crate) use transpose::transpose;

/// A vector of f32.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + 'static
{
    /// How many.
    const COUNT: usize;
    /// One truth value per lane.
    type Mask: Mask;

    /// `x` in every lane.
    fn splat(x: f32) -> Self;
    /// The first [`Self::COUNT`] numbers of `from`; panics where there are fewer.
    fn load(from: &[f32]) -> Self;
    /// The first [`Self::COUNT`] numbers of `from`, then zeros where there are fewer.
    fn load_or_zero(from: &[f32]) -> Self;
    /// Asks for the memory at `values` ahead of time, where the processor can.
    fn prefetch(values: &[f32]);
    /// Into the first [`Self::COUNT`] places of `to`; panics where there are fewer.
    fn store(self, to: &mut [f32]);
    /// The quotient.
    fn over(self, divisor: Self) -> Self;
    /// The square root; not a number of what is negative.
    fn sqrt(self) -> Self;
    /// `a < b ? a : b`.
    fn least(self, other: Self) -> Self;
    /// `a > b ? a : b`.
    fn most(self, other: Self) -> Self;
    /// `a <= b`.
    fn at_most(self, other: Self) -> Self::Mask;
    /// `a < b`.
    fn below(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Cuts both vectors into runs of `D` lanes (1, 2, 4 or 8, below [`Self::COUNT`]) and gives those of even and those of odd number, the
    /// runs of `self` before those of `other`: within each four lanes for `D` = 1 and 2, over the whole vector for 4 and 8.
    fn split<const D: usize>(self, other: Self) -> (Self, Self);
    /// The sum of both halves of [`Self::split`].
    #[inline(always)]
    fn fold<const D: usize>(self, other: Self) -> Self {
        let (even, odd) = self.split::<D>(other);
        even + odd
    }
    /// Interleaves three vectors, lane `folded``(0)` first: `to` receives `[r, g, b]` for each lane in that order.
    #[inline(always)]
    fn store_folded(r: Self, g: Self, b: Self, to: &mut [[f32; 3]]) {
        let mut lanes = [[0.0; 16]; 3];
        r.store(&mut lanes[0]);
        g.store(&mut lanes[1]);
        b.store(&mut lanes[2]);
        let to = &mut to[..Self::COUNT];
        for (i, to) in to.iter_mut().enumerate() {
            let lane = folded(i, Self::COUNT);
            *to = [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
        }
    }
}

/// The lane in which vector `i` of `count` ends when as many are folded into one, neighbours first: by 8 (where there are sixteen), 4, 2 and
/// 1. Each fold brings one bit of `i` to its place.
#[inline(always)]
pub(crate) const fn folded(i: usize, count: usize) -> usize {
    if count == 16 {
        (i & 1) << 2 | (i & 2) << 2 | (i & 4) >> 2 | (i & 8) >> 2
    } else {
        (i & 1) << 2 | (i & 2) >> 1 | (i & 4) >> 1
    }
}

/// One truth value per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Bit i: lane i.
    fn bits(self) -> u32;
    /// Lane i: bit i.
    fn from_bits(bits: u32) -> Self;
}

/// Work that is written once for every kind of vector. `run` and all it calls should be `#[inline(always)]`.
pub trait Kernel {
    /// What it gives.
    type Output;
    /// The work.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// An instruction set this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// What every machine has.
    pub const PORTABLE: Self = Self(Set::Portable);

    /// The widest this processor has.
    pub fn best() -> Self {
        *Self::here().last().unwrap_or(&Self::PORTABLE)
    }

    /// All that this processor has, the widest last.
    pub fn here() -> &'static [Self] {
        #[cfg(target_arch = "x86_64")]
        {
            const ALL: &[Level] = &[Level::PORTABLE, Level(Set::Avx2), Level(Set::Avx512)];
            let avx2 = is_x86_feature_detected!("avx2");
            let avx512 = avx2 && is_x86_feature_detected!("avx512f");
            &ALL[..1 + usize::from(avx2) + usize::from(avx512)]
        }
        #[cfg(not(target_arch = "x86_64"))]
        &[Self::PORTABLE]
    }

    /// Lanes of its vectors.
    pub fn width(self) -> usize {
        struct Width;
        impl Kernel for Width {
            type Output = usize;
            #[inline(always)]
            fn run<L: Lanes>(self) -> usize {
                L::COUNT
            }
        }
        self.run(Width)
    }

    /// Runs `kernel` compiled for this instruction set.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Portable => kernel.run::<portable::F32x8>(),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => x86::run_avx2(self, kernel),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => x86::run_avx512(self, kernel),
        }
    }
}

impl Display for Level {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(match self.0 {
            Set::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        })
    }
}

impl FromStr for Level {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let named = Self::here().iter().find(|level| level.to_string() == name);
        named.copied().ok_or_else(|| {
            let here: Vec<String> = Self::here().iter().map(ToString::to_string).collect();
            format!("this processor offers {}", here.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything<'a>(&'a [f32], &'a [f32]);

    impl Kernel for Everything<'_> {
        type Output = Vec<f32>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<f32> {
            let mut results = Vec::new();
            let mut keep = |vectors: &[L]| {
                for vector in vectors {
                    let mut lanes = [0.0; 16];
                    vector.store(&mut lanes);
                    results.push(lanes[..L::COUNT].to_vec());
                }
            };
            for (a, b) in self.0.chunks(L::COUNT).zip(self.1.chunks(L::COUNT)) {
                let (a, b) = (L::load(a), L::load(b));
                let (low, equal) = (a.below(b), a.at_most(b));
                let chosen = L::select(low | equal, a, L::splat(7.0));
                let both = L::select(low & equal, a, b);
                let bits = L::select(L::Mask::from_bits(low.bits()), a, b);
                keep(&[
                    a + b,
                    a - b,
                    a * b,
                    a.over(b),
                    a.least(b),
                    a.most(b),
                    chosen,
                    both,
                    bits,
                    a.sqrt(),
                ]);
            }
            // By operation, then by lane: the same list whatever the width.
            (0..10)
                .flat_map(|op| {
                    results
                        .iter()
                        .skip(op)
                        .step_by(10)
                        .flatten()
                        .copied()
                        .collect::<Vec<_>>()
                })
                .collect()
        }
    }

    #[test]
    fn all_instruction_sets_agree_to_the_bit() {
        let special = [
            0.0,
            -0.0,
            1.0,
            -1.5,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            1e-40,
            3.4e38,
        ];
        let a: Vec<f32> = (0..144).map(|i| special[i % 9]).collect();
        let b: Vec<f32> = (0..144).map(|i| special[(i / 9) % 9]).collect();
        let bits = |level: Level| -> Vec<u32> {
            let values = level.run(Everything(&a, &b));
            // Which NaN comes out of an operation is not promised.
            values
                .iter()
                .map(|x| if x.is_nan() { 0 } else { x.to_bits() })
                .collect()
        };
        let expected = bits(Level::PORTABLE);
        assert_eq!(expected.len(), 10 * 144);
        Level::here()
            .iter()
            .for_each(|&level| assert!(bits(level) == expected, "{level}"));
    }

    struct Pieces<'a>(&'a [f32]);

    impl Kernel for Pieces<'_> {
        type Output = Vec<Vec<f32>>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<Vec<f32>> {
            let mut all = Vec::new();
            let mut keep = |vector: L| {
                let mut lanes = [0.0; 16];
                vector.store(&mut lanes);
                all.push(lanes[..L::COUNT].to_vec());
            };
            let (a, b) = (L::load(self.0), L::load(&self.0[L::COUNT..]));
            keep(a.split::<1>(b).0);
            keep(a.split::<1>(b).1);
            keep(a.split::<2>(b).0);
            keep(a.split::<2>(b).1);
            keep(a.split::<4>(b).0);
            keep(a.split::<4>(b).1);
            keep(a.fold::<2>(b));
            for count in 0..=L::COUNT + 1 {
                keep(L::load_or_zero(&self.0[..count]));
            }
            if L::COUNT > 8 {
                keep(a.split::<8>(b).0);
                keep(a.split::<8>(b).1);
            }
            all
        }
    }

    #[test]
    fn vectors_are_cut_into_runs_and_filled_up_with_zeros() {
        let from: Vec<f32> = (1..40).map(|i| i as f32).collect();
        for &level in Level::here() {
            let width = level.width();
            let all = level.run(Pieces(&from));
            // The numbers of both vectors that lie in even runs of `d`, group of `group` lanes by group.
            let split = |d: usize, group: usize, odd: usize| -> Vec<f32> {
                let lanes = (0..width / group).flat_map(|g| [g * group, width + g * group]);
                lanes
                    .flat_map(|start| start..start + group)
                    .filter(|lane| lane / d % 2 == odd)
                    .map(|lane| from[lane])
                    .collect()
            };
            let mut expected = Vec::new();
            for (d, group) in [(1, 4), (2, 4), (4, width)] {
                expected.extend([split(d, group, 0), split(d, group, 1)]);
            }
            let (even, odd) = (split(2, 4, 0), split(2, 4, 1));
            expected.push(even.iter().zip(&odd).map(|(a, b)| a + b).collect());
            for count in 0..=width + 1 {
                let kept = |i: usize| if i < count { from[i] } else { 0.0 };
                expected.push((0..width).map(kept).collect());
            }
            if width > 8 {
                expected.extend([split(8, width, 0), split(8, width, 1)]);
            }
            assert_eq!(all, expected, "{level}");
        }
    }

    struct Triples<'a>(&'a [f32], &'a mut [[f32; 3]]);

    impl Kernel for Triples<'_> {
        type Output = usize;

        #[inline(always)]
        fn run<L: Lanes>(self) -> usize {
            let [r, g, b] = [0, 20, 40].map(|start| L::load(&self.0[start..]));
            L::store_folded(r, g, b, self.1);
            L::COUNT
        }
    }

    #[test]
    fn triples_come_out_in_the_order_of_the_folds() {
        let from: Vec<f32> = (0..60).map(|i| i as f32).collect();
        for &level in Level::here() {
            let mut to = [[-1.0; 3]; 18];
            let count = level.run(Triples(&from, &mut to));
            for (i, &rgb) in to.iter().enumerate() {
                let lane = folded(i, count) as f32;
                let expected = [lane, 20.0 + lane, 40.0 + lane];
                assert_eq!(rgb, if i < count { expected } else { [-1.0; 3] }, "{level}");
            }
        }
    }

    #[test]
    fn names_are_read_back_and_others_refused() {
        Level::here()
            .iter()
            .for_each(|level| assert_eq!(level.to_string().parse(), Ok(*level)));
        assert!("sse9".parse::<Level>().unwrap_err().contains("portable"));
    }
}
