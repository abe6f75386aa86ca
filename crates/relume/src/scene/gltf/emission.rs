//! What shines of a document: the primitives whose materials are emissive.

use std::collections::BTreeMap;

use glam::Vec2;
use serde::Deserialize;

use super::super::{AlphaMode, Document, Scene, SceneError, Wrap};
use super::accessor::Data;
use super::json::{self, Primitive, Root, TextureInfo, get};
use super::material::{Textures, lookup};
use crate::files::printable;

/// An instance that shines.
#[derive(Debug)]
pub(crate) struct Glow {
    /// Of its node, or else of its mesh.
    pub(crate) name: String,
    /// Index into [`Scene::instances`].
    pub(crate) instance: usize,
    /// Factor times strength, linear.
    pub(crate) radiance: [f32; 3],
    /// Index into [`Scene::textures`], sRGB, that multiplies the radiance; and where each vertex looks it up.
    pub(crate) texture: Option<(usize, Vec<Vec2>)>,
    pub(crate) double_sided: bool,
}

/// What a material says of emission.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct EmissiveJson {
    emissive_factor: [f32; 3],
    emissive_texture: Option<TextureInfo>,
    extensions: EmissiveExtensions,
}

#[derive(Debug, Default, Deserialize)]
struct EmissiveExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    strength: Option<Strength>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Strength {
    emissive_strength: f32,
}

impl Default for Strength {
    fn default() -> Self {
        Self {
            emissive_strength: 1.0,
        }
    }
}

impl EmissiveJson {
    fn radiance(&self) -> [f32; 3] {
        let strength = self.extensions.strength.as_ref();
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength);
        self.emissive_factor.map(|factor| factor * strength)
    }
}

/// The instances that shine, in the order of the scene. Their textures are appended to the scene's, what there is to say to its warnings.
///
/// # Errors
/// Where a material or its texture does not hold together, the image cannot be read, or instances that shine have more than `most_corners`
/// corners together, for which nothing has been allocated yet. A scene without a document has none that shine.
pub(crate) fn emission(scene: &mut Scene, most_corners: u64) -> Result<Vec<Glow>, SceneError> {
    let Some(document) = scene.document.take() else {
        return Ok(Vec::new());
    };
    let glows = of_document(&document, scene, most_corners);
    scene.document = Some(document);
    glows
}

fn of_document(
    document: &Document,
    scene: &mut Scene,
    most_corners: u64,
) -> Result<Vec<Glow>, SceneError> {
    let root = Root::from_value(&document.json)?;
    let materials: Vec<EmissiveJson> = json::list(&document.json, "materials")?;
    let shining = shining(scene, &materials);
    check_corners(scene, &shining, most_corners)?;
    let data = Data {
        root: &root,
        bin: &document.bin,
    };
    let mut textures = Textures::default();
    let mut images = BTreeMap::new();
    let mut glows = Vec::new();
    for (instance, material) in shining {
        let json = &materials[material];
        let texture = match &json.emissive_texture {
            None => None,
            Some(info) => {
                let place = format!("materials[{material}].emissiveTexture");
                let index = match images.get(&material) {
                    Some(&index) => index,
                    None => image(&data, scene, &mut textures, info, &place)?,
                };
                images.insert(material, index);
                Some((index, uvs(&data, scene, instance, info)?))
            }
        };
        glows.push(Glow {
            name: name(&root, scene, instance)?,
            instance,
            radiance: json.radiance(),
            texture,
            double_sided: scene.materials[material].double_sided,
        });
    }
    warn(scene, &glows);
    Ok(glows)
}

/// Instances with an emissive material, and which.
fn shining(scene: &Scene, materials: &[EmissiveJson]) -> Vec<(usize, usize)> {
    let of = |(index, instance): (usize, &super::super::Instance)| {
        let mesh = &scene.meshes[instance.mesh];
        // The material of primitives without one comes after the document's own.
        let material = mesh.groups.first()?.material;
        let shines = materials.get(material)?.radiance() != [0.0; 3];
        (shines && mesh.triangle_count() > 0).then_some((index, material))
    };
    let instances = scene.instances.iter().enumerate();
    instances.filter_map(of).collect()
}

fn check_corners(scene: &Scene, shining: &[(usize, usize)], limit: u64) -> Result<(), SceneError> {
    let corners = |&(instance, _): &(usize, usize)| {
        let mesh = &scene.meshes[scene.instances[instance].mesh];
        mesh.positions.len().max(3 * mesh.triangle_count()) as u64
    };
    let count = shining.iter().map(corners).sum();
    match count > limit {
        true => Err(SceneError::TooMany {
            what: "corners of emissive triangles",
            count,
            limit,
        }),
        false => Ok(()),
    }
}

/// The image of an emissive texture, which nothing can stand in for.
fn image(
    data: &Data<'_>,
    scene: &mut Scene,
    textures: &mut Textures,
    info: &TextureInfo,
    place: &str,
) -> Result<usize, SceneError> {
    let problem = match cfg!(feature = "images") {
        true => "has no PNG or JPEG image; re-export with one",
        false => "is an image, which needs the feature `images`; build with it",
    };
    let index = textures.get(data, scene, info, place)?;
    index.ok_or_else(|| SceneError::gltf(place, problem))
}

/// The glTF primitive of an instance.
fn primitive<'a>(
    root: &'a Root,
    scene: &Scene,
    instance: usize,
) -> Result<(usize, &'a Primitive), SceneError> {
    let instance = &scene.instances[instance];
    let place = format!("nodes[{}]", instance.node);
    let node = get(&root.nodes, instance.node, "node", &place)?;
    let mesh = node.mesh.unwrap_or(usize::MAX);
    let primitives = &get(&root.meshes, mesh, "mesh", &place)?.primitives;
    Ok((
        mesh,
        get(primitives, instance.primitive, "primitive", &place)?,
    ))
}

/// Where each vertex of an instance looks a texture up; the texture's corner where the file does not say.
fn uvs(
    data: &Data<'_>,
    scene: &mut Scene,
    instance: usize,
    info: &TextureInfo,
) -> Result<Vec<Vec2>, SceneError> {
    let (mesh, primitive) = primitive(data.root, scene, instance)?;
    let place = format!(
        "meshes[{mesh}].primitives[{}]",
        scene.instances[instance].primitive
    );
    let count = scene.meshes[scene.instances[instance].mesh].positions.len();
    let lookup = lookup(info);
    let key = format!("TEXCOORD_{}", lookup.set);
    let Some(&accessor) = primitive.attributes.get(&key) else {
        scene.warnings.push(format!(
            "{place} has no {key}, at which its emissive texture is looked up; the texture's corner is used"
        ));
        return Ok(vec![Vec2::ZERO; count]);
    };
    let uvs = data.floats::<2>(accessor, false, &place)?;
    super::primitive::same_count(uvs.len(), count, &key, &place)?;
    let finite = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
    Ok(uvs.into_iter().map(|uv| finite(lookup.apply(uv))).collect())
}

fn name(root: &Root, scene: &Scene, instance: usize) -> Result<String, SceneError> {
    let (mesh, _) = primitive(root, scene, instance)?;
    let instance = &scene.instances[instance];
    let primitives = root.meshes[mesh].primitives.len();
    Ok(match (&root.nodes[instance.node].name, primitives) {
        (Some(name), 1) => name.clone(),
        (Some(name), _) => format!("{name}, primitive {}", instance.primitive),
        (None, _) => scene.meshes[instance.mesh].name.clone(),
    })
}

/// What of emissive surfaces is not as the file says.
fn warn(scene: &mut Scene, glows: &[Glow]) {
    let material =
        |glow: &Glow| scene.meshes[scene.instances[glow.instance].mesh].groups[0].material;
    let mut masked: Vec<usize> = Vec::new();
    let mut bounded: Vec<usize> = Vec::new();
    for glow in glows {
        let index = material(glow);
        if matches!(scene.materials[index].alpha, AlphaMode::Mask(_)) {
            masked.push(index);
        }
        let Some((texture, uvs)) = &glow.texture else {
            continue;
        };
        let sampler = &scene.textures[*texture].sampler;
        let tiles = sampler.wrap_u == Wrap::Repeat && sampler.wrap_v == Wrap::Repeat;
        let outside = |uv: &Vec2| uv.min_element() < 0.0 || uv.max_element() > 1.0;
        if !tiles && uvs.iter().any(outside) {
            bounded.push(index);
        }
    }
    for (mut materials, what) in [
        (masked, "has holes (alphaMode MASK); they shine and block"),
        (
            bounded,
            "clamps or mirrors its emissive texture outside 0…1; it is repeated",
        ),
    ] {
        materials.sort_unstable();
        materials.dedup();
        for index in materials {
            let name = printable(&scene.materials[index].name);
            let warning = format!("the emissive material \"{name}\" {what}");
            scene.warnings.push(warning);
        }
    }
}
