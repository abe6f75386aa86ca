//! Base colours on the device.

use glam::Vec3;
use relume::display::srgb_code;
use relume::scene::{AlphaMode, Material, Sampler, Texture, World, Wrap, srgb_to_linear};
use wgpu::{BindGroup, BindingResource, RenderPipeline, TextureView};

use crate::gpu::{Gpu, whole};
use crate::layouts;
use crate::pipelines::{Kind, ViewPass};

/// A material on the device.
pub struct GpuMaterial {
    pub pipeline: RenderPipeline,
    pub bind_group: BindGroup,
}

/// Every material of `world`; `backs` says whether any vertex has a back side.
pub fn upload(gpu: &Gpu, view: &mut ViewPass, world: &World, backs: bool) -> Vec<GpuMaterial> {
    let white = Texture {
        width: 1,
        height: 1,
        texels: vec![[255; 4]],
        sampler: Sampler::default(),
    };
    let mut views: Vec<TextureView> = world.textures.iter().map(|t| image(gpu, t)).collect();
    views.push(image(gpu, &white));
    let colored = world.colors.iter().any(|&color| color != Vec3::ONE)
        || world.alphas.iter().any(|&alpha| alpha != 1.0);
    let upload = |material: &Material| {
        let image = material.base_color_texture.unwrap_or(world.textures.len());
        let texture = world.textures.get(image).unwrap_or(&white);
        let kind = Kind {
            textured: material.base_color_texture.is_some(),
            masked: matches!(material.alpha, AlphaMode::Mask(_)),
            two_sided: material.double_sided && backs,
            colored,
        };
        GpuMaterial {
            pipeline: view.surface(&gpu.device, kind),
            bind_group: bind_group(gpu, view, material, &views[image], texture.sampler),
        }
    };
    world.materials.iter().map(upload).collect()
}

fn bind_group(
    gpu: &Gpu,
    layouts: &ViewPass,
    material: &Material,
    image: &TextureView,
    sampler: Sampler,
) -> BindGroup {
    let factors = layouts::Material {
        base_color: material.base_color,
        cutoff: match material.alpha {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask(cutoff) => cutoff,
        },
        spare: 0,
        unused: [0; 2],
    };
    let factors = gpu.uniform("material", &factors);
    let sampler = gpu.device.create_sampler(&sampling(sampler));
    let resources = [
        (0, factors.as_entire_binding()),
        (1, BindingResource::TextureView(image)),
        (2, BindingResource::Sampler(&sampler)),
    ];
    gpu.group("material", &layouts.material, resources)
}

fn sampling(sampler: Sampler) -> wgpu::SamplerDescriptor<'static> {
    let address = |wrap| match wrap {
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
    };
    let near = if sampler.nearest {
        wgpu::FilterMode::Nearest
    } else {
        wgpu::FilterMode::Linear
    };
    wgpu::SamplerDescriptor {
        label: Some("base color"),
        address_mode_u: address(sampler.wrap_u),
        address_mode_v: address(sampler.wrap_v),
        mag_filter: near,
        min_filter: near,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    }
}

/// A level of a texture: sRGB colour and linear alpha.
struct Level {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

impl Level {
    /// Half the size: each texel the mean of four, of light rather than of codes.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let texel = |x: u32, y: u32| {
            let at = |dx: u32, dy: u32| {
                let x = (2 * x + dx).min(self.width - 1);
                let y = (2 * y + dy).min(self.height - 1);
                self.texels[y as usize * self.width as usize + x as usize]
            };
            let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            std::array::from_fn(|channel| {
                let codes = four.map(|texel| texel[channel]);
                if channel == 3 {
                    let sum: u32 = codes.iter().map(|&a| u32::from(a)).sum();
                    return ((sum + 2) / 4) as u8;
                }
                let light = codes.map(|code| f64::from(srgb_to_linear(code)));
                srgb_code(light.iter().sum::<f64>() / 4.0)
            })
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self {
            width,
            height,
            texels: places.map(|(x, y)| texel(x, y)).collect(),
        }
    }
}

/// The texture with all its smaller levels; one too large for the device starts at the first that fits.
fn image(gpu: &Gpu, texture: &Texture) -> TextureView {
    let mut level = Level {
        width: texture.width,
        height: texture.height,
        texels: texture.texels.clone(),
    };
    while level.width.max(level.height) as usize > gpu.largest_texture() {
        level = level.halved();
    }
    let levels = level.width.max(level.height).ilog2() + 1;
    let image = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("base color"),
        size: wgpu::Extent3d {
            width: level.width,
            height: level.height,
            depth_or_array_layers: 1,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for i in 0..levels {
        gpu.write_level(&image, (i, 0), level.width, level.texels.as_flattened());
        level = level.halved();
    }
    whole(&image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_is_the_mean_of_light_and_not_of_codes() {
        let level = Level {
            width: 3,
            height: 2,
            texels: vec![[0; 4], [255; 4], [9; 4], [255; 4], [0; 4], [9; 4]],
        };
        let half = level.halved();
        assert_eq!((half.width, half.height), (1, 1));
        // Half of the light is code 188, half of alpha 128.
        assert_eq!(half.texels, [[188, 188, 188, 128]]);
    }
}
