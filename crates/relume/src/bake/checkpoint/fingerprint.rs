//! What a bake depends on, so that no work is taken up for another one.

use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::CheckpointError;
use super::error::shown;
use crate::brdf::Reflection;
use crate::files::{le_bytes, printable};
use crate::scene::{AlphaMode, Material, Sampler, Texture, World, Wrap};

/// What a header begins with.
const WHAT: &str = "relume checkpoint";
/// The version of the folder's format.
const FORMAT: u64 = 1;

/// What a bake depends on: the scene, the options, the version of Relume.
#[derive(Clone, Debug, PartialEq)]
pub struct Fingerprint {
    /// SHA-256 in hex.
    scene: String,
    options: Vec<(String, String)>,
}

impl Fingerprint {
    /// Of a bake of `world` with `options`: name and value of each, as they are to be named when one has changed (`--samples`, `1024`).
    ///
    /// The scene goes in as SHA-256 of everything in it that a bake may read. Number of threads, output and the like must stay out.
    pub fn new(world: &World, options: &[(&str, String)]) -> Self {
        let owned = |(name, value): &(&str, String)| ((*name).to_owned(), value.clone());
        Self {
            scene: hex(&of_world(world)),
            options: options.iter().map(owned).collect(),
        }
    }

    /// SHA-256 of all of it, in hex.
    pub fn digest(&self) -> String {
        hex(&digest(&self.header()))
    }

    /// The content of the header file.
    pub(super) fn header(&self) -> Vec<u8> {
        let options = self.options.iter().cloned();
        let options: serde_json::Map<String, Value> =
            options.map(|(name, value)| (name, value.into())).collect();
        let header = json!({
            "what": WHAT,
            "format": FORMAT,
            "relume": env!("CARGO_PKG_VERSION"),
            "options": options,
            "scene": self.scene,
        });
        let mut text = format!("{header:#}").into_bytes();
        text.push(b'\n');
        text
    }

    /// Refuses the header of a checkpoint of another bake, and says what differs.
    pub(super) fn check(&self, folder: &Path, header: &[u8]) -> Result<(), CheckpointError> {
        if header == self.header() {
            return Ok(());
        }
        let folder = shown(folder);
        let damaged = || CheckpointError::Damaged {
            folder: folder.clone(),
            what: "its header is not one that relume writes".to_owned(),
        };
        let old: Value = serde_json::from_slice(header).map_err(|_| damaged())?;
        if old["what"] != WHAT {
            return Err(damaged());
        }
        let what = self.difference(&old).ok_or_else(damaged)?;
        Err(CheckpointError::Other { folder, what })
    }

    /// The first thing in which another header differs; `None` if there is none.
    fn difference(&self, old: &Value) -> Option<String> {
        let here = json!({ "format": FORMAT, "relume": env!("CARGO_PKG_VERSION") });
        for (key, of) in [("format", "format"), ("relume", "version")] {
            if old[key] != here[key] {
                let [old, new] = [&old[key], &here[key]].map(text);
                return Some(format!("{of} {old} of relume wrote it, and this is {new}"));
            }
        }
        let ours = |name: &str| self.options.iter().find(|(own, _)| own == name);
        let olds = old["options"].as_object()?;
        let gone = olds.keys().filter(|name| ours(name).is_none());
        let names = self.options.iter().map(|(name, _)| name).chain(gone);
        for name in names {
            let new = ours(name).map(|(_, value)| printable(value));
            let old = olds.get(name).map(text);
            if new != old {
                let said = |value: Option<String>| value.unwrap_or("not given".to_owned());
                let (name, old, new) = (printable(name), said(old), said(new));
                return Some(format!("{name} was {old}, is {new}"));
            }
        }
        (old["scene"] != *self.scene).then(|| "the scene has changed".to_owned())
    }
}

/// A value from a header, fit to print.
fn text(value: &Value) -> String {
    let text = value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned);
    printable(&text.chars().take(80).collect::<String>())
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256.
pub(super) fn digest(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

/// SHA-256 of everything in `world` that a bake may read, each array after its length.
fn of_world(world: &World) -> [u8; 32] {
    // Every field by name: a new one must be thought of here.
    let World {
        positions,
        normals,
        uvs,
        tangents,
        colors,
        alphas,
        triangles,
        triangle_materials,
        instance_vertices,
        from_input,
        materials,
        textures,
    } = world;
    let mut hash = Hash(Sha256::new());
    hash.floats(bytemuck::cast_slice(positions));
    hash.floats(bytemuck::cast_slice(normals));
    hash.floats(bytemuck::cast_slice(uvs));
    hash.floats(bytemuck::cast_slice(tangents));
    hash.floats(bytemuck::cast_slice(colors));
    hash.floats(alphas);
    hash.words(triangles.as_flattened());
    hash.words(triangle_materials);
    hash.number(instance_vertices.len());
    for range in instance_vertices {
        hash.number(range.start);
        hash.number(range.end);
    }
    hash.bytes(bytemuck::cast_slice(from_input));
    hash.number(materials.len());
    materials
        .iter()
        .for_each(|material| hash.material(material));
    hash.number(textures.len());
    textures.iter().for_each(|texture| hash.texture(texture));
    hash.0.finalize().into()
}

struct Hash(Sha256);

impl Hash {
    fn number(&mut self, number: usize) {
        self.0.update((number as u64).to_le_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len());
        self.0.update(bytes);
    }

    fn floats(&mut self, floats: &[f32]) {
        self.number(floats.len());
        // In pieces, because a big-endian machine copies.
        for piece in floats.chunks(1 << 16) {
            self.0.update(le_bytes(piece));
        }
    }

    fn words(&mut self, words: &[u32]) {
        self.number(words.len());
        for piece in words.chunks(1 << 16) {
            if cfg!(target_endian = "little") {
                self.0.update(bytemuck::cast_slice::<u32, u8>(piece));
            } else {
                piece
                    .iter()
                    .for_each(|word| self.0.update(word.to_le_bytes()));
            }
        }
    }

    fn material(&mut self, material: &Material) {
        let Material {
            name: _,
            base_color,
            base_color_texture,
            alpha,
            double_sided,
            has_normal_map: _,
            normal_texture,
            metallic: _,
            metallic_roughness_texture,
            reflection,
        } = material;
        self.floats(base_color);
        for texture in [base_color_texture, metallic_roughness_texture] {
            self.number(texture.map_or(0, |texture| texture + 1));
        }
        match normal_texture {
            None => self.floats(&[]),
            Some(map) => {
                self.number(map.texture);
                self.floats(&[map.scale]);
            }
        }
        match alpha {
            AlphaMode::Opaque => self.floats(&[]),
            AlphaMode::Mask(cutoff) => self.floats(&[*cutoff]),
        }
        self.number(usize::from(*double_sided));
        self.reflection(reflection);
    }

    fn reflection(&mut self, reflection: &Reflection) {
        match reflection {
            Reflection::Diffuse => self.number(0),
            Reflection::MetallicRoughness {
                metallic,
                roughness,
            } => self.floats(&[*metallic, *roughness]),
            Reflection::Tile { tile, repeat } => {
                self.floats(tile.values());
                self.bytes(format!("{:?} {repeat:?}", tile.shape()).as_bytes());
            }
            // Its numbers to the last digit, measured tables among them.
            Reflection::Fixed(brdf) => self.bytes(format!("{brdf:?}").as_bytes()),
        }
    }

    fn texture(&mut self, texture: &Texture) {
        let Texture {
            width,
            height,
            texels,
            sampler:
                Sampler {
                    wrap_u,
                    wrap_v,
                    nearest,
                },
        } = texture;
        self.words(&[*width, *height]);
        self.bytes(texels.as_flattened());
        for wrap in [wrap_u, wrap_v] {
            self.number(match wrap {
                Wrap::Clamp => 0,
                Wrap::Repeat => 1,
                Wrap::Mirror => 2,
            });
        }
        self.number(usize::from(*nearest));
    }
}
