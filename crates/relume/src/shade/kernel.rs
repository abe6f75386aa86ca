//! Dot products of every vertex's transfer vectors with a few lights, as fast as memory is read.
//!
//! Lanes lie along the coefficients, so that transfer is read as it is stored. What remains are sums across lanes, sixteen (or eight)
//! vertices together: a tree of [`Lanes::fold`] leaves one vector with one sum per vertex.
//!
//! The order of each sum is fixed: coefficient i adds to partial sum i mod 16, one after the other, then partial sums 8, 4, 2 and 1 apart
//! are added. So the bits depend neither on the instruction set nor on the other vertices and lights.

use crate::simd::{Kernel, Lanes};

/// Partial sums of a dot product, which is the widest vector.
pub const WIDE: usize = 16;

/// One light: a row per channel, each padded with zeros to a multiple of [`WIDE`].
pub type Planes = [Vec<f32>; 3];

/// Shades some vertices by every light.
pub struct Shade<'a, 'b> {
    /// `[vertices][channels][count]`.
    pub vectors: &'a [f32],
    /// 1 or 3.
    pub channels: usize,
    /// Coefficients of a vector.
    pub count: usize,
    pub lights: &'a [Planes],
    /// `[lights][vertices]`.
    pub radiance: &'a mut [&'b mut [[f32; 3]]],
}

impl Kernel for Shade<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        // Loops of known length for orders 1 to 5; a length of 0 is read when it runs.
        match (self.channels, self.count.div_ceil(WIDE)) {
            (1, 1) => self.blocks::<L, 1, 1>(),
            (1, 2) => self.blocks::<L, 1, 2>(),
            (1, _) => self.blocks::<L, 1, 0>(),
            (_, 1) => self.blocks::<L, 3, 1>(),
            (_, 2) => self.blocks::<L, 3, 2>(),
            _ => self.blocks::<L, 3, 0>(),
        }
    }
}

impl Shade<'_, '_> {
    /// As many vertices at a time as a vector has lanes, and all lights while these vertices are in the cache.
    #[inline(always)]
    fn blocks<L: Lanes, const CHANNELS: usize, const PIECES: usize>(self) {
        let stride = CHANNELS * self.count;
        let vertices = self.vectors.len() / stride;
        let mut first = 0;
        while first < vertices {
            let here = (vertices - first).min(L::COUNT);
            for (light, radiance) in self.lights.iter().zip(self.radiance.iter_mut()) {
                let block = Block::<CHANNELS, PIECES> {
                    vectors: &self.vectors[first * stride..(first + here) * stride],
                    last: here - 1,
                    count: self.count,
                    light,
                };
                let Rgb { r, g, b } = block.sums::<L>();
                let radiance = &mut radiance[first..first + here];
                if here == L::COUNT {
                    L::store_folded(r, g, b, radiance);
                } else {
                    let mut all = [[0.0; 3]; WIDE];
                    L::store_folded(r, g, b, &mut all);
                    radiance.copy_from_slice(&all[..here]);
                }
            }
            first += here;
        }
    }
}

/// One vector per colour; no array, which would be kept in memory.
#[derive(Clone, Copy)]
struct Rgb<L> {
    r: L,
    g: L,
    b: L,
}

impl<L: Lanes> Rgb<L> {
    /// [`Lanes::fold`] by colour.
    #[inline(always)]
    fn fold<const D: usize>(self, other: Self) -> Self {
        Self {
            r: self.r.fold::<D>(other.r),
            g: self.g.fold::<D>(other.g),
            b: self.b.fold::<D>(other.b),
        }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self {
            r: self.r + other.r,
            g: self.g + other.g,
            b: self.b + other.b,
        }
    }
}

/// Up to `L::COUNT` vertices and one light. `PIECES`: how many times [`WIDE`] coefficients there are, 0 if that is not known.
struct Block<'a, const CHANNELS: usize, const PIECES: usize> {
    vectors: &'a [f32],
    /// The last vertex, which stands in for those that would follow.
    last: usize,
    count: usize,
    light: &'a Planes,
}

impl<const CHANNELS: usize, const PIECES: usize> Block<'_, CHANNELS, PIECES> {
    /// The sums of all vertices, that of vertex v in lane [`crate::simd::folded`] of v. Vertices are visited in their order, as memory is read fastest.
    #[inline(always)]
    fn sums<L: Lanes>(&self) -> Rgb<L> {
        let half = L::COUNT / 2;
        self.two_apart::<L>(0).fold::<1>(self.two_apart::<L>(half))
    }

    #[inline(always)]
    fn two_apart<L: Lanes>(&self, v: usize) -> Rgb<L> {
        let quarter = L::COUNT / 4;
        self.four_apart::<L>(v)
            .fold::<2>(self.four_apart::<L>(v + quarter))
    }

    #[inline(always)]
    fn four_apart<L: Lanes>(&self, v: usize) -> Rgb<L> {
        let eighth = L::COUNT / 8;
        self.eight_apart::<L>(v)
            .fold::<4>(self.eight_apart::<L>(v + eighth))
    }

    /// Partial sums 8 apart added: two vertices in one vector of sixteen, one in a vector of eight.
    #[inline(always)]
    fn eight_apart<L: Lanes>(&self, v: usize) -> Rgb<L> {
        if L::COUNT == WIDE {
            self.partial::<L>(v, 0)
                .fold::<8>(self.partial::<L>(v + 1, 0))
        } else {
            self.partial::<L>(v, 0).plus(self.partial::<L>(v, L::COUNT))
        }
    }

    /// Partial sums of vertex `v`, as many as there are lanes from the `first` on.
    #[inline(always)]
    fn partial<L: Lanes>(&self, v: usize, first: usize) -> Rgb<L> {
        let stride = CHANNELS * self.count;
        let vector = &self.vectors[v.min(self.last) * stride..][..stride];
        let pieces = if PIECES > 0 {
            PIECES
        } else {
            self.light[0].len() / WIDE
        };
        let mut sums = self.products::<L>(vector, first, pieces == 1);
        for piece in 1..pieces {
            let start = piece * WIDE + first;
            sums = sums.plus(self.products::<L>(vector, start, piece + 1 == pieces));
        }
        sums
    }

    /// Transfer × light for the coefficients from `start` on; `is_last` where there may be fewer than lanes.
    #[inline(always)]
    fn products<L: Lanes>(&self, vector: &[f32], start: usize, is_last: bool) -> Rgb<L> {
        let [r, g, b] = self.light;
        let t = self.coefficients::<L>(vector, 0, start, is_last);
        let (mut tg, mut tb) = (t, t);
        if CHANNELS == 3 {
            tg = self.coefficients::<L>(vector, 1, start, is_last);
            tb = self.coefficients::<L>(vector, 2, start, is_last);
        }
        Rgb {
            r: t * L::load(&r[start..]),
            g: tg * L::load(&g[start..]),
            b: tb * L::load(&b[start..]),
        }
    }

    #[inline(always)]
    fn coefficients<L: Lanes>(
        &self,
        vector: &[f32],
        channel: usize,
        start: usize,
        is_last: bool,
    ) -> L {
        let row = &vector[channel * self.count..(channel + 1) * self.count];
        if is_last {
            L::load_or_zero(&row[start.min(self.count)..])
        } else {
            L::load(&row[start..])
        }
    }
}
