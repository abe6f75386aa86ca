//! glTF 2.0: `.glb` from bytes everywhere, `.gltf` and files beside it with the feature `import`.

mod accessor;
mod container;
mod emission;
mod json;
mod material;
mod merge;
mod nodes;
mod primitive;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::error::check_totals;
use super::finish::Repairs;
use super::{Instance, Scene, SceneError};
use crate::files::printable;
use accessor::Data;
pub(crate) use emission::{Glow, emission};
use json::{Primitive, Root, get};
pub(crate) use material::Maps;
use material::Materials;
use nodes::Placed;

/// Extensions that may be required: either read, or without a say in shape and base colour.
const UNDERSTOOD: [&str; 10] = [
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_lights_punctual",
    "KHR_animation_pointer",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "RELUME_transfer",
];

/// Reads a `.glb` that refers to nothing outside itself.
///
/// Needs no file system: with every feature off it reads all but textures (PNG and JPEG need `images`). Positions stay in object space;
/// [`Scene::instances`] run depth first over nodes, then primitives; instances of one primitive share a mesh. Base colours are linear: factor
/// × `COLOR_0` × texture, 1 where there is no material. [`Scene::source_hash`] is the SHA-256 of `bytes`.
///
/// # Errors
///
/// Whatever in the file does not hold together, names something outside the file, or requires an extension that is not read.
pub fn from_glb(bytes: &[u8]) -> Result<Scene, SceneError> {
    with_maps(bytes, Maps::Color)
}

/// [`from_glb`] with the textures that `maps` says.
pub(crate) fn with_maps(bytes: &[u8], maps: Maps) -> Result<Scene, SceneError> {
    let mut fetch = |uri: &str| {
        Err(SceneError::Reference {
            reference: printable(&uri.chars().take(200).collect::<String>()),
            why: "lies outside the .glb that was given as bytes alone",
        })
    };
    let mut scene = read_glb(bytes, &mut fetch, maps)?;
    let digest = Sha256::digest(bytes);
    scene.source_hash = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(scene)
}

/// Reads a `.glb`; `fetch` reads the files it refers to.
pub(super) fn read_glb(
    bytes: &[u8],
    fetch: merge::Fetch<'_>,
    maps: Maps,
) -> Result<Scene, SceneError> {
    let glb = container::split(bytes)?;
    let mut scene = read(glb.json, glb.bin, fetch, maps)?;
    if glb.ignored_chunks > 0 {
        scene.warnings.push(format!(
            "{} chunks of unknown type were left out",
            glb.ignored_chunks
        ));
    }
    Ok(scene)
}

/// Reads a `.gltf`; `fetch` reads the files it refers to.
#[cfg(feature = "import")]
pub(super) fn read_gltf(
    text: &[u8],
    fetch: merge::Fetch<'_>,
    maps: Maps,
) -> Result<Scene, SceneError> {
    read(container::parse(text)?, None, fetch, maps)
}

fn read(
    mut json: Value,
    bin: Option<Vec<u8>>,
    fetch: merge::Fetch<'_>,
    maps: Maps,
) -> Result<Scene, SceneError> {
    // Before anything is fetched: a document that needs what is not read is not worth it.
    check_extensions(&json)?;
    // The transfer of a baked file is none of the scene, and may be many gigabytes in another file.
    crate::asset::strip_beside(&mut json);
    let document = merge::merge(json, bin, fetch)?;
    let root = Root::from_value(&document.json)?;
    let mut scene = Scene::default();
    warn(&root, &mut scene);
    let data = Data {
        root: &root,
        bin: &document.bin,
    };
    build(&data, &mut scene, maps)?;
    scene.document = Some(document);
    Ok(scene)
}

fn check_extensions(json: &Value) -> Result<(), SceneError> {
    let required: Vec<String> = json::list(json, "extensionsRequired")?;
    let unknown = |name: &&String| {
        // Other materials change how light is reflected, not the base colour.
        !UNDERSTOOD.contains(&name.as_str()) && !name.starts_with("KHR_materials_")
    };
    match required.iter().find(unknown) {
        None => Ok(()),
        Some(name) => Err(SceneError::Extension {
            name: printable(name),
            hint: match name.as_str() {
                "KHR_draco_mesh_compression"
                | "EXT_meshopt_compression"
                | "KHR_meshopt_compression" => "re-export without mesh compression",
                "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif"
                | "MSFT_texture_dds" => "re-export with PNG or JPEG textures",
                _ => "re-export without it",
            },
        }),
    }
}

/// What the file has and Relume leaves aside.
fn warn(root: &Root, scene: &mut Scene) {
    let skinned = root.nodes.iter().any(|node| node.skin.is_some());
    let morphed = root.meshes.iter().any(|mesh| {
        !mesh.weights.is_empty() || mesh.primitives.iter().any(|p| !p.targets.is_empty())
    });
    let moving: Vec<&str> = [
        (root.has_animations, "animations"),
        (skinned, "skins"),
        (morphed, "morph targets"),
    ]
    .into_iter()
    .filter_map(|(there, name)| there.then_some(name))
    .collect();
    if !moving.is_empty() {
        let moving = moving.join(", ");
        scene
            .warnings
            .push(format!("the scene has {moving}; its rest pose is used"));
    }
    let ignored = ["EXT_mesh_gpu_instancing", "KHR_node_visibility", "MSFT_lod"];
    for name in ignored {
        if root.extensions_used.iter().any(|used| used == name) {
            scene
                .warnings
                .push(format!("the extension {name} is ignored"));
        }
    }
}

/// Primitives with triangles of a mesh, with their places in it.
fn primitives<'a>(
    root: &'a Root,
    placed: &Placed,
) -> Result<impl Iterator<Item = (usize, &'a Primitive)>, SceneError> {
    let place = format!("nodes[{}]", placed.node);
    let mesh = get(&root.meshes, placed.mesh, "mesh", &place)?;
    let with_triangles = |&(_, p): &(usize, &Primitive)| {
        primitive::triangle_count(p.mode, 0).is_some() && p.attributes.contains_key("POSITION")
    };
    Ok(mesh.primitives.iter().enumerate().filter(with_triangles))
}

fn build(data: &Data<'_>, scene: &mut Scene, maps: Maps) -> Result<(), SceneError> {
    let (placed, flat) = nodes::walk(data.root)?;
    if flat > 0 {
        scene.warnings.push(format!(
            "{flat} meshes were left out: their nodes' transforms flatten them"
        ));
    }
    count(data, &placed, scene)?;
    let mut materials = Materials::read(data, scene, maps)?;
    let mut repairs = Repairs::default();
    let mut known = BTreeMap::new();
    for node in &placed {
        for (index, primitive) in primitives(data.root, node)? {
            let key = (node.mesh, index);
            let mesh = match known.get(&key) {
                Some(&mesh) => mesh,
                None => {
                    let place = format!("meshes[{}].primitives[{index}]", node.mesh);
                    let name = mesh_name(data.root, node.mesh, index);
                    let mut mesh =
                        primitive::read(data, primitive, name, scene, &mut materials, &place)?;
                    repairs
                        .mesh(&mut mesh, None)
                        .map_err(|error| error.within(place))?;
                    scene.meshes.push(mesh);
                    known.insert(key, scene.meshes.len() - 1);
                    scene.meshes.len() - 1
                }
            };
            scene.instances.push(Instance {
                mesh,
                node: node.node,
                primitive: index,
                world_from_object: node.world_from_object,
            });
        }
    }
    repairs.scene(scene)
}

/// Adds up vertices and triangles over all instances before anything is allocated for them.
fn count(data: &Data<'_>, placed: &[Placed], scene: &mut Scene) -> Result<(), SceneError> {
    let (mut vertices, mut triangles, mut skipped) = (0u64, 0u64, 0);
    for node in placed {
        let place = format!("meshes[{}]", node.mesh);
        let mut read = 0;
        for (_, primitive) in primitives(data.root, node)? {
            let count = data
                .accessor(primitive.attributes["POSITION"], &place)?
                .count;
            let indices = match primitive.indices {
                Some(index) => data.accessor(index, &place)?.count,
                None => count,
            };
            vertices += count;
            triangles += primitive::triangle_count(primitive.mode, indices).unwrap_or(0);
            check_totals(vertices, triangles)?;
            read += 1;
        }
        skipped += data.root.meshes[node.mesh].primitives.len() - read;
    }
    if skipped > 0 {
        scene.warnings.push(format!(
            "{skipped} primitives without triangles (points, lines) were left out"
        ));
    }
    Ok(())
}

fn mesh_name(root: &Root, mesh: usize, primitive: usize) -> String {
    let json = &root.meshes[mesh];
    let name = json.name.clone().unwrap_or_else(|| format!("mesh {mesh}"));
    match json.primitives.len() {
        1 => name,
        _ => format!("{name}, primitive {primitive}"),
    }
}
