//! The parts of a glTF document that importing reads, typed. Numbers are f64 and indices unchecked: whoever follows one checks it.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::super::SceneError;
use crate::files::printable;

/// A glTF document after [`super::merge`]: one buffer, no URIs.
#[derive(Debug)]
pub(super) struct Root {
    pub(super) scene: Option<usize>,
    pub(super) extensions_used: Vec<String>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) images: Vec<Image>,
    pub(super) materials: Vec<MaterialJson>,
    pub(super) meshes: Vec<MeshJson>,
    pub(super) nodes: Vec<Node>,
    pub(super) samplers: Vec<SamplerJson>,
    pub(super) scenes: Vec<SceneJson>,
    pub(super) textures: Vec<TextureJson>,
    pub(super) has_animations: bool,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    /// Of indices only.
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) name: Option<String>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MaterialJson {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: Option<Pbr>,
    pub(super) normal_texture: Option<NormalTextureInfo>,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f32>,
    pub(super) double_sided: bool,
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Option<Specular>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Specular {
    pub(super) specular_factor: f32,
}

impl Default for Specular {
    fn default() -> Self {
        Self {
            specular_factor: 1.0,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Pbr {
    pub(super) base_color_factor: [f32; 4],
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: f32,
    pub(super) roughness_factor: f32,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

impl Default for Pbr {
    fn default() -> Self {
        Self {
            base_color_factor: [1.0; 4],
            base_color_texture: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness_texture: None,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SpecularGlossiness {
    pub(super) diffuse_factor: [f32; 4],
    pub(super) diffuse_texture: Option<TextureInfo>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: usize,
    #[serde(default)]
    pub(super) extensions: TextureInfoExtensions,
}

#[derive(Debug, Deserialize)]
pub(super) struct NormalTextureInfo {
    #[serde(flatten)]
    pub(super) info: TextureInfo,
    #[serde(default = "one")]
    pub(super) scale: f32,
}

fn one() -> f32 {
    1.0
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureTransform {
    pub(super) offset: [f64; 2],
    pub(super) rotation: f64,
    pub(super) scale: [f64; 2],
    pub(super) tex_coord: Option<usize>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            rotation: 0.0,
            scale: [1.0; 2],
            tex_coord: None,
        }
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct MeshJson {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
    #[serde(default)]
    pub(super) weights: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    #[serde(default)]
    pub(super) targets: Vec<serde::de::IgnoredAny>,
}

fn triangles() -> u32 {
    4
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SamplerJson {
    pub(super) mag_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneJson {
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureJson {
    pub(super) sampler: Option<usize>,
    pub(super) source: Option<usize>,
}

impl Root {
    /// Types a document; an error names the element it is in.
    pub(super) fn from_value(json: &Value) -> Result<Self, SceneError> {
        check_version(json)?;
        Ok(Self {
            scene: member(json, "scene")?,
            extensions_used: list(json, "extensionsUsed")?,
            accessors: list(json, "accessors")?,
            buffers: list(json, "buffers")?,
            buffer_views: list(json, "bufferViews")?,
            images: list(json, "images")?,
            materials: list(json, "materials")?,
            meshes: list(json, "meshes")?,
            nodes: list(json, "nodes")?,
            samplers: list(json, "samplers")?,
            scenes: list(json, "scenes")?,
            textures: list(json, "textures")?,
            has_animations: json.get("animations").is_some(),
        })
    }
}

/// The element an index names, or an error at the place that names it.
pub(super) fn get<'a, T>(
    elements: &'a [T],
    index: usize,
    what: &str,
    place: &str,
) -> Result<&'a T, SceneError> {
    elements.get(index).ok_or_else(|| {
        let count = elements.len();
        SceneError::gltf(
            place,
            format!("names {what} {index}, but there are {count}; re-export"),
        )
    })
}

fn check_version(json: &Value) -> Result<(), SceneError> {
    let asset = json.get("asset");
    let text = |key| {
        asset
            .and_then(|asset| asset.get(key))
            .and_then(Value::as_str)
    };
    match (text("version"), text("minVersion")) {
        (Some(version), None | Some("2.0")) if version.starts_with("2.") => Ok(()),
        (version, minimum) => {
            let found = minimum.or(version).unwrap_or("none");
            Err(SceneError::gltf(
                "asset",
                format!(
                    "glTF version is {}; Relume reads 2.0; export that",
                    printable(found)
                ),
            ))
        }
    }
}

fn member<T: DeserializeOwned>(json: &Value, key: &str) -> Result<Option<T>, SceneError> {
    let value = json.get(key);
    value
        .map(|value| typed(value, || key.to_owned()))
        .transpose()
}

/// A top-level array; missing is empty.
pub(super) fn list<T: DeserializeOwned>(json: &Value, key: &str) -> Result<Vec<T>, SceneError> {
    match json.get(key) {
        None => Ok(Vec::new()),
        Some(Value::Array(elements)) => elements
            .iter()
            .enumerate()
            .map(|(i, element)| typed(element, || format!("{key}[{i}]")))
            .collect(),
        Some(_) => Err(SceneError::gltf(key, "is not an array; re-export")),
    }
}

fn typed<T: DeserializeOwned>(
    value: &Value,
    place: impl FnOnce() -> String,
) -> Result<T, SceneError> {
    T::deserialize(value).map_err(|error| {
        SceneError::gltf(
            place(),
            format!("{}; re-export", printable(&error.to_string())),
        )
    })
}
