//! Devices without a window.

use relume::display::{Camera, Picture};
use relume_gpu::{Look, Offscreen, Renderer, Target};
use wgpu::TextureFormat;

/// A device of one back end.
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// What is drawn into for comparison: scene radiance, exact.
pub const RADIANCE: Target = Target {
    format: TextureFormat::Rgba32Float,
    samples: 1,
};

impl Gpu {
    /// A device with no more than WebGL2 has, or `None` after the line that counts the test as skipped.
    pub fn open(backends: wgpu::Backends, test: &str) -> Option<Self> {
        Self::with_limits(backends, test, |limits| limits)
    }

    /// [`Self::open`] with other limits.
    pub fn with_limits(
        backends: wgpu::Backends,
        test: &str,
        change: impl Fn(wgpu::Limits) -> wgpu::Limits,
    ) -> Option<Self> {
        let mut instance = wgpu::InstanceDescriptor::new_without_display_handle();
        instance.backends = backends;
        let instance = wgpu::Instance::new(instance);
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
        let Ok(adapter) = pollster::block_on(adapter) else {
            println!(
                "skipped: {test}: needs a {backends:?} adapter, such as those of mesa-vulkan-drivers and libgl1-mesa-dri"
            );
            return None;
        };
        let limits = wgpu::Limits::downlevel_webgl2_defaults();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            required_limits: change(limits.using_alignment(adapter.limits())),
            ..wgpu::DeviceDescriptor::default()
        }))
        .unwrap();
        Some(Self { device, queue })
    }

    /// A renderer of scene radiance.
    pub fn renderer(&self) -> Renderer {
        Renderer::new(&self.device, &self.queue, RADIANCE)
    }

    /// The picture, in scene radiance.
    pub fn draw(
        &self,
        renderer: &mut Renderer,
        camera: &Camera,
        look: &Look,
        (width, height): (u32, u32),
    ) -> Picture {
        let bytes = self.bytes(renderer, RADIANCE, camera, look, (width, height));
        let texels: &[[f32; 4]] = bytemuck::cast_slice(&bytes);
        Picture {
            width,
            height,
            pixels: texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        }
    }

    /// The bytes of a picture, rows from the top.
    pub fn bytes(
        &self,
        renderer: &mut Renderer,
        target: Target,
        camera: &Camera,
        look: &Look,
        (width, height): (u32, u32),
    ) -> Vec<u8> {
        let picture = Offscreen::new(&self.device, target, width, height);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = picture.pass(&mut encoder, wgpu::Color::BLACK, None);
        let look = Look {
            aspect: width as f32 / height as f32,
            ..*look
        };
        renderer.draw(&mut pass, camera, &look).unwrap();
        drop(pass);
        let (buffer, row) = picture.copy(&self.device, &mut encoder);
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .unwrap();
        let mapped = buffer.get_mapped_range(..).unwrap();
        let used = (width * target.format.block_copy_size(None).unwrap()) as usize;
        let rows = mapped.chunks_exact(row as usize);
        rows.flat_map(|row| &row[..used]).copied().collect()
    }
}

/// The same test on Vulkan and on OpenGL.
macro_rules! on_each_back_end {
    ($($name:ident)+) => {
        mod vulkan {
            $(#[test] fn $name() {
                let test = concat!(module_path!(), "::", stringify!($name));
                if let Some(gpu) = crate::device::Gpu::open(wgpu::Backends::VULKAN, test) { super::$name(&gpu); }
            })+
        }
        mod gl {
            $(#[test] fn $name() {
                let test = concat!(module_path!(), "::", stringify!($name));
                if let Some(gpu) = crate::device::Gpu::open(wgpu::Backends::GL, test) { super::$name(&gpu); }
            })+
        }
    };
}
pub(crate) use on_each_back_end;
