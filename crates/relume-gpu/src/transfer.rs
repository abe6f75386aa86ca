//! Transfer in textures, and the relight pass over them.

use relume::asset::Transfer;
use relume::basis::Order;
use relume::shade::{SideRadiance, TransferredRadiance};
use wgpu::{BindGroup, BindingResource, CommandEncoder, RenderPassTimestampWrites, Texture};

use crate::GpuError;
use crate::gpu::{Gpu, whole};
use crate::layouts::Page;
use crate::light::GpuLight;
use crate::matrices::GpuMatrices;
use crate::near::GpuNear;
use crate::pages::Pages;
use crate::pipelines::{RADIANCE_FORMAT, Relight, Shape};
use crate::sides::Layout;

/// The transfer of every side on the device, and the radiance it has been turned into.
pub struct GpuTransfer {
    pub pages: Pages,
    pub order: Order,
    pub shape: Shape,
    /// Number of vertices.
    pub vertices: usize,
    /// The vertex of each back side; these sides follow the fronts.
    pub backs: Vec<u32>,
    pub radiance: Texture,
    pub matrices: Option<GpuMatrices>,
    parts: Vec<Part>,
}

/// What the relight passes add up.
#[derive(Clone, Copy)]
pub struct Lights<'a> {
    pub light: &'a GpuLight,
    pub near: Option<&'a GpuNear>,
}

/// A page of transfer.
struct Part {
    rows: std::ops::Range<u32>,
    bind_group: BindGroup,
}

impl GpuTransfer {
    /// Uploads the vectors of every side.
    pub fn new(gpu: &Gpu, layouts: &Relight, transfer: &Transfer) -> Result<Self, GpuError> {
        let quads = transfer.order.count().div_ceil(4);
        let vertices = transfer.vertex_count();
        let back = transfer.back.as_ref();
        let backs = back.map_or(&[][..], |back| &back.vertices);
        // Light by vertex takes three channels, whatever the transfer has.
        let sides = vertices + backs.len();
        let pages = Pages::new(sides, 3 * quads, gpu.largest_texture() as u32)?;
        let layout = Layout {
            pages: &pages,
            channels: transfer.channels,
            quads,
            precision: transfer.precision,
        };
        let part = |rows| {
            let page = layout.page(gpu, "transfer", &rows, |side, channel| {
                vector(transfer, side, channel).iter().copied()
            });
            let uniform = Page {
                first_row: rows.start,
                width_log2: pages.width.ilog2(),
                unused: [0; 2],
            };
            let uniform = gpu.uniform("page", &uniform);
            let resources = [
                (0, uniform.as_entire_binding()),
                (1, BindingResource::TextureView(&whole(&page))),
            ];
            let bind_group = gpu.group("page", &layouts.page, resources);
            Part { rows, bind_group }
        };
        let parts = pages.pages().map(part).collect();
        let matrices = GpuMatrices::new(gpu, layouts, transfer, pages.width)?;
        let size = (pages.width, pages.height());
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let radiance = gpu.texture("radiance", size, RADIANCE_FORMAT, usage);
        Ok(Self {
            pages,
            order: transfer.order,
            shape: Shape {
                channels: transfer.channels,
                quads,
            },
            vertices,
            backs: backs.to_vec(),
            radiance,
            matrices,
            parts,
        })
    }

    /// The vertex of a side.
    pub fn vertex(&self, side: usize) -> usize {
        match side.checked_sub(self.vertices) {
            Some(back) => self.backs[back] as usize,
            None => side,
        }
    }

    /// Encodes the relight passes: the radiance of every side, and, where there are matrices, its transferred radiance.
    pub fn relight(
        &self,
        encoder: &mut CommandEncoder,
        layouts: &Relight,
        light: Lights,
        timestamps: Option<RenderPassTimestampWrites>,
    ) {
        let Some(matrices) = &self.matrices else {
            return self.relight_vectors(encoder, layouts, light, timestamps);
        };
        // Timed as one.
        let (mut begin, mut end) = (timestamps.clone(), timestamps);
        if let (Some(begin), Some(end)) = (&mut begin, &mut end) {
            (
                begin.end_of_pass_write_index,
                end.beginning_of_pass_write_index,
            ) = (None, None);
        }
        self.relight_vectors(encoder, layouts, light, begin);
        matrices.relight(encoder, layouts, light, end);
    }

    /// Writes the radiance of every side as it is, and, where it is given, its transferred radiance.
    pub fn write_radiance(
        &self,
        gpu: &Gpu,
        radiance: &SideRadiance,
        transferred: Option<&TransferredRadiance>,
    ) -> Result<(), GpuError> {
        let (given, expected) = match (transferred, &self.matrices) {
            (Some(transferred), Some(matrices)) => matrices.coefficients(transferred),
            (Some(transferred), None) => (transferred.front.len(), 0),
            (None, _) => (0, 0),
        };
        let sides = [
            ("radiances of vertices", radiance.front.len(), self.vertices),
            (
                "radiances of back sides",
                radiance.back.len(),
                self.backs.len(),
            ),
            ("coefficients of transferred radiance", given, expected),
        ];
        for (what, given, expected) in sides {
            if given != expected {
                return Err(GpuError::Mismatch {
                    what,
                    given,
                    expected,
                });
            }
        }
        let sides = radiance.front.iter().chain(&radiance.back);
        let mut texels: Vec<[f32; 4]> = sides.map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        let size = self.pages.width as usize * self.pages.height() as usize;
        texels.resize(size, [0.0; 4]);
        gpu.write_rows(&self.radiance, 0, bytemuck::cast_slice(&texels));
        if let Some((matrices, transferred)) = self.matrices.as_ref().zip(transferred) {
            matrices.write(gpu, transferred);
        }
        Ok(())
    }

    fn relight_vectors(
        &self,
        encoder: &mut CommandEncoder,
        layouts: &Relight,
        Lights { light, near }: Lights,
        timestamps: Option<RenderPassTimestampWrites>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("relight"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &whole(&self.radiance),
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
        pass.set_pipeline(near.and_then(GpuNear::pipeline).unwrap_or(&light.pipeline));
        for (i, part) in self.parts.iter().enumerate() {
            pass.set_bind_group(0, &part.bind_group, &[]);
            light.bind(&mut pass, layouts, i);
            if let Some(near) = near {
                near.bind(&mut pass, i);
            }
            let (top, rows) = (part.rows.start as f32, part.rows.len() as f32);
            pass.set_viewport(0.0, top, self.pages.width as f32, rows, 0.0, 1.0);
            pass.draw(0..3, 0..1);
        }
    }
}

/// The transfer vector of a side and channel.
fn vector(transfer: &Transfer, side: usize, channel: usize) -> &[f32] {
    match (&transfer.back, side.checked_sub(transfer.vertex_count())) {
        (Some(back), Some(i)) => {
            let first = i * transfer.stride() + channel * transfer.order.count();
            &back.coefficients[first..first + transfer.order.count()]
        }
        _ => transfer.vector(side, channel),
    }
}
