//! Materials, textures and the coordinates textures are looked up at.

use std::collections::BTreeMap;

use glam::Vec2;

use super::super::{AlphaMode, Material, NormalTexture, Sampler, Scene, SceneError, Wrap, decode};
use super::accessor::Data;
use super::json::{MaterialJson, TextureInfo, TextureTransform, get};
use crate::brdf::Reflection;
use crate::files::printable;

/// The materials of a document, and where each looks up its textures.
pub(super) struct Materials {
    /// By glTF index: UV set and transform, for materials with a texture that is read.
    lookups: Vec<Option<Lookup>>,
    /// Index in the scene of the material for primitives without one, once there is such a primitive.
    default: Option<usize>,
    maps: Maps,
}

/// Which textures are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Maps {
    /// Base colours, which is all that diffuse transfer takes.
    Color,
    /// Those of metalness, roughness and normals as well.
    All,
}

/// Where the textures of a material are looked up.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Lookup {
    pub(super) set: usize,
    transform: Option<TextureTransform>,
}

impl Lookup {
    /// Applies the texture transform: `offset + R · (scale · uv)`, where a positive rotation turns the coordinates counter-clockwise as seen
    /// on the image, v down (KHR_texture_transform, whose text and test model decide this; its shader snippet turns the other way).
    pub(super) fn apply(&self, [u, v]: [f32; 2]) -> Vec2 {
        let Some(transform) = &self.transform else {
            return Vec2::new(u, v);
        };
        let (sin, cos) = (libm::sin(transform.rotation), libm::cos(transform.rotation));
        let (u, v) = (
            f64::from(u) * transform.scale[0],
            f64::from(v) * transform.scale[1],
        );
        let turned = [
            cos * u + sin * v + transform.offset[0],
            cos * v - sin * u + transform.offset[1],
        ];
        Vec2::from(turned.map(|x| x as f32))
    }
}

impl Materials {
    /// Reads all materials into the scene, and such of their textures as `maps` says.
    pub(super) fn read(data: &Data<'_>, scene: &mut Scene, maps: Maps) -> Result<Self, SceneError> {
        let mut textures = Textures::default();
        let mut lookups = Vec::new();
        let mut blended = 0;
        for (index, json) in data.root.materials.iter().enumerate() {
            let place = format!("materials[{index}]");
            let (mut material, info) = plain(json, index, &place, &mut blended)?;
            let mut known = None;
            let mut of = |info: Option<&TextureInfo>| {
                info.map_or(Ok(None), |info| {
                    textures.at(data, scene, info, &mut known, &place)
                })
            };
            material.base_color_texture = of(info)?;
            if maps == Maps::All {
                if matches!(material.reflection, Reflection::MetallicRoughness { .. }) {
                    let pbr = json.pbr_metallic_roughness.as_ref();
                    let info = pbr.and_then(|pbr| pbr.metallic_roughness_texture.as_ref());
                    material.metallic_roughness_texture = of(info)?;
                }
                if let Some(normal) = &json.normal_texture {
                    let scale = normal.scale;
                    material.normal_texture =
                        of(Some(&normal.info))?.map(|texture| NormalTexture { texture, scale });
                }
            }
            lookups.push(known);
            scene.materials.push(material);
        }
        if textures.elsewhere > 0 {
            scene.warnings.push(format!(
                "{} textures were left out: they are looked up elsewhere than the others of their material",
                textures.elsewhere
            ));
        }
        if blended > 0 {
            scene.warnings.push(format!(
                "{blended} materials blend with what is behind them (alphaMode BLEND); they are treated as opaque"
            ));
        }
        if textures.dropped > 0 {
            scene.warnings.push(format!(
                "{} textures were left out; their factors alone are used",
                textures.dropped
            ));
        }
        Ok(Self {
            lookups,
            default: None,
            maps,
        })
    }

    /// Whether maps beside colour are read.
    pub(super) fn wants_maps(&self) -> bool {
        self.maps == Maps::All
    }

    /// The scene's index of a primitive's material, and where it looks up its textures.
    pub(super) fn of_primitive(
        &mut self,
        material: Option<usize>,
        scene: &mut Scene,
        place: &str,
    ) -> Result<(usize, Option<Lookup>), SceneError> {
        if let Some(index) = material {
            return Ok((index, *get(&self.lookups, index, "material", place)?));
        }
        let default = *self.default.get_or_insert_with(|| {
            // glTF gives a primitive without material a white one.
            scene.materials.push(Material {
                metallic: 1.0,
                reflection: reflection(1.0, 1.0),
                ..Material::diffuse("default", [1.0; 3])
            });
            scene.materials.len() - 1
        });
        Ok((default, None))
    }
}

pub(super) fn lookup(info: &TextureInfo) -> Lookup {
    let transform = info.extensions.transform;
    Lookup {
        set: transform
            .and_then(|t| t.tex_coord)
            .unwrap_or(info.tex_coord),
        transform,
    }
}

/// The material without its texture, and which texture that is.
fn plain<'a>(
    json: &'a MaterialJson,
    index: usize,
    place: &str,
    blended: &mut usize,
) -> Result<(Material, Option<&'a TextureInfo>), SceneError> {
    let alpha = match json.alpha_mode.as_deref() {
        None | Some("OPAQUE") => AlphaMode::Opaque,
        Some("MASK") => AlphaMode::Mask(json.alpha_cutoff.unwrap_or(0.5)),
        Some("BLEND") => {
            *blended += 1;
            AlphaMode::Opaque
        }
        Some(other) => {
            let problem = format!("alphaMode {} is unknown; re-export", printable(other));
            return Err(SceneError::gltf(place, problem));
        }
    };
    let standard = json.pbr_metallic_roughness.as_ref();
    let older = json.extensions.specular_glossiness.as_ref();
    let (base_color, texture, metallic, roughness) = match (standard, older) {
        (Some(pbr), _) => (
            pbr.base_color_factor,
            pbr.base_color_texture.as_ref(),
            pbr.metallic_factor,
            pbr.roughness_factor,
        ),
        (None, Some(old)) => (old.diffuse_factor, old.diffuse_texture.as_ref(), 0.0, 1.0),
        (None, None) => ([1.0; 4], None, 1.0, 1.0),
    };
    let name = json
        .name
        .clone()
        .unwrap_or_else(|| format!("material {index}"));
    let material = Material {
        name,
        base_color,
        base_color_texture: None,
        alpha,
        double_sided: json.double_sided,
        has_normal_map: json.normal_texture.is_some(),
        normal_texture: None,
        metallic,
        metallic_roughness_texture: None,
        reflection: match &json.extensions.specular {
            // Of a dielectric without highlight, Lambert is left.
            Some(specular) if specular.specular_factor == 0.0 && metallic == 0.0 => {
                Reflection::Diffuse
            }
            _ => reflection(metallic, roughness),
        },
    };
    Ok((material, texture))
}

/// Factors outside 0…1 are taken for the nearest inside.
fn reflection(metallic: f32, roughness: f32) -> Reflection {
    let inside = |factor: f32| factor.clamp(0.0, 1.0);
    Reflection::MetallicRoughness {
        metallic: inside(metallic),
        roughness: inside(roughness),
    }
}

/// Decoded textures by (image, sampler).
#[derive(Default)]
pub(super) struct Textures {
    known: BTreeMap<(usize, [bool; 1], [u8; 2]), Option<usize>>,
    dropped: usize,
    elsewhere: usize,
    allowance: decode::Allowance,
}

impl Textures {
    /// A texture of a material whose others are looked up at `known`: one set of coordinates serves them all.
    fn at(
        &mut self,
        data: &Data<'_>,
        scene: &mut Scene,
        info: &TextureInfo,
        known: &mut Option<Lookup>,
        place: &str,
    ) -> Result<Option<usize>, SceneError> {
        let lookup = lookup(info);
        if known.is_some_and(|known| known != lookup) {
            self.elsewhere += 1;
            return Ok(None);
        }
        let texture = self.get(data, scene, info, place)?;
        if texture.is_some() {
            *known = Some(lookup);
        }
        Ok(texture)
    }

    /// The decoded texture; `None` where its image is of a format that is not read.
    pub(super) fn get(
        &mut self,
        data: &Data<'_>,
        scene: &mut Scene,
        info: &TextureInfo,
        place: &str,
    ) -> Result<Option<usize>, SceneError> {
        let texture = get(&data.root.textures, info.index, "texture", place)?;
        let place = format!("textures[{}]", info.index);
        let sampler = match texture.sampler {
            None => Sampler::default(),
            Some(index) => sampler(data, index, &place)?,
        };
        let Some(image) = texture.source else {
            self.dropped += 1;
            return Ok(None);
        };
        let key = (
            image,
            [sampler.nearest],
            [sampler.wrap_u as u8, sampler.wrap_v as u8],
        );
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let json = get(&data.root.images, image, "image", &place)?;
        let place = format!("images[{image}]");
        let view = json
            .buffer_view
            .ok_or_else(|| SceneError::gltf(&place, "has neither uri nor bufferView; re-export"))?;
        let name = json.name.as_deref().unwrap_or(&place);
        let bytes = data.view(view, &place)?;
        let decoded = decode::decode(name, bytes, sampler, &mut self.allowance)?;
        self.dropped += usize::from(decoded.is_none());
        let index = decoded.map(|texture| {
            scene.textures.push(texture);
            scene.textures.len() - 1
        });
        self.known.insert(key, index);
        Ok(index)
    }
}

fn sampler(data: &Data<'_>, index: usize, place: &str) -> Result<Sampler, SceneError> {
    let json = get(&data.root.samplers, index, "sampler", place)?;
    let wrap = |code: Option<u32>| match code {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::Clamp),
        Some(33648) => Ok(Wrap::Mirror),
        Some(other) => Err(SceneError::gltf(
            format!("samplers[{index}]"),
            format!("wrap mode {other} is unknown; re-export"),
        )),
    };
    Ok(Sampler {
        wrap_u: wrap(json.wrap_s)?,
        wrap_v: wrap(json.wrap_t)?,
        nearest: json.mag_filter == Some(9728),
    })
}
