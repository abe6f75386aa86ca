//! Emissive surfaces of glTF.

use std::path::PathBuf;

use glam::DVec3;

use super::*;
use crate::light::emitter::Shape;

/// The triangle (0, 0, 0), (1, 0, 0), (0, 1, 0), its texture coordinates and, where there are images, one of 2 × 1 pixels. `materials` and
/// `nodes` are the document's; primitive i of mesh 0 has material i.
fn glb(materials: &Value, nodes: &Value, image: &[u8]) -> Vec<u8> {
    let floats: [f32; 15] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, //
        0.25, 0.5, 0.75, 0.5, 0.25, 1.0,
    ];
    let mut bin: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(image);
    bin.resize(bin.len().next_multiple_of(4), 0);
    let primitive =
        |material| json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": material});
    let primitives: Vec<Value> = (0..materials.as_array().unwrap().len())
        .map(primitive)
        .collect();
    let roots: Vec<usize> = (0..nodes.as_array().unwrap().len()).collect();
    let mut document = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": roots}], "nodes": nodes, "materials": materials,
        "meshes": [{"name": "lamps", "primitives": primitives}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
        ],
        "buffers": [{"byteLength": bin.len()}],
    });
    if !image.is_empty() {
        let view = json!({"buffer": 0, "byteOffset": 60, "byteLength": image.len()});
        document["bufferViews"].as_array_mut().unwrap().push(view);
        document["images"] = json!([{"bufferView": 2, "mimeType": "image/png"}]);
        document["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}, {}]);
        document["samplers"] = json!([{"wrapS": 33071}]);
    }
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for word in [2, 28 + text.len() + bin.len(), text.len()] {
        out.extend((word as u32).to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(text);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

/// The file on disk, which is gone when the folder is dropped.
fn written(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamps.glb");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn read(materials: &Value, nodes: &Value, image: &[u8]) -> (Vec<Emitter>, Vec<String>) {
    let (_folder, path) = written(&glb(materials, nodes, image));
    let (set, warnings) = load(&path).unwrap();
    let begin = format!("{}: ", path.display());
    let said = warnings
        .iter()
        .map(|w| w.strip_prefix(&begin).unwrap().to_owned());
    (set.emitters().to_vec(), said.collect())
}

fn refused(materials: &Value, image: &[u8]) -> String {
    let (_folder, path) = written(&glb(materials, &json!([{"mesh": 0}]), image));
    let message = line(load(&path));
    assert!(
        message.starts_with(&path.display().to_string()),
        "{message}"
    );
    message
}

fn mesh(emitter: &Emitter) -> &EmitterMesh {
    match &emitter.shape {
        Shape::Mesh(mesh) => mesh,
        Shape::Sphere { .. } => panic!("a mesh"),
    }
}

#[test]
fn emissive_primitives_shine_with_factor_and_strength_and_others_are_counted() {
    let strength = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 8}});
    let (emitters, warnings) = read(
        &json!([
            {"emissiveFactor": [1, 0.5, 0.25]},
            {"emissiveFactor": [0, 0, 0]},
            {},
            {"emissiveFactor": [1, 0.5, 0], "extensions": strength, "doubleSided": true},
        ]),
        &json!([{"mesh": 0, "name": "left"}, {"mesh": 0, "translation": [0, 0, 5]}]),
        b"",
    );
    let names: Vec<&str> = emitters.iter().map(|e| e.name.as_str()).collect();
    let mesh_names = ["lamps, primitive 0", "lamps, primitive 3"];
    assert_eq!(
        names,
        [
            "left, primitive 0",
            "left, primitive 3",
            mesh_names[0],
            mesh_names[1]
        ]
    );
    assert_eq!(emitters[0].pattern, Pattern::Uniform([1.0, 0.5, 0.25]));
    assert_eq!(emitters[3].pattern, Pattern::Uniform([8.0, 4.0, 0.0]));
    assert_eq!(
        emitters.iter().map(|e| e.two_sided).collect::<Vec<_>>(),
        [false, true, false, true]
    );
    assert_eq!(mesh(&emitters[2]).positions[1], DVec3::new(1.0, 0.0, 5.0));
    let dark = "4 of 8 primitives are not emissive; they neither shine nor block";
    assert!(
        warnings.iter().any(|warning| warning == dark),
        "{warnings:?}"
    );
}

#[test]
fn nodes_place_and_mirrors_are_turned_back() {
    // Turned a quarter about +y, +x goes to −z; then mirrored in x and made twice as large. What faced +z faces +x.
    let half = 0.5_f64.sqrt();
    let turned = json!({"mesh": 0, "rotation": [0, half, 0, half], "translation": [1, 0, 0]});
    let mirrored = json!({"mesh": 0, "scale": [-2, 2, 2]});
    let (emitters, _) = read(
        &json!([{"emissiveFactor": [1, 1, 1]}]),
        &json!([turned, mirrored]),
        b"",
    );
    let normal = |emitter: &Emitter| {
        let mesh = mesh(emitter);
        let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[mesh.faces[0][i] as usize]);
        (b - a).cross(c - a)
    };
    assert!((mesh(&emitters[0]).positions[1] - DVec3::new(1.0, 0.0, -1.0)).length() < 1e-6);
    assert!((normal(&emitters[0]) - DVec3::X).length() < 1e-6);
    assert_eq!(mesh(&emitters[1]).positions[1], DVec3::new(-2.0, 0.0, 0.0));
    assert_eq!(mesh(&emitters[1]).faces, [[0, 2, 1]]);
    assert!((normal(&emitters[1]) - 4.0 * DVec3::Z).length() < 1e-6);
}

#[cfg(feature = "images")]
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_raw(2, 1, vec![255, 188, 0, 0, 0, 255])
        .unwrap()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[cfg(feature = "images")]
#[test]
fn textures_are_linearised_and_looked_up_where_their_material_says() {
    let moved = json!({"KHR_texture_transform": {"offset": [1, 2], "scale": [2, 1]}});
    let one = [1, 1, 1];
    let (emitters, warnings) = read(
        &json!([
            {"emissiveFactor": [2, 1, 1], "emissiveTexture": {"index": 0}},
            {"emissiveFactor": one, "emissiveTexture": {"index": 0, "extensions": moved}},
            {"emissiveFactor": one, "emissiveTexture": {"index": 1}},
            {"emissiveFactor": one, "emissiveTexture": {"index": 1, "extensions": moved}, "name": "clamped"},
            {"emissiveFactor": one, "emissiveTexture": {"index": 0, "texCoord": 1}},
            {"emissiveFactor": one, "emissiveTexture": {"index": 0}, "alphaMode": "MASK", "name": "cut"},
        ]),
        &json!([{"mesh": 0}]),
        &png(),
    );
    let Pattern::Texture { image, factor } = &emitters[0].pattern else {
        panic!("a texture")
    };
    // sRGB 188 is a half: ((188/255 + 0.055) / 1.055)^2.4 = 0.5029.
    let [r, g, b] = image.pixel(0, 0);
    assert!(r == 1.0 && (g - 0.5029).abs() < 1e-4 && b == 0.0);
    assert_eq!(
        (image.pixel(1, 0), *factor),
        ([0.0, 0.0, 1.0], [2.0, 1.0, 1.0])
    );
    let uv = |i: usize| mesh(&emitters[i]).uvs[0];
    assert_eq!(uv(0), glam::Vec2::new(0.25, 0.5));
    assert_eq!(uv(1), glam::Vec2::new(1.5, 2.5));
    assert_eq!(uv(4), glam::Vec2::ZERO);
    let about = |what: &str| {
        warnings
            .iter()
            .filter(|warning| warning.contains(what))
            .count()
    };
    assert_eq!(about("has no TEXCOORD_1"), 1);
    assert_eq!(about("\"clamped\" clamps or mirrors"), 1);
    assert_eq!(
        about("clamps or mirrors"),
        1,
        "inside 0…1 nothing is clamped"
    );
    assert_eq!(about("\"cut\" has holes"), 1);
}

#[test]
fn what_does_not_shine_or_hold_together_is_refused() {
    let message = refused(&json!([{}, {"emissiveFactor": [0, 0, 0]}]), b"");
    assert!(
        message.contains("none of its 2 primitives is emissive"),
        "{message}"
    );
    let bright = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 1e30}});
    for (material, needle) in [
        (json!({"emissiveFactor": [1, 1]}), "materials[0]"),
        (json!({"emissiveFactor": [1, 1, -1]}), "not negative"),
        (
            json!({"emissiveFactor": [1, 1, 1], "extensions": bright}),
            "at most 1e20",
        ),
        (
            json!({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 9}}),
            "names texture 9",
        ),
    ] {
        let message = refused(&json!([material]), b"");
        assert!(message.contains(needle), "{message}");
    }
}

#[cfg(feature = "images")]
#[test]
fn an_emissive_texture_without_an_image_is_refused_rather_than_white() {
    let white = json!({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 2}});
    let message = refused(&json!([white]), &png());
    assert!(
        message.contains("materials[0].emissiveTexture: has no PNG or JPEG"),
        "{message}"
    );
}

#[test]
fn more_corners_than_are_worked_with_are_refused_before_they_are_made() {
    let bytes = glb(
        &json!([{"emissiveFactor": [1, 1, 1]}]),
        &json!([{"mesh": 0}, {"mesh": 0}]),
        b"",
    );
    let mut scene = crate::scene::gltf::from_glb(&bytes).unwrap();
    let message = crate::scene::gltf::emission(&mut scene, 5)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("6 corners of emissive triangles, more than the 5"),
        "{message}"
    );
    assert_eq!(
        crate::scene::gltf::emission(&mut scene, 6).unwrap().len(),
        2
    );
}

#[cfg(feature = "bake")]
#[test]
fn a_baked_asset_still_shines() {
    use crate::asset::{Asset, write};
    use crate::bake::{BakeOptions, Monitor, bake};
    use crate::scene::World;

    let shining = json!([{"emissiveFactor": [1, 0.5, 0.25]}]);
    let bytes = glb(
        &shining,
        &json!([{"mesh": 0, "translation": [0, 1, 0]}]),
        b"",
    );
    let (folder, path) = written(&bytes);
    let scene = crate::scene::gltf::from_glb(&bytes).unwrap();
    let options = BakeOptions {
        shadows: false,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &false.into(),
    };
    let transfer = bake(&World::new(&scene), &options, &monitor);
    let transfer = transfer.unwrap().transfer;
    let baked = folder.path().join("baked.glb");
    write(&Asset { scene, transfer }, &baked).unwrap();
    let emitters = |path: &Path| load(path).unwrap().0.emitters().to_vec();
    assert_eq!(emitters(&baked), emitters(&path));
}
