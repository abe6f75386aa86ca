use glam::Vec2;
use serde_json::json;

use super::super::super::{AlphaMode, Wrap};
use super::super::*;
use super::*;

#[test]
fn materials_keep_what_diffuse_transfer_needs() {
    let mut maker = Maker::triangle();
    maker.json["materials"] = json!([
        {"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
         "normalTexture": {"index": 0},
         "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5}},
        {"alphaMode": "MASK"},
        {"alphaMode": "BLEND"},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.5, 0.5, 1]}}}
    ]);
    maker.primitive()["material"] = 0.into();
    let scene = maker.read().unwrap();
    let [leaf, cut, glass, old] = &scene.materials[..] else {
        panic!()
    };
    assert_eq!(
        (leaf.name.as_str(), leaf.alpha),
        ("leaf", AlphaMode::Mask(0.25))
    );
    assert_eq!(leaf.base_color, [0.1, 0.2, 0.3, 0.4]);
    assert!(leaf.double_sided && leaf.has_normal_map && leaf.metallic == 0.5);
    assert_eq!(
        (cut.alpha, glass.alpha),
        (AlphaMode::Mask(0.5), AlphaMode::Opaque)
    );
    assert_eq!((cut.metallic, cut.base_color), (1.0, [1.0; 4]));
    assert_eq!(old.base_color, [0.5, 0.5, 0.5, 1.0]);
    assert!(scene.warnings.iter().any(|w| w.contains("BLEND")));
    assert_eq!(scene.meshes[0].groups[0].material, 0);
    maker.primitive()["material"] = 4.into();
    assert!(maker.message().contains("names material 4"));
    maker.json["materials"][0]["alphaMode"] = "GLOW".into();
    assert!(maker.message().contains("alphaMode GLOW"));
}

#[test]
fn a_quarter_turn_of_coordinates_follows_the_extension() {
    // Counter-clockwise as seen on the image, v down: right (1, 0) goes to up (0, −1). Then scale acts first, offset last.
    let lookup = |transform| {
        let info: json::TextureInfo = serde_json::from_value(
            json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": transform}}),
        )
        .unwrap();
        material::lookup(&info)
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = lookup(json!({"rotation": quarter}));
    assert_eq!(turned.set, 1);
    assert!((turned.apply([1.0, 0.0]) - Vec2::new(0.0, -1.0)).length() < 1e-7);
    let all = lookup(
        json!({"rotation": quarter, "scale": [2.0, 3.0], "offset": [10.0, 20.0], "texCoord": 0}),
    );
    assert_eq!(all.set, 0);
    assert!((all.apply([1.0, 1.0]) - Vec2::new(13.0, 18.0)).length() < 1e-5);
}

/// A 2 × 1 image: red, then green at half alpha.
#[cfg(feature = "images")]
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 128])
        .unwrap()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[cfg(feature = "images")]
fn textured() -> Maker {
    let mut maker = Maker::triangle();
    let view = maker.view(&png());
    let uv = maker.accessor(5121, "VEC2", 3, &[0, 0, 255, 0, 51, 255]);
    maker.json["accessors"][uv]["normalized"] = true.into();
    maker.attribute("TEXCOORD_1", uv);
    maker.primitive()["material"] = 1.into();
    maker.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    maker.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    maker.json["textures"] =
        json!([{"source": 0, "sampler": 0}, {"source": 0, "sampler": 0}, {"source": 0}]);
    let material = |texture: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture, "texCoord": 1}}});
    maker.json["materials"] = json!([material(0), material(1), material(2)]);
    maker
}

#[cfg(feature = "images")]
#[test]
fn base_colour_textures_come_with_their_sampler_and_coordinates() {
    let scene = textured().read().unwrap();
    let used: Vec<_> = scene
        .materials
        .iter()
        .map(|m| m.base_color_texture)
        .collect();
    assert_eq!(used, [Some(0), Some(0), Some(1)]);
    let texture = &scene.textures[0];
    assert_eq!(texture.texels, [[255, 0, 0, 255], [0, 255, 0, 128]]);
    assert_eq!(
        (texture.sampler.wrap_u, texture.sampler.wrap_v),
        (Wrap::Clamp, Wrap::Mirror)
    );
    assert!(texture.sampler.nearest && !scene.textures[1].sampler.nearest);
    assert_eq!(
        scene.meshes[0].uvs,
        [Vec2::ZERO, Vec2::X, Vec2::new(0.2, 1.0)]
    );

    let mut broken = textured();
    broken.json["images"][0]["bufferView"] = 0.into();
    assert!(broken.message().contains("neither PNG nor JPEG"));
    let mut broken = textured();
    broken.json["textures"][1]["source"] = 4.into();
    assert!(broken.message().contains("names image 4"));
    let mut missing = textured();
    missing.primitive()["attributes"]
        .as_object_mut()
        .unwrap()
        .remove("TEXCOORD_1");
    let scene = missing.read().unwrap();
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("has no TEXCOORD_1")),
        "{:?}",
        scene.warnings
    );
    let mut unknown = textured();
    unknown.json["textures"][1]
        .as_object_mut()
        .unwrap()
        .remove("source");
    let scene = unknown.read().unwrap();
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("1 base colour textures were left out"))
    );
}

/// The same scene as a `.gltf` with its parts beside it and in data URIs.
#[cfg(all(feature = "images", feature = "import"))]
#[test]
fn scattered_parts_are_gathered_into_one_buffer() {
    use crate::scene::{ImportOptions, load};
    use base64::Engine;

    let whole = textured();
    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("my parts");
    std::fs::create_dir(&parts).unwrap();
    std::fs::write(parts.join("geometry ä.bin"), &whole.bin).unwrap();
    std::fs::write(parts.join("image.png"), png()).unwrap();
    let mut json = whole.json.clone();
    let extra = base64::engine::general_purpose::STANDARD.encode([1u8, 2, 3, 4, 5]);
    json["buffers"] = json!([
        {"byteLength": 5, "uri": format!("data:application/octet-stream;base64,{extra}"), "name": "first"},
        {"byteLength": whole.bin.len(), "uri": "my%20parts/geometry%20%C3%A4.bin"}
    ]);
    for view in json["bufferViews"].as_array_mut().unwrap() {
        view["buffer"] = 1.into();
    }
    let inline = base64::engine::general_purpose::STANDARD_NO_PAD.encode(png());
    json["images"] = json!([
        {"uri": "my%20parts/image.png", "name": "photo"},
        {"uri": format!("data:image/png;base64,{inline}")},
        whole.json["images"][0]
    ]);
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    let scene = load(&path, &ImportOptions::default()).unwrap();
    assert_eq!(
        scene.meshes[0].positions,
        whole.read().unwrap().meshes[0].positions
    );
    assert_eq!(
        scene.textures[0].texels,
        [[255, 0, 0, 255], [0, 255, 0, 128]]
    );

    let document = scene.document.unwrap();
    let views = document.json["bufferViews"].as_array().unwrap();
    let slice = |image: usize| {
        let view = &views[document.json["images"][image]["bufferView"]
            .as_u64()
            .unwrap() as usize];
        let [start, length] =
            ["byteOffset", "byteLength"].map(|k| view[k].as_u64().unwrap() as usize);
        assert_eq!(start % 4, 0);
        &document.bin[start..start + length]
    };
    assert_eq!([slice(0), slice(1), slice(2)], [&png()[..]; 3]);
    assert_eq!(document.json["images"][0]["mimeType"], "image/png");
    let expected = json!([{"byteLength": document.bin.len(), "name": "first"}]);
    assert_eq!(document.json["buffers"], expected);
    assert_eq!(document.bin[..5], [1, 2, 3, 4, 5]);
    assert!(!document.json.to_string().contains("uri"));
    // What was gathered reads as a .glb of its own, and is left as it is.
    let again = from_glb(&glb(document.json.to_string().as_bytes(), &document.bin)).unwrap();
    assert_eq!(again.document.unwrap().json, document.json);

    for (uri, expected) in [
        ("../secret.png", "leads out of the scene's folder"),
        ("file:///secret.png", "scheme other than data:"),
        ("my%20parts/none.png", "cannot read"),
        ("data:image/png;base64,???", "broken data: URI"),
        ("data:nothing", "broken data: URI"),
    ] {
        json["images"][1]["uri"] = uri.into();
        std::fs::write(&path, json.to_string()).unwrap();
        let message = load(&path, &ImportOptions::default())
            .unwrap_err()
            .to_string();
        assert!(message.contains(expected), "{message}");
    }
    // From bytes alone there is nothing beside the file.
    let message = from_glb(&glb(json.to_string().as_bytes(), b""))
        .unwrap_err()
        .to_string();
    assert!(message.contains("given as bytes alone"), "{message}");
}
