//! The sums of a bounce, a vector of light coefficients at a time.
//!
//! Rows of light coefficients are padded to whole vectors of any instruction set, so that each sum is taken in the same order whatever the set.

use crate::simd::{Kernel, Lanes};

/// A ray that met a corner: which of the rays that met something, and its barycentric weight.
#[derive(Clone, Copy)]
pub struct Touch {
    pub slot: u32,
    pub weight: f32,
}

/// `g_j += weight · Σ_i o_i T_ij` by channel, for all rays that touch one corner: what its matrix sends along each.
pub struct Emit<'a> {
    pub touches: &'a [Touch],
    /// `[slots][3][m²]`.
    pub o: &'a [f32],
    /// The corner's matrix, `[channels][m²][stride]`.
    pub matrix: &'a [f32],
    pub channels: usize,
    /// m².
    pub rows: usize,
    /// n², padded.
    pub stride: usize,
    /// `[slots][3][stride]`.
    pub sent: &'a mut [f32],
}

impl Kernel for Emit<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for touch in self.touches {
            let slot = touch.slot as usize;
            for channel in 0..3 {
                let o = &self.o[(3 * slot + channel) * self.rows..][..self.rows];
                let matrix = channel % self.channels * self.rows * self.stride;
                let matrix = &self.matrix[matrix..][..self.rows * self.stride];
                let sent = &mut self.sent[(3 * slot + channel) * self.stride..][..self.stride];
                // Two vectors at a time stay in registers.
                let mut at = 0;
                while at < self.stride {
                    let two = at + L::COUNT < self.stride;
                    let (mut first, mut second) = (L::splat(0.0), L::splat(0.0));
                    for (o, row) in o.iter().zip(matrix.chunks_exact(self.stride)) {
                        let o = L::splat(*o);
                        first = first + L::load(&row[at..]) * o;
                        if two {
                            second = second + L::load(&row[at + L::COUNT..]) * o;
                        }
                    }
                    let weight = L::splat(touch.weight);
                    let sum = L::load(&sent[at..]) + first * weight;
                    sum.store(&mut sent[at..]);
                    if two {
                        let sum = L::load(&sent[at + L::COUNT..]) + second * weight;
                        sum.store(&mut sent[at + L::COUNT..]);
                    }
                    at += 2 * L::COUNT;
                }
            }
        }
    }
}

/// `S_ij += Y_i(ω) g_j` by channel, over some rays.
pub struct Collect<'a> {
    /// By ray: its slot, and where its basis functions begin.
    pub rays: &'a [(u32, usize)],
    pub basis: &'a [f32],
    /// `[slots][3][stride]`.
    pub sent: &'a [f32],
    /// m².
    pub rows: usize,
    pub stride: usize,
    /// `[3][m²][stride]`.
    pub sums: &'a mut [f32],
}

impl Kernel for Collect<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.sums.fill(0.0);
        for &(slot, first) in self.rays {
            let basis = &self.basis[first..][..self.rows];
            let sent = &self.sent[3 * slot as usize * self.stride..][..3 * self.stride];
            for (sent, sums) in sent
                .chunks_exact(self.stride)
                .zip(self.sums.chunks_exact_mut(self.rows * self.stride))
            {
                let mut at = 0;
                while at < self.stride {
                    let g = L::load(&sent[at..]);
                    for (y, sums) in basis.iter().zip(sums.chunks_exact_mut(self.stride)) {
                        let sum = L::load(&sums[at..]) + g * L::splat(*y);
                        sum.store(&mut sums[at..]);
                    }
                    at += L::COUNT;
                }
            }
        }
    }
}
