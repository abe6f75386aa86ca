use glam::Vec2;
use serde_json::json;

use super::super::super::AlphaMode;
#[cfg(feature = "images")]
use super::super::super::Wrap;
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
pub(super) fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 128])
        .unwrap()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[cfg(feature = "images")]
pub(super) fn textured() -> Maker {
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
            .any(|w| w.contains("1 textures were left out; their factors"))
    );
}

#[cfg(feature = "images")]
fn with_all_maps() -> Maker {
    let mut maker = textured();
    let normals = maker.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    maker.attribute("NORMAL", normals);
    let material = &mut maker.json["materials"][1];
    material["normalTexture"] = json!({"index": 2, "texCoord": 1, "scale": 0.5});
    let pbr = &mut material["pbrMetallicRoughness"];
    pbr["metallicRoughnessTexture"] = json!({"index": 0, "texCoord": 1});
    maker
}

#[cfg(feature = "images")]
#[test]
fn maps_are_read_where_they_are_asked_for() {
    let read = |maker: &Maker, maps| with_maps(&maker.glb(), maps).unwrap();
    let maker = with_all_maps();
    let plain = read(&maker, Maps::Color);
    assert!(plain.materials[1].normal_texture.is_none() && plain.meshes[0].tangents.is_empty());
    assert!(plain.materials[1].has_normal_map);
    let scene = read(&maker, Maps::All);
    let material = &scene.materials[1];
    // The first sampler's image is texture 0, the last one's texture 1.
    assert_eq!(material.metallic_roughness_texture, Some(0));
    let normal = material.normal_texture.unwrap();
    assert_eq!((normal.texture, normal.scale), (1, 0.5));
    // u grows along (1, 0) and v along (0, 1) but for a shear: worked out, since the file has none.
    let tangents = &scene.meshes[0].tangents;
    assert_eq!(tangents.len(), 3);
    for tangent in tangents {
        let along = tangent.truncate();
        assert!((along.length() - 1.0).abs() < 1e-6 && along.z == 0.0 && along.x > 0.9);
        // v runs down the image and along +y here, so that up in it is −y.
        assert_eq!(tangent.w, -1.0);
    }

    let mut given = with_all_maps();
    let values = [[0.6, 0.8, 0.0, 1.0]; 3];
    let tangents = given.floats("VEC4", values.as_flattened());
    given.attribute("TANGENT", tangents);
    let scene = read(&given, Maps::All);
    assert_eq!(scene.meshes[0].tangents, values.map(glam::Vec4::from));

    let mut elsewhere = with_all_maps();
    elsewhere.json["materials"][1]["normalTexture"]["texCoord"] = 0.into();
    let scene = read(&elsewhere, Maps::All);
    assert!(scene.materials[1].normal_texture.is_none());
    let told = |w: &String| w.contains("1 textures were left out: they are looked up elsewhere");
    assert!(scene.warnings.iter().any(told), "{:?}", scene.warnings);
}
