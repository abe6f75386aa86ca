//! Textures of materials on the device.

use relume::display::srgb_code;
use relume::scene::{Material, Sampler, Texture, World, Wrap, srgb_to_linear};
use wgpu::{BindGroup, BindGroupLayout, BindingResource, Buffer, TextureView};

use crate::gpu::{Gpu, whole};

/// The textures of a world that its materials use.
pub struct Images<'a> {
    textures: &'a [Texture],
    /// Of colours, by texture.
    colors: Vec<Option<TextureView>>,
    /// Of data.
    data: Vec<Option<TextureView>>,
    /// In the place of those that are not there.
    white: TextureView,
}

impl<'a> Images<'a> {
    /// Uploads those of base colours, and, where surfaces are `glossy`, those of roughness, metalness and normals.
    pub fn new(gpu: &Gpu, world: &'a World, glossy: bool) -> Self {
        let white = Texture {
            width: 1,
            height: 1,
            texels: vec![[255; 4]],
            sampler: Sampler::default(),
        };
        let used = |which: fn(&Material) -> [Option<usize>; 2], kind| {
            let mut views = vec![None; world.textures.len()];
            for i in world.materials.iter().flat_map(which).flatten() {
                if views[i].is_none() {
                    views[i] = Some(image(gpu, &world.textures[i], kind));
                }
            }
            views
        };
        let none: fn(&Material) -> [Option<usize>; 2] = |_| [None; 2];
        let data = if glossy { data_textures } else { none };
        Self {
            textures: &world.textures,
            colors: used(|m| [m.base_color_texture, None], Texels::Color),
            data: used(data, Texels::Data),
            white: image(gpu, &white, Texels::Color),
        }
    }

    /// Factors and base colour.
    pub fn group(
        &self,
        gpu: &Gpu,
        layout: &BindGroupLayout,
        factors: &Buffer,
        material: &Material,
    ) -> BindGroup {
        let (image, sampler) = self.map(gpu, &self.colors, material.base_color_texture);
        let resources = [
            (0, factors.as_entire_binding()),
            (1, BindingResource::TextureView(image)),
            (2, BindingResource::Sampler(&sampler)),
        ];
        gpu.group("material", layout, resources)
    }

    /// Factors, base colour, roughness and metalness, and normals.
    pub fn glossy_group(
        &self,
        gpu: &Gpu,
        layout: &BindGroupLayout,
        factors: &Buffer,
        material: &Material,
    ) -> BindGroup {
        let [finish, normals] = data_textures(material);
        let color = self.map(gpu, &self.colors, material.base_color_texture);
        let finish = self.map(gpu, &self.data, finish);
        let normals = self.map(gpu, &self.data, normals);
        let resources = [
            (0, factors.as_entire_binding()),
            (1, BindingResource::TextureView(color.0)),
            (2, BindingResource::Sampler(&color.1)),
            (3, BindingResource::TextureView(finish.0)),
            (4, BindingResource::Sampler(&finish.1)),
            (5, BindingResource::TextureView(normals.0)),
            (6, BindingResource::Sampler(&normals.1)),
        ];
        gpu.group("glossy material", layout, resources)
    }

    fn map<'b>(
        &'b self,
        gpu: &Gpu,
        views: &'b [Option<TextureView>],
        texture: Option<usize>,
    ) -> (&'b TextureView, wgpu::Sampler) {
        let view = texture.and_then(|i| views.get(i)?.as_ref());
        let sampler = texture.map_or_else(Sampler::default, |i| self.textures[i].sampler);
        let sampler = gpu.device.create_sampler(&sampling(sampler));
        (view.unwrap_or(&self.white), sampler)
    }
}

/// Roughness and metalness, and normals.
fn data_textures(material: &Material) -> [Option<usize>; 2] {
    let normals = material.normal_texture.map(|map| map.texture);
    [material.metallic_roughness_texture, normals]
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
        label: Some("material"),
        address_mode_u: address(sampler.wrap_u),
        address_mode_v: address(sampler.wrap_v),
        mag_filter: near,
        min_filter: near,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    }
}

/// What texels are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Texels {
    /// sRGB colour and linear alpha.
    Color,
    /// All linear.
    Data,
}

/// A level of a texture.
struct Level {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
    kind: Texels,
}

impl Level {
    /// Half the size: each texel the mean of four, for colours of light rather than of codes.
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
                if channel == 3 || self.kind == Texels::Data {
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
            kind: self.kind,
        }
    }
}

/// The texture with all its smaller levels; one too large for the device starts at the first that fits.
fn image(gpu: &Gpu, texture: &Texture, kind: Texels) -> TextureView {
    let mut level = Level {
        width: texture.width,
        height: texture.height,
        texels: texture.texels.clone(),
        kind,
    };
    while level.width.max(level.height) as usize > gpu.largest_texture() {
        level = level.halved();
    }
    let levels = level.width.max(level.height).ilog2() + 1;
    let image = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("material"),
        size: wgpu::Extent3d {
            width: level.width,
            height: level.height,
            depth_or_array_layers: 1,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match kind {
            Texels::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Texels::Data => wgpu::TextureFormat::Rgba8Unorm,
        },
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
        let mut level = Level {
            width: 3,
            height: 2,
            texels: vec![[0; 4], [255; 4], [9; 4], [255; 4], [0; 4], [9; 4]],
            kind: Texels::Color,
        };
        let half = level.halved();
        assert_eq!((half.width, half.height), (1, 1));
        // Half of the light is code 188, half of alpha 128.
        assert_eq!(half.texels, [[188, 188, 188, 128]]);
        level.kind = Texels::Data;
        assert_eq!(level.halved().texels, [[128; 4]]);
    }
}
