//! The vectors of sides in pages of texels.

use std::ops::Range;

use half::f16;
use relume::asset::Precision;
use wgpu::{Texture, TextureFormat, TextureUsages};

use crate::gpu::Gpu;
use crate::pages::Pages;

/// How the vectors of sides lie in a page: see relight.wgsl.
pub struct Layout<'a> {
    pub pages: &'a Pages,
    pub channels: usize,
    /// Four coefficients each.
    pub quads: usize,
    /// Halves where the numbers are halves.
    pub precision: Precision,
}

impl Layout<'_> {
    /// A page with the vectors of some rows of sides: `of(side, channel)` is the vector of one, filled up with zeros.
    pub fn page<V: IntoIterator<Item = f32>>(
        &self,
        gpu: &Gpu,
        label: &str,
        rows: &Range<u32>,
        of: impl Fn(usize, usize) -> V,
    ) -> Texture {
        let texels = self.channels * self.quads;
        let size = (self.pages.width, rows.len() as u32 * texels as u32);
        let format = match self.precision {
            Precision::F32 => TextureFormat::Rgba32Float,
            Precision::F16 => TextureFormat::Rgba16Float,
        };
        let page = gpu.texture(label, size, format, TextureUsages::empty());
        let width = self.pages.width as usize;
        let mut block = vec![[0.0_f32; 4]; width * texels];
        for row in rows.clone() {
            block.fill([0.0; 4]);
            for (x, side) in self.pages.sides_of(row).enumerate() {
                for channel in 0..self.channels {
                    let vector = of(side, channel).into_iter().take(4 * self.quads);
                    for (i, value) in vector.enumerate() {
                        let texel = channel * self.quads + i / 4;
                        block[4 * (x / 4 * texels + texel) + x % 4][i % 4] = value;
                    }
                }
            }
            let top = (row - rows.start) * texels as u32;
            match self.precision {
                Precision::F32 => gpu.write_rows(&page, top, bytemuck::cast_slice(&block)),
                Precision::F16 => {
                    let bits = |value: &f32| f16::from_f32(*value).to_bits();
                    let halves: Vec<u16> = block.as_flattened().iter().map(bits).collect();
                    gpu.write_rows(&page, top, bytemuck::cast_slice(&halves));
                }
            }
        }
        // What is written waits in memory until something is submitted.
        gpu.queue.submit([]);
        page
    }
}
