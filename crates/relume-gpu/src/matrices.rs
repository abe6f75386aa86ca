//! Transfer matrices in textures, and the relight pass over them.

use std::ops::Range;

use half::f16;
use relume::asset::{Precision, Transfer};
use relume::basis::Order;
use relume::light::VertexLight;
use relume::shade::TransferredRadiance;
use wgpu::{
    BindGroup, BindingResource, CommandEncoder, RenderPassTimestampWrites, Texture, TextureFormat,
    TextureUsages, TextureView,
};

use crate::GpuError;
use crate::blocks::{Blocks, Size, sequence};
use crate::gpu::{Gpu, whole};
use crate::layouts::MatrixPage;
use crate::pipelines::{Lit, RADIANCE_FORMAT, Relight};
use crate::transfer::Lights;

/// The matrices of every side on the device, and the transferred radiance they have been turned into.
pub struct GpuMatrices {
    /// Of transferred radiance.
    pub order: Order,
    pub blocks: Blocks,
    pub radiance: Texture,
    view: TextureView,
    parts: Vec<Part>,
}

/// A page of matrices.
struct Part {
    rows: Range<u32>,
    bind_group: BindGroup,
}

impl GpuMatrices {
    /// Uploads the matrices of every side; `None` for a transfer without. `objects_width` is the width of [`crate::light::GpuLight`]'s texture of objects.
    pub fn new(
        gpu: &Gpu,
        layouts: &Relight,
        transfer: &Transfer,
        objects_width: u32,
    ) -> Result<Option<Self>, GpuError> {
        let Some(matrices) = &transfer.matrices else {
            return Ok(None);
        };
        let size = Size {
            channels: transfer.channels,
            columns: transfer.order.count(),
            quads: matrices.order.count().div_ceil(4),
        };
        let backs = transfer.back.as_ref().map_or(0, |back| back.vertices.len());
        let sides = transfer.vertex_count() + backs;
        let blocks = Blocks::new(sides, size, gpu.largest_texture() as u32)?;
        let rows = sequence(matrices.order);
        let part = |range: Range<u32>| {
            let texels = page(transfer, &blocks, &rows, &range);
            let extent = blocks.page_extent(&range, size.matrices());
            let page = write(gpu, "matrices", extent, &texels, transfer.precision);
            let uniform = MatrixPage {
                first_row: range.start,
                across: blocks.across as u32,
                width_log2: blocks.page_width.ilog2(),
                objects_log2: objects_width.ilog2(),
            };
            let uniform = gpu.uniform("matrix page", &uniform);
            let resources = [
                (0, uniform.as_entire_binding()),
                (1, BindingResource::TextureView(&whole(&page))),
            ];
            Part {
                bind_group: gpu.group("matrix page", &layouts.page, resources),
                rows: range,
            }
        };
        let parts = blocks.pages().map(part).collect();
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let radiance = gpu.texture(
            "transferred radiance",
            blocks.extent(),
            RADIANCE_FORMAT,
            usage,
        );
        Ok(Some(Self {
            order: matrices.order,
            view: whole(&radiance),
            blocks,
            radiance,
            parts,
        }))
    }

    /// Encodes the relight pass: the transferred radiance of every side.
    pub fn relight(
        &self,
        encoder: &mut CommandEncoder,
        layouts: &Relight,
        Lights { light, near }: Lights,
        timestamps: Option<RenderPassTimestampWrites>,
    ) {
        let near_pipeline = near.and_then(|near| near.matrices.as_ref());
        let Some(pipeline) = near_pipeline.or(light.matrices.as_ref()) else {
            return;
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("relight matrices"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: timestamps,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(pipeline);
        let width = self.blocks.extent().0 as f32;
        for (i, part) in self.parts.iter().enumerate() {
            pass.set_bind_group(0, &part.bind_group, &[]);
            light.bind_matrices(&mut pass, layouts, i);
            if let Some(near) = near {
                near.bind_matrices(&mut pass, i);
            }
            let (top, rows) = (part.rows.start as f32, part.rows.len() as f32);
            pass.set_viewport(0.0, top, width, rows, 0.0, 1.0);
            pass.draw(0..3, 0..1);
        }
    }

    /// How many coefficients there are, of fronts and backs, and how many there should be.
    pub fn coefficients(&self, transferred: &TransferredRadiance) -> (usize, usize) {
        let given = transferred.front.len() + transferred.back.len();
        (given, self.blocks.sides * 3 * self.order.count())
    }

    /// Writes the transferred radiance of every side as it is.
    pub fn write(&self, gpu: &Gpu, transferred: &TransferredRadiance) {
        let places = sequence(self.order);
        let (width, height) = self.blocks.extent();
        let mut texels = vec![[0.0_f32; 4]; width as usize * height as usize];
        let texels_of_side = texels.chunks_exact_mut(self.blocks.size.radiance());
        let sides = [&transferred.front, &transferred.back];
        let sides = sides.map(|sides| sides.chunks_exact(3 * self.order.count()));
        for (texels, side) in texels_of_side.zip(sides.into_iter().flatten()) {
            let quads = texels.chunks_exact_mut(3).zip(places.chunks_exact(4));
            for (channels, places) in quads {
                for (texel, side) in channels
                    .iter_mut()
                    .zip(side.chunks_exact(self.order.count()))
                {
                    *texel = std::array::from_fn(|lane| places[lane].map_or(0.0, |i| side[i]));
                }
            }
        }
        gpu.write_rows(&self.radiance, 0, bytemuck::cast_slice(&texels));
    }

    /// A page of light for each page of matrices; `vertex` is that of a side.
    pub fn vertex_light(
        &self,
        gpu: &Gpu,
        layouts: &Relight,
        light: &VertexLight,
        vertex: impl Fn(usize) -> usize,
    ) -> Vec<BindGroup> {
        let quads = self.blocks.size.columns.div_ceil(4);
        let group = |rows: Range<u32>| {
            let extent = self.blocks.page_extent(&rows, 3 * quads);
            let mut texels = vec![[0.0; 4]; extent.0 as usize * extent.1 as usize];
            let sides = self.blocks.sides_of(&rows);
            for (side, planes) in sides.zip(texels.chunks_exact_mut(3 * quads)) {
                let here = light.coefficients(vertex(side));
                write_planes(here, self.blocks.size.columns, planes);
            }
            let page = write(gpu, "light of matrices", extent, &texels, Precision::F32);
            let resources = [(1, BindingResource::TextureView(&whole(&page)))];
            gpu.group("light by vertex", layouts.light(Lit::Vertices), resources)
        };
        self.blocks.pages().map(group).collect()
    }
}

/// Red, green and blue of a light's first `count` coefficients in quads, one after another.
fn write_planes(light: &[[f32; 3]], count: usize, planes: &mut [[f32; 4]]) {
    let stride = planes.len() / 3;
    for (channel, plane) in planes.chunks_exact_mut(stride).enumerate() {
        let values = plane.as_flattened_mut().iter_mut();
        for (value, rgb) in values.zip(light.iter().take(count)) {
            *value = rgb[channel];
        }
    }
}

/// The texels of some rows of sides: see matrices.wgsl.
fn page(
    transfer: &Transfer,
    blocks: &Blocks,
    rows: &[Option<usize>],
    range: &Range<u32>,
) -> Vec<[f32; 4]> {
    let Size {
        channels, columns, ..
    } = blocks.size;
    let (width, height) = blocks.page_extent(range, blocks.size.matrices());
    let mut texels = vec![[0.0; 4]; width as usize * height as usize + 4 * columns];
    let mut block = 0;
    for side in blocks.sides_of(range) {
        let matrices = matrices(transfer, side);
        for quad in rows.chunks_exact(4) {
            for matrix in matrices.chunks_exact(matrices.len() / channels) {
                let first = block / 4 * 4 * columns + block % 4;
                for (lane, row) in quad.iter().enumerate() {
                    let Some(row) = row else { continue };
                    let row = &matrix[row * columns..][..columns];
                    for (column, &value) in row.iter().enumerate() {
                        texels[first + 4 * column][lane] = value;
                    }
                }
                block += 1;
            }
        }
    }
    texels.truncate(width as usize * height as usize);
    texels
}

/// The matrices of a side, channel after channel.
fn matrices(transfer: &Transfer, side: usize) -> &[f32] {
    let stride = transfer.matrix_stride();
    let all = transfer.matrices.as_ref();
    all.map_or(&[], |all| match side.checked_sub(transfer.vertex_count()) {
        Some(back) => &all.back[back * stride..][..stride],
        None => &all.coefficients[side * stride..][..stride],
    })
}

/// A texture of numbers, halves where they are.
fn write(
    gpu: &Gpu,
    label: &str,
    extent: (u32, u32),
    texels: &[[f32; 4]],
    precision: Precision,
) -> Texture {
    let usage = TextureUsages::empty();
    let texture = match precision {
        Precision::F32 => {
            let texture = gpu.texture(label, extent, TextureFormat::Rgba32Float, usage);
            gpu.write_rows(&texture, 0, bytemuck::cast_slice(texels));
            texture
        }
        Precision::F16 => {
            let texture = gpu.texture(label, extent, TextureFormat::Rgba16Float, usage);
            let bits = |value: &f32| f16::from_f32(*value).to_bits();
            let halves: Vec<u16> = texels.as_flattened().iter().map(bits).collect();
            gpu.write_rows(&texture, 0, bytemuck::cast_slice(&halves));
            texture
        }
    };
    // What is written waits in memory until something is submitted.
    gpu.queue.submit([]);
    texture
}

#[cfg(test)]
#[path = "matrices_tests.rs"]
mod tests;
