//! What a surface looks like: albedo, reflection, alpha and sidedness.

use glam::{Vec2, Vec3, Vec4};

use crate::brdf::Reflection;

/// Base colour, reflection and visibility of a surface. Diffuse transfer takes the base colour for its albedo, whatever its reflection.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name in the file, or a made-up one.
    pub name: String,
    /// Linear base colour factor and alpha factor.
    pub base_color: [f32; 4],
    /// Index into [`super::Scene::textures`]; multiplies `base_color`.
    pub base_color_texture: Option<usize>,
    /// How alpha is read.
    pub alpha: AlphaMode,
    /// Whether the back side reflects as the front does. Otherwise the back blocks and reflects nothing.
    pub double_sided: bool,
    /// Whether the file gives a normal map, be it read or not.
    pub has_normal_map: bool,
    /// Read for glossy transfer.
    pub normal_texture: Option<NormalTexture>,
    /// glTF metallic factor times nothing else: to tell people that diffuse transfer ignores it.
    pub metallic: f32,
    /// Index of a texture whose green multiplies roughness and whose blue metalness, both linear. Read for glossy transfer.
    pub metallic_roughness_texture: Option<usize>,
    /// How it reflects, which only transfer matrices know of.
    pub reflection: Reflection,
}

/// A normal map in tangent space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// Index into [`super::Scene::textures`]: linear, 0…1 stands for −1…1; x along u, y up in the image, z out of the surface.
    pub texture: usize,
    /// Multiplies x and y.
    pub scale: f32,
}

/// How alpha decides what a ray sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored (glTF OPAQUE, and BLEND, which Relume treats as opaque).
    Opaque,
    /// Where alpha is below the cutoff there is no surface.
    Mask(f32),
}

/// A decoded texture.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Rows from the top: sRGB-encoded colour and linear alpha, or linear data, as the material that names it says.
    pub texels: Vec<[u8; 4]>,
    /// What happens between texels and past the edges.
    pub sampler: Sampler,
}

/// Addressing outside 0…1 along u and v. Filtering is bilinear, or nearest where the file asks for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    /// Along u.
    pub wrap_u: Wrap,
    /// Along v.
    pub wrap_v: Wrap,
    /// Nearest texel instead of bilinear.
    pub nearest: bool,
}

/// Addressing outside 0…1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The edge texel.
    Clamp,
    /// Tiles.
    Repeat,
    /// Tiles, every other one mirrored.
    Mirror,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            nearest: false,
        }
    }
}

impl Material {
    /// An opaque one-sided surface of linear colour `albedo`.
    pub fn diffuse(name: &str, albedo: [f32; 3]) -> Self {
        Self {
            name: name.to_owned(),
            base_color: [albedo[0], albedo[1], albedo[2], 1.0],
            base_color_texture: None,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            has_normal_map: false,
            normal_texture: None,
            metallic: 0.0,
            metallic_roughness_texture: None,
            reflection: Reflection::Diffuse,
        }
    }
}

impl Material {
    /// The reflection at its mean roughness and metalness, where these have a map.
    pub fn typical_reflection(&self, textures: &[Texture]) -> Reflection {
        let map = self.metallic_roughness_texture.map(|i| &textures[i]);
        match (&self.reflection, map) {
            (
                Reflection::MetallicRoughness {
                    metallic,
                    roughness,
                },
                Some(map),
            ) => {
                let mean = |channel: usize| {
                    let sum: u64 = map
                        .texels
                        .iter()
                        .map(|texel| u64::from(texel[channel]))
                        .sum();
                    (sum as f64 / (255 * map.texels.len().max(1)) as f64) as f32
                };
                Reflection::MetallicRoughness {
                    metallic: metallic * mean(2),
                    roughness: roughness * mean(1),
                }
            }
            (reflection, _) => reflection.clone(),
        }
    }
}

impl Wrap {
    fn apply(self, i: i64, n: i64) -> i64 {
        match self {
            Self::Clamp => i.clamp(0, n - 1),
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => {
                let j = i.rem_euclid(2 * n);
                if j < n { j } else { 2 * n - 1 - j }
            }
        }
    }
}

impl Texture {
    /// Linear colour and alpha of an sRGB image at `uv` (glTF: (0, 0) is the top left corner of the image).
    pub fn sample(&self, uv: Vec2) -> (Vec3, f32) {
        let texel = self.filtered(uv, |[r, g, b, a]| {
            let [r, g, b] = [r, g, b].map(srgb_to_linear);
            Vec4::new(r, g, b, f32::from(a) / 255.0)
        });
        (texel.truncate(), texel.w)
    }

    /// The image at `uv` as it is, 0…1: of data, not of colours.
    pub fn sample_data(&self, uv: Vec2) -> Vec4 {
        self.filtered(uv, |texel| Vec4::from(texel.map(f32::from)) / 255.0)
    }

    fn filtered(&self, uv: Vec2, decode: impl Fn([u8; 4]) -> Vec4) -> Vec4 {
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        // Past ±2²⁴ texels a coordinate has no fraction left; NaN becomes 0.
        let place = |t: f32, n: i64| {
            let x = t * n as f32;
            if x.is_finite() {
                x.clamp(-1.6e7, 1.6e7)
            } else {
                0.0
            }
        };
        let (x, y) = (place(uv.x, w), place(uv.y, h));
        if self.sampler.nearest {
            return decode(self.texel(x.floor() as i64, y.floor() as i64));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let mut sum = Vec4::ZERO;
        for (dx, dy, weight) in [
            (0, 0, (1.0 - fx) * (1.0 - fy)),
            (1, 0, fx * (1.0 - fy)),
            (0, 1, (1.0 - fx) * fy),
            (1, 1, fx * fy),
        ] {
            sum += weight * decode(self.texel(x0 as i64 + dx, y0 as i64 + dy));
        }
        sum
    }

    fn texel(&self, x: i64, y: i64) -> [u8; 4] {
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        let x = self.sampler.wrap_u.apply(x, w);
        let y = self.sampler.wrap_v.apply(y, h);
        self.texels[(y * w + x) as usize]
    }
}

/// Linear value of an 8-bit sRGB code [iec61966].
pub fn srgb_to_linear(code: u8) -> f32 {
    static TABLE: std::sync::LazyLock<[f32; 256]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|i| {
            let c = i as f64 / 255.0;
            let linear = if c <= 0.04045 {
                c / 12.92
            } else {
                libm::pow((c + 0.055) / 1.055, 2.4)
            };
            linear as f32
        })
    });
    TABLE[usize::from(code)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_one(sampler: Sampler) -> Texture {
        Texture {
            width: 2,
            height: 1,
            texels: vec![[0, 0, 0, 0], [255, 255, 255, 255]],
            sampler,
        }
    }

    #[test]
    fn bilinear_meets_texels_at_their_centres_and_halves_between() {
        let clamp = Sampler {
            wrap_u: Wrap::Clamp,
            wrap_v: Wrap::Clamp,
            nearest: false,
        };
        let texture = two_by_one(clamp);
        assert_eq!(texture.sample(Vec2::new(0.25, 0.5)).0.x, 0.0);
        assert_eq!(texture.sample(Vec2::new(0.75, 0.5)).0.x, 1.0);
        assert_eq!(texture.sample(Vec2::new(0.5, 0.5)).0.x, 0.5);
        assert_eq!(texture.sample(Vec2::new(-3.0, 0.5)).1, 0.0);
    }

    #[test]
    fn wraps_tile_and_mirror() {
        let nearest = |wrap| Sampler {
            wrap_u: wrap,
            wrap_v: wrap,
            nearest: true,
        };
        let at = |wrap, u| two_by_one(nearest(wrap)).sample(Vec2::new(u, 0.5)).1;
        assert_eq!(
            [1.25, 1.75, -0.25].map(|u| at(Wrap::Repeat, u)),
            [0.0, 1.0, 1.0]
        );
        assert_eq!(
            [1.25, 1.75, -0.25].map(|u| at(Wrap::Mirror, u)),
            [1.0, 0.0, 0.0]
        );
        assert_eq!(at(Wrap::Clamp, f32::NAN), 0.0);
    }
}
