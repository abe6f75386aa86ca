//! New meshes for the nodes of a glTF whose triangles were split.
//!
//! Tessellation keeps the attributes of [`Mesh`]: position, normal, base colour coordinates, vertex colour. A tessellated primitive
//! carries those and drops the others (tangents, other texture coordinates, joints, morph targets); what its material looked up at
//! other coordinates is left out of a copy of the material. The mesh, primitive, accessors and material it came from stay in the file.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use super::AssetError;
use super::builder::{Builder, malformed, object};
use super::fresh;
use crate::scene::{Instance, Mesh, Scene};

const TRANSFORM: &str = "KHR_texture_transform";

/// Gives every node with split triangles a mesh of its own.
pub fn replace<'a>(builder: &mut Builder<'a>, scene: &'a Scene) -> Result<(), AssetError> {
    // By material and whether there are coordinates, and by node.
    let mut materials: BTreeMap<(usize, bool), usize> = BTreeMap::new();
    let mut meshes: BTreeMap<usize, usize> = BTreeMap::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let primitive = primitive(builder, instance)?;
        let count = vertex_count(builder, primitive)?;
        if count == mesh.positions.len() {
            continue;
        }
        if count > mesh.positions.len() || mesh.groups.len() != 1 {
            return Err(mismatch(instance));
        }
        let material = primitive.get("material").and_then(Value::as_u64);
        let extras = primitive.get("extras").cloned();
        let mut new = tessellated(builder, mesh)?;
        if let Some(material) = material {
            let key = (material as usize, !mesh.uvs.is_empty());
            let copy = match materials.get(&key) {
                Some(&copy) => copy,
                None => copy_material(builder, key)?,
            };
            materials.insert(key, copy);
            new.insert("material".to_owned(), copy.into());
        }
        if let Some(extras) = extras {
            new.insert("extras".to_owned(), extras);
        }
        let target = match meshes.get(&instance.node) {
            Some(&target) => target,
            None => own_mesh(builder, instance.node)?,
        };
        meshes.insert(instance.node, target);
        builder.array("meshes")?[target]["primitives"][instance.primitive] = new.into();
    }
    Ok(())
}

/// The glTF primitive of an instance.
fn primitive<'b>(builder: &'b Builder<'_>, instance: &Instance) -> Result<&'b Value, AssetError> {
    let json = &builder.json;
    let mesh = json["nodes"][instance.node]["mesh"].as_u64();
    let mesh = mesh.and_then(|mesh| json["meshes"].get(mesh as usize));
    mesh.and_then(|mesh| mesh["primitives"].get(instance.primitive))
        .ok_or_else(|| mismatch(instance))
}

/// How many vertices a glTF primitive has.
fn vertex_count(builder: &Builder<'_>, primitive: &Value) -> Result<usize, AssetError> {
    let accessor = primitive["attributes"]["POSITION"].as_u64();
    let accessor = accessor.and_then(|i| builder.json["accessors"].get(i as usize));
    let count = accessor.and_then(|accessor| accessor["count"].as_u64());
    let count = count.and_then(|count| usize::try_from(count).ok());
    count.ok_or_else(|| malformed("a primitive has no positions"))
}

fn mismatch(instance: &Instance) -> AssetError {
    let Instance {
        node, primitive, ..
    } = instance;
    AssetError::Mismatch(format!(
        "primitive {primitive} of node {node} is not the one in its glTF document"
    ))
}

fn tessellated<'a>(
    builder: &mut Builder<'a>,
    mesh: &'a Mesh,
) -> Result<Map<String, Value>, AssetError> {
    let attributes = fresh::add_attributes(builder, mesh)?;
    let indices = builder.indices(&mesh.groups[0].triangles, mesh.positions.len())?;
    let mut new = Map::new();
    new.insert("attributes".to_owned(), attributes.into());
    new.insert("indices".to_owned(), indices.into());
    Ok(new)
}

/// Points a node at a copy of its mesh, without morph targets and skin.
fn own_mesh(builder: &mut Builder<'_>, node: usize) -> Result<usize, AssetError> {
    let old = builder.json["nodes"][node]["mesh"].as_u64().unwrap_or(0) as usize;
    let mut copy = builder.array("meshes")?[old].clone();
    object(&mut copy, "a mesh")?.shift_remove("weights");
    for primitive in copy["primitives"].as_array_mut().into_iter().flatten() {
        object(primitive, "a primitive")?.shift_remove("targets");
    }
    let target = builder.add("meshes", copy)?;
    let node = object(&mut builder.array("nodes")?[node], "a node")?;
    node.insert("mesh".to_owned(), target.into());
    node.shift_remove("weights");
    node.shift_remove("skin");
    Ok(target)
}

/// A material for primitives whose `TEXCOORD_0` is the place in the base colour texture. The same index when nothing changes.
fn copy_material(
    builder: &mut Builder<'_>,
    (index, has_uvs): (usize, bool),
) -> Result<usize, AssetError> {
    let old = builder.array("materials")?.get(index).cloned();
    let old = old.ok_or_else(|| malformed("a primitive names no material"))?;
    let base = Lookup::of(base_color_texture(&old));
    let mut new = old.clone();
    retarget(&mut new, has_uvs.then_some(&base));
    if new == old {
        return Ok(index);
    }
    builder.add("materials", new)
}

/// The base colour texture of a material; that of the older specular-glossiness model where there is no other.
fn base_color_texture(material: &Value) -> &Value {
    match &material["pbrMetallicRoughness"] {
        Value::Null => {
            &material["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"]
        }
        pbr => &pbr["baseColorTexture"],
    }
}

/// Where a texture is looked up: the set of coordinates, and offset, rotation and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lookup {
    set: u64,
    transform: [f64; 5],
}

/// Set 0, as it is.
const PLAIN: Lookup = Lookup {
    set: 0,
    transform: [0.0, 0.0, 0.0, 1.0, 1.0],
};

impl Lookup {
    fn of(texture: &Value) -> Self {
        let transform = &texture["extensions"][TRANSFORM];
        let set = [&transform["texCoord"], &texture["texCoord"]];
        let number = |value: &Value, default: f64| value.as_f64().unwrap_or(default);
        let [offset, scale] = [&transform["offset"], &transform["scale"]];
        Self {
            set: set.into_iter().find_map(Value::as_u64).unwrap_or(0),
            transform: [
                number(&offset[0], 0.0),
                number(&offset[1], 0.0),
                number(&transform["rotation"], 0.0),
                number(&scale[0], 1.0),
                number(&scale[1], 1.0),
            ],
        }
    }
}

/// Textures looked up at `base` now read set 0 as it is; the others are removed.
fn retarget(value: &mut Value, base: Option<&Lookup>) {
    let Some(object) = value.as_object_mut() else {
        return;
    };
    let is_texture = |key: &str, value: &Value| {
        (key.ends_with("Texture") || key.ends_with("texture")) && value.get("index").is_some()
    };
    object.retain(|key, value| !is_texture(key, value) || base == Some(&Lookup::of(value)));
    for (key, value) in object.iter_mut() {
        if is_texture(key, value) {
            if base != Some(&PLAIN) {
                make_plain(value);
            }
        } else if !matches!(key.as_str(), "extras" | "name") {
            retarget(value, base);
        }
    }
}

/// Set 0 without a transform.
fn make_plain(texture: &mut Value) {
    let Some(texture) = texture.as_object_mut() else {
        return;
    };
    texture.shift_remove("texCoord");
    if let Some(extensions) = texture.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.shift_remove(TRANSFORM);
        if extensions.is_empty() {
            texture.shift_remove("extensions");
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn textures_at_other_coordinates_leave_the_copy() {
        let moved = json!({ TRANSFORM: { "offset": [0.5, 0.0], "texCoord": 1 } });
        let same = json!({ TRANSFORM: { "offset": [0.5, 0.0], "rotation": 0.0 } });
        let mut material = json!({
            "name": "tiles",
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0, "texCoord": 0, "extensions": moved },
                "metallicRoughnessTexture": { "index": 1, "texCoord": 1, "extensions": same },
            },
            "normalTexture": { "index": 2, "texCoord": 1 },
            "extensions": { "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 3 } } },
        });
        let base = Lookup::of(&material["pbrMetallicRoughness"]["baseColorTexture"]);
        retarget(&mut material, Some(&base));
        let expected = json!({
            "name": "tiles",
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0 },
                "metallicRoughnessTexture": { "index": 1 },
            },
            "extensions": { "KHR_materials_clearcoat": {} },
        });
        assert_eq!(material, expected);
    }

    #[test]
    fn plain_materials_stay_as_they_are() {
        let material = json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 0 } },
            "normalTexture": { "index": 1, "scale": 0.5 },
        });
        let base = Lookup::of(&material["pbrMetallicRoughness"]["baseColorTexture"]);
        let mut copy = material.clone();
        retarget(&mut copy, Some(&base));
        assert_eq!(copy, material);
    }
}
