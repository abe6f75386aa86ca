//! A device and its queue, and what is asked of them everywhere.

use bytemuck::Pod;
use wgpu::util::DeviceExt;
use wgpu::{
    BindGroup, BindGroupEntry, BindGroupLayout, BindingResource, Buffer, BufferUsages, Device,
    Extent3d, Queue, Texture, TextureFormat, TextureUsages, TextureView, TextureViewDescriptor,
};

#[cfg(not(target_arch = "wasm32"))]
use crate::GpuError;

/// The application's device and queue.
#[derive(Clone)]
pub struct Gpu {
    pub device: Device,
    pub queue: Queue,
}

impl Gpu {
    /// Texels along the side of the largest texture.
    pub fn largest_texture(&self) -> usize {
        self.device.limits().max_texture_dimension_2d as usize
    }

    /// A texture without mip levels that shaders read and the host writes.
    pub fn texture(
        &self,
        label: &str,
        (width, height): (u32, u32),
        format: TextureFormat,
        usage: TextureUsages,
    ) -> Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        })
    }

    /// Writes whole rows of a texture from row `top` on.
    pub fn write_rows(&self, texture: &Texture, top: u32, bytes: &[u8]) {
        self.write_level(texture, (0, top), texture.width(), bytes);
    }

    /// Writes whole rows of a mip level, which is `width` texels wide, from row `top` on.
    pub fn write_level(
        &self,
        texture: &Texture,
        (level, top): (u32, u32),
        width: u32,
        bytes: &[u8],
    ) {
        let row = width * texture.format().block_copy_size(None).unwrap_or(4);
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: level,
                origin: wgpu::Origin3d { x: 0, y: top, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
            Extent3d {
                width,
                height: (bytes.len() / row as usize) as u32,
                depth_or_array_layers: 1,
            },
        );
    }

    /// The first rows of a texture of the bits of floats, waited for.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn read_rows(&self, texture: &Texture, rows: u32) -> Result<Vec<[f32; 4]>, GpuError> {
        if rows == 0 {
            return Ok(Vec::new());
        }
        let used = 16 * texture.width();
        let stride = used.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read"),
            size: u64::from(stride * rows),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let to = wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(stride),
                rows_per_image: None,
            },
        };
        let size = Extent3d {
            height: rows,
            ..texture.size()
        };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        polled.map_err(|_| GpuError::Lost)?;
        let mapped = buffer.get_mapped_range(..).map_err(|_| GpuError::Lost)?;
        let rows = mapped.chunks_exact(stride as usize);
        Ok(rows
            .flat_map(|row| bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&row[..used as usize]))
            .collect())
    }

    /// A texture array of half floats, to be sampled: width, height and layers.
    pub fn array(&self, label: &str, size: [usize; 3], texels: &[[u16; 4]]) -> TextureView {
        let [width, height, depth_or_array_layers] = size.map(|side| side as u32);
        let size = Extent3d {
            width,
            height,
            depth_or_array_layers,
        };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Rgba16Float,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        self.queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(8 * width),
                rows_per_image: Some(height),
            },
            size,
        );
        texture.create_view(&TextureViewDescriptor {
            // One layer is an array, too.
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..TextureViewDescriptor::default()
        })
    }

    /// A uniform.
    pub fn uniform(&self, label: &str, value: &impl Pod) -> Buffer {
        self.uniform_of(label, bytemuck::bytes_of(value))
    }

    /// A uniform of so many bytes.
    pub fn uniform_of(&self, label: &str, bytes: &[u8]) -> Buffer {
        self.device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents: bytes,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            })
    }

    /// A bind group of resources, each with its binding.
    pub fn group<'a>(
        &self,
        label: &str,
        layout: &BindGroupLayout,
        resources: impl IntoIterator<Item = (u32, BindingResource<'a>)>,
    ) -> BindGroup {
        let entry = |(binding, resource)| BindGroupEntry { binding, resource };
        let entries: Vec<BindGroupEntry> = resources.into_iter().map(entry).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout,
            entries: &entries,
        })
    }
}

/// All of a texture.
pub fn whole(texture: &Texture) -> TextureView {
    texture.create_view(&TextureViewDescriptor::default())
}
