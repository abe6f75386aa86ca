//! Devices without a window.

use relume::display::Camera;
use relume_gpu::{Look, Offscreen, Renderer, Target};
use wgpu::TextureFormat;

/// A device of one back end.
pub struct Gpu {
    /// Whether it draws to floats. OpenGL does not say that it does.
    pub floats: bool,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// What is drawn into for comparison: scene radiance, exact.
pub const RADIANCE: Target = Target {
    format: TextureFormat::Rgba32Float,
    samples: 1,
};

/// What is drawn into where floats are not: codes, tone-mapped.
pub const CODES: Target = Target {
    format: TextureFormat::Rgba8Unorm,
    samples: 1,
};

/// A picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Drawn {
    Radiance(Vec<[f32; 3]>),
    Codes(Vec<[u8; 3]>),
}

impl Drawn {
    /// The pixels, by whatever measure.
    pub fn pixels(&self) -> Vec<[f32; 3]> {
        match self {
            Self::Radiance(pixels) => pixels.clone(),
            Self::Codes(pixels) => pixels.iter().map(|p| p.map(f32::from)).collect(),
        }
    }

    /// How many are not black.
    pub fn lit(&self) -> usize {
        self.pixels().iter().filter(|p| p[0] > 0.0).count()
    }
}

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
        let floats = adapter.get_texture_format_features(RADIANCE.format);
        let floats = floats
            .allowed_usages
            .contains(wgpu::TextureUsages::RENDER_ATTACHMENT);
        Some(Self {
            floats,
            device,
            queue,
        })
    }

    /// What pictures are compared in: radiance, where the device draws to floats.
    pub fn target(&self) -> Target {
        if self.floats { RADIANCE } else { CODES }
    }

    /// A renderer to that target.
    pub fn renderer(&self) -> Renderer {
        Renderer::new(&self.device, &self.queue, self.target())
    }

    /// The picture.
    pub fn draw(
        &self,
        renderer: &mut Renderer,
        camera: &Camera,
        look: &Look,
        size: (u32, u32),
    ) -> Drawn {
        let bytes = self.bytes(renderer, self.target(), camera, look, size);
        if self.floats {
            let texels: &[[f32; 4]] = bytemuck::cast_slice(&bytes);
            return Drawn::Radiance(texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect());
        }
        let texels = bytes.chunks_exact(4);
        Drawn::Codes(texels.map(|texel| [texel[0], texel[1], texel[2]]).collect())
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
