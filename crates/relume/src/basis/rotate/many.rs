//! Rotation of many expansions at once, in f32: a vector of expansions at a time.

use super::{Rotation, offset};
use crate::simd::{Kernel, Lanes, Level, transpose};

/// Expansions that one thread takes at a time.
const CHUNK: usize = 256;
/// Rows of a matrix that are multiplied at the same time, so that additions do not wait for each other.
const ROWS: usize = 4;

impl Rotation {
    /// Writes the rotated `vectors`, `[k][order²]`, to `rotated`, in f32 and on all threads where there are some.
    ///
    /// The same bits for every instruction set and number of threads: matrices are rounded to f32, and every sum runs over m = −l…l. A
    /// coefficient of degree l is off by at most (2l+4)·2⁻²⁴ of the sum of its terms' magnitudes.
    pub fn apply_many(&self, vectors: &[f32], rotated: &mut [f32]) {
        self.apply_many_with(Level::best(), vectors, rotated);
    }

    /// [`Rotation::apply_many`] by the instructions of `level`.
    pub fn apply_many_with(&self, level: Level, vectors: &[f32], rotated: &mut [f32]) {
        let count = self.order.count();
        assert_eq!(vectors.len(), rotated.len(), "as many vectors out as in");
        assert_eq!(vectors.len() % count, 0, "whole vectors of order² numbers");
        let bands = self.blocks();
        let rotate = |vectors: &[f32], rotated: &mut [f32]| {
            level.run(Many {
                order: self.order.get(),
                bands: &bands,
                vectors,
                rotated,
            });
        };
        #[cfg(feature = "bake")]
        {
            use rayon::prelude::*;
            vectors
                .par_chunks(CHUNK * count)
                .zip(rotated.par_chunks_mut(CHUNK * count))
                .for_each(|(vectors, rotated)| rotate(vectors, rotated));
        }
        #[cfg(not(feature = "bake"))]
        for (vectors, rotated) in vectors
            .chunks(CHUNK * count)
            .zip(rotated.chunks_mut(CHUNK * count))
        {
            rotate(vectors, rotated);
        }
    }

    /// The band matrices in f32: within each, [`ROWS`] rows at a time, and of those one column after the other.
    fn blocks(&self) -> Vec<f32> {
        let mut all = Vec::with_capacity(self.bands.len());
        for l in self.order.degrees() {
            let size = 2 * l + 1;
            for rows in self.band(l).chunks(ROWS * size) {
                for column in 0..size {
                    all.extend(rows.chunks(size).map(|row| row[column] as f32));
                }
            }
        }
        all
    }
}

struct Many<'a> {
    order: usize,
    /// [`Rotation::blocks`].
    bands: &'a [f32],
    vectors: &'a [f32],
    rotated: &'a mut [f32],
}

impl Kernel for Many<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let count = self.order * self.order;
        let group = L::COUNT * count;
        // `[coefficient][lane]`, before and after.
        let (mut before, mut after) = (vec![0.0; group], vec![0.0; group]);
        let mut padded = Vec::new();
        for (from, to) in self
            .vectors
            .chunks(group)
            .zip(self.rotated.chunks_mut(group))
        {
            let is_whole = from.len() == group;
            if !is_whole {
                padded = vec![0.0; group];
                padded[..from.len()].copy_from_slice(from);
            }
            let from = if is_whole { from } else { &padded };
            if count < L::COUNT {
                scatter(from, &mut before, count, L::COUNT);
            } else {
                let mut start = 0;
                while start < count {
                    let at = start.min(count - L::COUNT);
                    transpose::<L>(&from[at..], count, &mut before[at * L::COUNT..], L::COUNT);
                    start += L::COUNT;
                }
            }
            for l in 0..self.order {
                let range = l * l * L::COUNT..(l + 1) * (l + 1) * L::COUNT;
                let matrix = &self.bands[offset(l)..offset(l + 1)];
                band::<L>(matrix, &before[range.clone()], &mut after[range]);
            }
            if is_whole && count >= L::COUNT {
                let mut start = 0;
                while start < count {
                    let at = start.min(count - L::COUNT);
                    transpose::<L>(&after[at * L::COUNT..], L::COUNT, &mut to[at..], count);
                    start += L::COUNT;
                }
            } else {
                for (lane, to) in to.chunks_mut(count).enumerate() {
                    for (i, to) in to.iter_mut().enumerate() {
                        *to = after[i * L::COUNT + lane];
                    }
                }
            }
        }
    }
}

/// `[lane][count]` to `[count][lane]`.
#[inline(always)]
fn scatter(from: &[f32], to: &mut [f32], count: usize, lanes: usize) {
    for lane in 0..lanes {
        for i in 0..count {
            to[i * lanes + lane] = from[lane * count + i];
        }
    }
}

/// Multiplies one degree's `matrix`, [`Rotation::blocks`] of it, with its coefficients, `[2l+1][lane]`.
#[inline(always)]
fn band<L: Lanes>(matrix: &[f32], from: &[f32], to: &mut [f32]) {
    let size = from.len() / L::COUNT;
    let blocks = matrix.chunks(ROWS * size);
    for (block, to) in blocks.zip(to.chunks_mut(ROWS * L::COUNT)) {
        // 2l+1 is odd.
        match to.len() / L::COUNT {
            4 => rows::<L, 4>(block, from, to),
            3 => rows::<L, 3>(block, from, to),
            _ => rows::<L, 1>(block, from, to),
        }
    }
}

/// `N` rows of [`band`].
#[inline(always)]
fn rows<L: Lanes, const N: usize>(block: &[f32], from: &[f32], to: &mut [f32]) {
    let mut sums = [L::splat(0.0); N];
    for (column, from) in block.chunks_exact(N).zip(from.chunks_exact(L::COUNT)) {
        let c = L::load(from);
        for i in 0..N {
            sums[i] = sums[i] + L::splat(column[i]) * c;
        }
    }
    for (sum, to) in sums.iter().zip(to.chunks_exact_mut(L::COUNT)) {
        sum.store(to);
    }
}
