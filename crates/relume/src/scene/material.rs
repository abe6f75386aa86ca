//! What a surface looks like: albedo, reflection, alpha and sidedness.

use glam::{Vec2, Vec3};

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
    /// Whether the file gives a normal map (kept in the document, not used yet).
    pub has_normal_map: bool,
    /// glTF metallic factor times nothing else: to tell people that diffuse transfer ignores it.
    pub metallic: f32,
    /// How it reflects, which only transfer matrices know of.
    pub reflection: Reflection,
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
    /// Rows from the top: sRGB-encoded colour and linear alpha.
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
            metallic: 0.0,
            reflection: Reflection::Diffuse,
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
    /// Linear colour and alpha at `uv` (glTF: (0, 0) is the top left corner of the image).
    pub fn sample(&self, uv: Vec2) -> (Vec3, f32) {
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
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let mut color = Vec3::ZERO;
        let mut alpha = 0.0;
        for (dx, dy, weight) in [
            (0, 0, (1.0 - fx) * (1.0 - fy)),
            (1, 0, fx * (1.0 - fy)),
            (0, 1, (1.0 - fx) * fy),
            (1, 1, fx * fy),
        ] {
            let (c, a) = self.texel(x0 as i64 + dx, y0 as i64 + dy);
            color += weight * c;
            alpha += weight * a;
        }
        (color, alpha)
    }

    fn texel(&self, x: i64, y: i64) -> (Vec3, f32) {
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        let x = self.sampler.wrap_u.apply(x, w);
        let y = self.sampler.wrap_v.apply(y, h);
        let [r, g, b, a] = self.texels[(y * w + x) as usize];
        (
            Vec3::new(srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b)),
            f32::from(a) / 255.0,
        )
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
