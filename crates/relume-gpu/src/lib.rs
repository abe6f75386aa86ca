//! Relights baked assets on the GPU, with wgpu: Vulkan, Metal, DX12, OpenGL, WebGPU and WebGL2.
//!
//! ```text
//! Transfer ──upload──▶ pages of float texels ┐
//! IncidentLight ──set_light──▶ light ────────┼─ relight pass ──▶ radiance of each side ─┐
//! Placed ──stage_emitters──▶ faces, light ───┘                                          │
//! World ──upload──▶ vertices, triangles, materials ─────────────────────────────────────┴─ view pass ──▶ picture
//! ```
//!
//! The relight pass runs when the light changes and writes one texel per side of a surface; the view pass multiplies by albedo and draws. An asset
//! with transfer matrices is glossy: its relight pass writes the coefficients of transferred radiance, and the view pass interpolates them and
//! reflects them at every pixel, by the material, its maps and the view there. There are no storage buffers and no compute: one data path for every back end. No window, no user interface, no globals: an application hands in
//! its device, its queue and its render pass.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let (device, queue): (wgpu::Device, wgpu::Queue) = unimplemented!();
//! use relume::{asset, display::Camera, light, scene::World};
//! use relume_gpu::{Look, Offscreen, Renderer, Target};
//!
//! let asset = asset::read("baked.glb".as_ref())?;
//! let world = World::new(&asset.scene);
//! let sky = light::load(&"sky:30,3".parse()?, &light::LightOptions::default())?.0;
//!
//! let target = Target { format: wgpu::TextureFormat::Rgba8Unorm, samples: 4 };
//! let mut renderer = Renderer::new(&device, &queue, target);
//! renderer.upload(&world, &asset.transfer)?;
//! renderer.set_background(&sky);
//! renderer.set_light(&light::IncidentLight::Distant(sky.project(asset.transfer.order)))?;
//!
//! let picture = Offscreen::new(&device, target, 960, 540);
//! let mut encoder = device.create_command_encoder(&Default::default());
//! let mut pass = picture.pass(&mut encoder, wgpu::Color::BLACK, None);
//! renderer.draw(&mut pass, &Camera::framing(&world, 16.0 / 9.0), &Look::default())?;
//! drop(pass);
//! queue.submit([encoder.finish()]);
//! # Ok(()) }
//! ```
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")
)]

mod background;
mod blocks;
mod cube;
mod cube_shapes;
mod error;
mod glossy;
mod gpu;
mod images;
mod lamps;
mod layouts;
mod light;
mod lobes;
mod look;
mod material;
mod matrices;
mod mesh;
mod near;
mod near_source;
mod offscreen;
mod order;
mod pages;
mod pipeline;
mod pipelines;
mod renderer;
mod ring;
mod sides;
mod tiles;
mod transfer;

pub use cube::CubeSampler;
pub use error::GpuError;
pub use look::{Look, Surface};
pub use material::MaterialEdit;
pub use offscreen::Offscreen;
pub use renderer::Renderer;

/// Depth of every pass that is drawn into.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What depth is cleared with: it is reversed, 0 is infinitely far.
pub const DEPTH_CLEAR: f32 = 0.0;

/// What is drawn into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Of the colour attachment. sRGB and other 8-bit formats get the tone-mapped picture, float formats scene radiance.
    pub format: wgpu::TextureFormat,
    /// Samples per pixel of both attachments: 1, or what the device allows.
    pub samples: u32,
}

impl From<wgpu::TextureFormat> for Target {
    /// One sample per pixel.
    fn from(format: wgpu::TextureFormat) -> Self {
        Self { format, samples: 1 }
    }
}
