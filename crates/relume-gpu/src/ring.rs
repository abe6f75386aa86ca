//! A uniform with several values in flight.

use wgpu::{BindGroup, BindGroupLayout, BindingResource, Buffer, BufferUsages};

use crate::gpu::Gpu;

/// Values that may be written between two submissions to the queue: the queue writes them all before it runs what was submitted.
const VALUES: u32 = 16;
/// Offsets of uniforms are multiples of this on every device.
const ALIGNMENT: u32 = 256;

/// One buffer for many values of a uniform, so that none has to be made for each frame.
pub struct Ring {
    buffer: Buffer,
    pub bind_group: BindGroup,
    stride: u32,
    next: u32,
}

impl Ring {
    /// For values of up to `size` bytes, bound to number 0 of `layout` with a dynamic offset.
    pub fn new(gpu: &Gpu, label: &str, layout: &BindGroupLayout, size: usize) -> Self {
        let stride = (size as u32).next_multiple_of(ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: u64::from(VALUES * stride),
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let one = BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &buffer,
            offset: 0,
            size: wgpu::BufferSize::new(size as u64),
        });
        Self {
            bind_group: gpu.group(label, layout, [(0, one)]),
            buffer,
            stride,
            next: 0,
        }
    }

    /// Writes a value, or the beginning of one, and says at which offset it is bound.
    pub fn write(&mut self, gpu: &Gpu, bytes: &[u8]) -> u32 {
        let offset = self.next * self.stride;
        self.next = (self.next + 1) % VALUES;
        gpu.queue.write_buffer(&self.buffer, offset.into(), bytes);
        offset
    }
}
