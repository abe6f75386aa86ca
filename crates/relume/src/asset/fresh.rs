//! A minimal glTF for scenes that did not come from one: PLY, OBJ and scenes built in memory.

use glam::DAffine3;
use serde_json::{Map, Value, json};

use super::AssetError;
use super::builder::Builder;
use super::container::Part;
use crate::brdf::Reflection;
use crate::files::printable;
use crate::scene::{AlphaMode, Group, Instance, Material, Mesh, Scene, Texture, Wrap};

/// The scene as a document: one node per instance, in order; one glTF mesh per mesh that is used, with one primitive per group of
/// triangles. The primitives of a mesh share its vertices, and all of them are kept, used or not.
pub fn build(scene: &Scene) -> Result<Builder<'_>, AssetError> {
    let mut builder = Builder::empty();
    builder.json["scene"] = 0.into();
    let roots: Vec<usize> = (0..scene.instances.len()).collect();
    builder.json["scenes"] = json!([{ "nodes": roots }]);
    for (i, texture) in scene.textures.iter().enumerate() {
        add_texture(&mut builder, texture, i)?;
    }
    for material in &scene.materials {
        builder.add("materials", material_json(material, scene.textures.len())?)?;
    }
    if scene.materials.iter().any(is_diffuse) {
        builder.array("extensionsUsed")?.push(SPECULAR.into());
    }
    let mut meshes = vec![None; scene.meshes.len()];
    for (i, instance) in scene.instances.iter().enumerate() {
        let mesh = match meshes[instance.mesh] {
            Some(mesh) => mesh,
            None => add_mesh(&mut builder, &scene.meshes[instance.mesh])?,
        };
        meshes[instance.mesh] = Some(mesh);
        builder.add("nodes", node_json(instance, mesh, i)?)?;
    }
    Ok(builder)
}

/// The groups that become primitives.
pub fn groups(mesh: &Mesh) -> impl Iterator<Item = &Group> {
    mesh.groups.iter().filter(|g| !g.triangles.is_empty())
}

fn add_mesh<'a>(builder: &mut Builder<'a>, mesh: &'a Mesh) -> Result<usize, AssetError> {
    let attributes = add_attributes(builder, mesh)?;
    let mut primitives = Vec::new();
    for group in groups(mesh) {
        let indices = builder.indices(&group.triangles, mesh.positions.len())?;
        let primitive =
            json!({ "attributes": attributes, "indices": indices, "material": group.material });
        primitives.push(primitive);
    }
    if primitives.is_empty() {
        return Err(unwritable(
            "mesh",
            &mesh.name,
            "has no triangles; leave it out",
        ));
    }
    let mut object = named(&mesh.name);
    object.insert("primitives".to_owned(), primitives.into());
    builder.add("meshes", object.into())
}

/// Every attribute a mesh has as accessors; `TEXCOORD_0` is what the base colour texture is looked up at.
pub fn add_attributes<'a>(
    builder: &mut Builder<'a>,
    mesh: &'a Mesh,
) -> Result<Map<String, Value>, AssetError> {
    check(mesh)?;
    let mut attributes = Map::new();
    let mut insert =
        |key: &str, accessor: usize| attributes.insert(key.to_owned(), accessor.into());
    let floats = Part::Floats(bytemuck::cast_slice(&mesh.positions));
    let position = builder.attribute(floats, 3)?;
    let first = mesh.positions[0];
    let points = || mesh.positions.iter().copied();
    let (min, max) = (
        points().fold(first, glam::Vec3::min),
        points().fold(first, glam::Vec3::max),
    );
    let accessor = &mut builder.array("accessors")?[position];
    accessor["min"] = json!(min.to_array());
    accessor["max"] = json!(max.to_array());
    insert("POSITION", position);
    let normals = Part::Floats(bytemuck::cast_slice(&mesh.normals));
    insert("NORMAL", builder.attribute(normals, 3)?);
    if !mesh.uvs.is_empty() {
        let uvs = Part::Floats(bytemuck::cast_slice(&mesh.uvs));
        insert("TEXCOORD_0", builder.attribute(uvs, 2)?);
    }
    if !mesh.tangents.is_empty() {
        let tangents = Part::Floats(bytemuck::cast_slice(&mesh.tangents));
        insert("TANGENT", builder.attribute(tangents, 4)?);
    }
    if !mesh.alphas.is_empty() {
        insert("COLOR_0", builder.attribute(color_and_alpha(mesh), 4)?);
    } else if !mesh.colors.is_empty() {
        let colors = Part::Floats(mesh.colors.as_flattened());
        insert("COLOR_0", builder.attribute(colors, 3)?);
    }
    Ok(attributes)
}

fn color_and_alpha<'a>(mesh: &Mesh) -> Part<'a> {
    let vertex = |(i, &alpha): (usize, &f32)| {
        let [r, g, b] = mesh.colors.get(i).copied().unwrap_or([1.0; 3]);
        [r, g, b, alpha].map(f32::to_le_bytes)
    };
    let bytes = mesh.alphas.iter().enumerate().flat_map(vertex).flatten();
    Part::Bytes(bytes.collect::<Vec<u8>>().into())
}

/// Refuses what would make the file invalid; indices have been checked.
fn check(mesh: &Mesh) -> Result<(), AssetError> {
    let wrong = |what: &str| Err(unwritable("mesh", &mesh.name, what));
    let count = mesh.positions.len();
    if count == 0 {
        return wrong("has no vertices; leave it out");
    }
    let fits = |n: usize| n == 0 || n == count;
    let optional = [
        mesh.uvs.len(),
        mesh.tangents.len(),
        mesh.colors.len(),
        mesh.alphas.len(),
    ];
    if mesh.normals.len() != count || !optional.into_iter().all(fits) {
        return wrong("has vertex arrays of different lengths");
    }
    let lengths = mesh.normals.iter().map(|n| n.length_squared());
    let unit = |l: f32| (l - 1.0).abs() <= 1e-3;
    if !mesh.positions.iter().all(|p| p.is_finite()) || !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        return wrong("has coordinates that are not finite");
    }
    if !lengths.into_iter().all(unit) {
        return wrong("has normals that are not of length 1");
    }
    let mut colors = mesh.colors.iter().flatten().chain(&mesh.alphas);
    if !colors.all(|c| (0.0..=1.0).contains(c)) {
        return wrong("has vertex colours outside 0…1, which glTF cannot say; scale them down");
    }
    Ok(())
}

fn node_json(instance: &Instance, mesh: usize, i: usize) -> Result<Value, AssetError> {
    let to_world = instance.world_from_object;
    let mut node = json!({ "mesh": mesh });
    if to_world != DAffine3::IDENTITY {
        if !is_trs(&to_world) {
            let what = "is sheared, which a glTF node cannot say; apply it to the vertices";
            return Err(unwritable("instance", &i.to_string(), what));
        }
        node["matrix"] = json!(glam::DMat4::from(to_world).to_cols_array());
    }
    Ok(node)
}

/// Whether an affine map is a scale, then a rotation, then a translation: its axes stay perpendicular.
fn is_trs(map: &DAffine3) -> bool {
    let m = map.matrix3;
    let pairs = [
        (m.x_axis, m.y_axis),
        (m.y_axis, m.z_axis),
        (m.z_axis, m.x_axis),
    ];
    // Rotations rounded to f32 are perpendicular to about 1e-7.
    let perpendicular = pairs.map(|(a, b)| a.dot(b).abs() <= 1e-6 * a.length() * b.length());
    map.is_finite() && m.determinant() != 0.0 && perpendicular == [true; 3]
}

/// The extension by which a dielectric has no highlight: what is left of it is Lambert.
const SPECULAR: &str = "KHR_materials_specular";

fn is_diffuse(material: &Material) -> bool {
    material.metallic == 0.0 && matches!(material.reflection, Reflection::Diffuse)
}

fn material_json(material: &Material, textures: usize) -> Result<Value, AssetError> {
    let factors = material.base_color.into_iter().chain([material.metallic]);
    if !factors.into_iter().all(|c| (0.0..=1.0).contains(&c)) {
        let what = "has a base colour outside 0…1, which glTF cannot say; scale it down";
        return Err(unwritable("material", &material.name, what));
    }
    let mut surface = json!({
        "baseColorFactor": material.base_color,
        "metallicFactor": material.metallic,
    });
    if let Reflection::MetallicRoughness { roughness, .. } = material.reflection {
        surface["roughnessFactor"] = roughness.into();
    }
    let named_texture = |texture: usize| match texture < textures {
        true => Ok(json!({ "index": texture })),
        false => Err(unwritable("material", &material.name, "names no texture")),
    };
    let maps = [
        ("baseColorTexture", material.base_color_texture),
        (
            "metallicRoughnessTexture",
            material.metallic_roughness_texture,
        ),
    ];
    for (key, texture) in maps {
        if let Some(texture) = texture {
            surface[key] = named_texture(texture)?;
        }
    }
    let mut object = named(&material.name);
    object.insert("pbrMetallicRoughness".to_owned(), surface);
    if let Some(map) = material.normal_texture {
        let mut normal = named_texture(map.texture)?;
        normal["scale"] = map.scale.into();
        object.insert("normalTexture".to_owned(), normal);
    }
    if let AlphaMode::Mask(cutoff) = material.alpha {
        object.insert("alphaMode".to_owned(), "MASK".into());
        object.insert("alphaCutoff".to_owned(), cutoff.into());
    }
    if material.double_sided {
        object.insert("doubleSided".to_owned(), true.into());
    }
    if is_diffuse(material) {
        let extensions = json!({ SPECULAR: { "specularFactor": 0.0 } });
        object.insert("extensions".to_owned(), extensions);
    }
    Ok(object.into())
}

fn add_texture(builder: &mut Builder<'_>, texture: &Texture, i: usize) -> Result<(), AssetError> {
    let png = Part::Bytes(png(texture, i)?.into());
    let view = builder.view(png)?;
    builder.add(
        "images",
        json!({ "bufferView": view, "mimeType": "image/png" }),
    )?;
    let sampler = texture.sampler;
    // NEAREST and LINEAR [gltf2, §5.26].
    let filter = if sampler.nearest { 9728 } else { 9729 };
    let sampler = json!({
        "magFilter": filter,
        "minFilter": filter,
        "wrapS": wrap(sampler.wrap_u),
        "wrapT": wrap(sampler.wrap_v),
    });
    let sampler = builder.add("samplers", sampler)?;
    builder.add("textures", json!({ "sampler": sampler, "source": i }))?;
    Ok(())
}

fn wrap(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Clamp => 33071,
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
    }
}

#[cfg(feature = "images")]
fn png(texture: &Texture, i: usize) -> Result<Vec<u8>, AssetError> {
    use image::ImageEncoder;
    let mut bytes = Vec::new();
    let (width, height) = (texture.width, texture.height);
    if u64::from(width) * u64::from(height) != texture.texels.len() as u64 {
        let what = "has another number of texels than its size says";
        return Err(unwritable("texture", &i.to_string(), what));
    }
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(
            texture.texels.as_flattened(),
            width,
            height,
            image::ExtendedColorType::Rgba8,
        )
        .map_err(|e| unwritable("texture", &i.to_string(), &format!("is no PNG: {e}")))?;
    Ok(bytes)
}

#[cfg(not(feature = "images"))]
fn png(_: &Texture, i: usize) -> Result<Vec<u8>, AssetError> {
    let what = "needs a PNG, but relume was built without the feature `images`; build it with it";
    Err(unwritable("texture", &i.to_string(), what))
}

/// An object with a name, or an empty one.
fn named(name: &str) -> Map<String, Value> {
    let mut object = Map::new();
    if !name.is_empty() {
        object.insert("name".to_owned(), name.into());
    }
    object
}

fn unwritable(kind: &str, name: &str, what: &str) -> AssetError {
    AssetError::Unwritable(format!("{kind} \"{}\" {what}", printable(name)))
}
