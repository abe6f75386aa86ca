//! A picture without a window.

use wgpu::{
    CommandEncoder, Device, RenderPass, Texture, TextureFormat, TextureUsages, TextureView,
};

use crate::gpu::whole;
use crate::{DEPTH_CLEAR, DEPTH_FORMAT, Target};

/// A colour texture that can be shown and read back, with the depth (and samples) that drawing to it takes.
pub struct Offscreen {
    color: Texture,
    resolved: TextureView,
    samples: Option<TextureView>,
    depth: TextureView,
}

impl Offscreen {
    /// A target of `width` × `height` pixels; sizes of 0 become 1.
    pub fn new(device: &Device, target: Target, width: u32, height: u32) -> Self {
        let largest = device.limits().max_texture_dimension_2d;
        let size = wgpu::Extent3d {
            width: width.clamp(1, largest),
            height: height.clamp(1, largest),
            depth_or_array_layers: 1,
        };
        let texture = |label, format: TextureFormat, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let (drawn, shown) = (
            TextureUsages::empty(),
            TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
        );
        let color = texture("picture", target.format, 1, shown);
        let samples = (target.samples > 1)
            .then(|| whole(&texture("samples", target.format, target.samples, drawn)));
        let depth = whole(&texture("depth", DEPTH_FORMAT, target.samples, drawn));
        Self {
            resolved: whole(&color),
            color,
            samples,
            depth,
        }
    }

    /// The picture, to be shown or read.
    pub fn view(&self) -> &TextureView {
        &self.resolved
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.color.width(), self.color.height())
    }

    /// Begins a render pass on a cleared picture.
    pub fn pass<'e>(
        &self,
        encoder: &'e mut CommandEncoder,
        clear: wgpu::Color,
        timestamps: Option<wgpu::RenderPassTimestampWrites>,
    ) -> RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("view"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.samples.as_ref().unwrap_or(&self.resolved),
                depth_slice: None,
                resolve_target: self.samples.as_ref().map(|_| &self.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(DEPTH_CLEAR),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: timestamps,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Encodes a copy of the picture to a buffer that can be mapped: rows of `bytes_per_row`, which is a multiple of 256.
    pub fn copy(&self, device: &Device, encoder: &mut CommandEncoder) -> (wgpu::Buffer, u32) {
        let texel = self.color.format().block_copy_size(None).unwrap_or(4);
        let row = (self.color.width() * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copy"),
            size: u64::from(row) * u64::from(self.color.height()),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            self.color.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            self.color.size(),
        );
        (buffer, row)
    }
}
