//! What stands behind the surfaces, as a lat-long picture.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use half::f16;
use relume::basis::Order;
use relume::light::{Environment, Layout};
use wgpu::{BindGroup, BindingResource};

use crate::gpu::{Gpu, whole};
use crate::pipelines::ViewPass;

/// Rows of the picture of an environment that is no lat-long map.
const ROWS: usize = 512;
/// The most rows of a picture: more do not show behind a scene.
const MOST_ROWS: usize = 2048;

/// A background on the device.
pub struct Background {
    pub bind_group: BindGroup,
    /// How it was turned when it was uploaded.
    pub world_from_light: DMat3,
}

impl Background {
    /// Uploads an environment. Lat-long maps keep their texels; everything else is sampled. Turns are kept apart, so that turning
    /// uploads nothing.
    pub fn new(gpu: &Gpu, layouts: &ViewPass, environment: &Environment) -> Self {
        let (inner, world_from_light) = match environment {
            Environment::Rotated(rotated) => (rotated.inner(), rotated.world_from_light()),
            other => (other, DMat3::IDENTITY),
        };
        let picture = picture(inner, MOST_ROWS.min(gpu.largest_texture() / 2 - 2));
        let texels = beyond_the_poles(&picture);
        let size = (picture.width as u32, picture.height as u32 + 2);
        let format = wgpu::TextureFormat::Rgba16Float;
        let image = gpu.texture("background", size, format, wgpu::TextureUsages::empty());
        gpu.write_rows(&image, 0, bytemuck::cast_slice(&texels));
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("background"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let resources = [
            (1, BindingResource::TextureView(&whole(&image))),
            (2, BindingResource::Sampler(&sampler)),
        ];
        let bind_group = gpu.group("background", &layouts.background, resources);
        Self {
            bind_group,
            world_from_light,
        }
    }
}

/// Radiance by direction, lat-long, rows from the top.
struct Picture {
    width: usize,
    height: usize,
    /// Red, green, blue and 1, as halves.
    texels: Vec<[u16; 4]>,
}

/// The rows of a picture, with one before and one after: over a pole one comes to the row one left, half way around.
fn beyond_the_poles(picture: &Picture) -> Vec<[u16; 4]> {
    let turned = |row: &[[u16; 4]]| {
        let mut row = row.to_vec();
        row.rotate_left(picture.width / 2);
        row
    };
    let (first, last) = (
        &picture.texels[..picture.width],
        &picture.texels[picture.texels.len() - picture.width..],
    );
    [turned(first), picture.texels.clone(), turned(last)].concat()
}

fn picture(environment: &Environment, most_rows: usize) -> Picture {
    let texel = |rgb: [f32; 3]| {
        let [r, g, b] = rgb.map(|x| f16::from_f32(x.clamp(-65504.0, 65504.0)).to_bits());
        [r, g, b, f16::ONE.to_bits()]
    };
    if let Environment::Map(map) = environment
        && map.layout() == Layout::LatLong
        && map.image().height() <= most_rows
        && map.image().width() <= 2 * most_rows
    {
        return Picture {
            width: map.image().width(),
            height: map.image().height(),
            texels: map.image().pixels().iter().map(|&rgb| texel(rgb)).collect(),
        };
    }
    let rows = match environment {
        Environment::Constant(_) => 1,
        // A band of degree l has waves of 180°/l.
        Environment::Sh(light) => (16 * light.order().get()).min(16 * Order::MAX),
        Environment::Map(map) => map.image().height().max(ROWS),
        _ => ROWS,
    };
    let height = rows.min(most_rows);
    let width = 2 * height;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let direction = |(x, y): (usize, usize)| {
        let longitude = PI * (1.0 - 2.0 * (x as f64 + 0.5) / width as f64);
        let latitude = PI * (0.5 - (y as f64 + 0.5) / height as f64);
        let (across, up) = (libm::cos(latitude), libm::sin(latitude));
        DVec3::new(
            across * libm::sin(longitude),
            up,
            across * libm::cos(longitude),
        )
    };
    let radiance = |place| environment.radiance(direction(place).as_vec3());
    Picture {
        width,
        height,
        texels: places.map(radiance).map(texel).collect(),
    }
}
