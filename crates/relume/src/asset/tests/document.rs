//! A glTF document that holds what Relume does not know.

use serde_json::{Value, json};

use crate::scene::Document;

/// One vertex: position, normal, texture coordinates.
fn vertex(x: f32, y: f32, u: f32) -> [f32; 8] {
    [x, y, 0.25, 0.0, 0.0, 1.0, u, y]
}

/// A rectangle with interleaved attributes, drawn by three primitives (lines, textured, without material) on two nodes; extras, unknown
/// extensions, a camera, a texture transform. The first node of the default scene is not the first in the file.
pub fn document() -> Document {
    let corners = [
        vertex(0.0, 0.0, 0.0),
        vertex(2.0, 0.0, 1.0),
        vertex(2.0, 1.0, 1.0),
        vertex(0.0, 1.0, 0.0),
    ];
    let corners = corners.as_flattened().iter();
    let mut bin: Vec<u8> = corners.flat_map(|c| c.to_le_bytes()).collect();
    bin.extend([0, 1, 2, 0, 2, 3, 9, 9]);
    let png = png();
    bin.extend(&png);
    let json = json!({
        "asset": { "version": "2.0", "copyright": "nobody" },
        "extensionsUsed": ["KHR_texture_transform", "EXT_something"],
        "extras": { "note": [1, 2.5, 1e-7, "\u{e9}"] },
        "scene": 0,
        "scenes": [{ "nodes": [1, 0] }],
        "nodes": [
            { "mesh": 0, "name": "first", "translation": [1, 0, 0],
              "extensions": { "EXT_something": { "x": 1 } } },
            { "children": [2, 3] },
            { "mesh": 0, "scale": [-1, 1, 1] },
            { "camera": 0 },
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "meshes": [{ "primitives": primitives() }],
        "materials": [material()],
        "textures": [{ "source": 0 }],
        "images": [{ "bufferView": 2, "mimeType": "image/png" }],
        "accessors": accessors(),
        "bufferViews": [
            { "buffer": 0, "byteLength": 128, "byteStride": 32, "target": 34962 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 6, "target": 34963 },
            { "buffer": 0, "byteOffset": 136, "byteLength": png.len() },
        ],
        "buffers": [{ "byteLength": bin.len(), "name": "all" }],
    });
    Document { json, bin }
}

fn primitives() -> Value {
    json!([
        { "attributes": { "POSITION": 0 }, "mode": 1 },
        { "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "TEXCOORD_1": 2 },
          "indices": 3, "material": 0, "extras": "kept" },
        { "attributes": { "POSITION": 0 }, "indices": 3 },
    ])
}

/// Two textures are looked up at the same place, one elsewhere.
fn material() -> Value {
    let moved = json!({ "KHR_texture_transform": {
        "offset": [0.125, 0.5], "rotation": 0.3, "scale": [3.0, 0.7] } });
    json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0, "texCoord": 1, "extensions": moved },
            "metallicRoughnessTexture": { "index": 0, "texCoord": 1, "extensions": moved },
        },
        "emissiveTexture": { "index": 0 },
    })
}

fn accessors() -> Value {
    let floats = |offset: u32, kind: &str| json!({ "bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": 4, "type": kind });
    let mut position = floats(0, "VEC3");
    position["min"] = json!([0.0, 0.0, 0.25]);
    position["max"] = json!([2.0, 1.0, 0.25]);
    let indices = json!({ "bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR" });
    json!([position, floats(12, "VEC3"), floats(24, "VEC2"), indices])
}

/// A picture of 2 × 1 texels.
fn png() -> Vec<u8> {
    let texels = [200, 10, 60, 255, 0, 128, 255, 255];
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_raw(2, 1, texels.to_vec()).unwrap();
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}
