use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};

use super::super::{AlphaMode, World, Wrap};
use super::*;

/// A document in the making: a JSON object and the bytes its views lie in.
struct Maker {
    json: Value,
    bin: Vec<u8>,
}

impl Maker {
    /// One triangle at z = 0 in mesh 0 on node 0; accessor 0 holds its positions.
    fn triangle() -> Self {
        let mut maker = Self {
            json: json!({
                "asset": {"version": "2.0"},
                "scene": 0,
                "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}]
            }),
            bin: Vec::new(),
        };
        maker.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        maker
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let start = self.bin.len().next_multiple_of(4);
        self.bin.resize(start, 0);
        self.bin.extend_from_slice(bytes);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": bytes.len()}));
        views.len() - 1
    }

    fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(
            json!({"bufferView": view, "componentType": component, "count": count, "type": shape}),
        );
        accessors.len() - 1
    }

    fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let per = ["SCALAR", "VEC2", "VEC3", "VEC4"]
            .iter()
            .position(|&s| s == shape)
            .unwrap()
            + 1;
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(5126, shape, values.len() / per, &bytes)
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    fn attribute(&mut self, name: &str, accessor: usize) {
        self.primitive()["attributes"][name] = accessor.into();
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = self.bin.len().into();
        glb(json.to_string().as_bytes(), &self.bin)
    }

    fn read(&self) -> Result<Scene, SceneError> {
        from_glb(&self.glb())
    }

    fn message(&self) -> String {
        let message = self.read().unwrap_err().to_string();
        assert!(!message.contains('\n'), "{message}");
        message
    }
}

fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), with);
        padded
    };
    let (json, bin) = (padded(json, b' '), padded(bin, 0));
    let mut out = b"glTF".to_vec();
    for word in [2, (28 + json.len() + bin.len()) as u32, json.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(json);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

fn triangles(scene: &Scene) -> Vec<[u32; 3]> {
    scene.meshes[0].triangles().collect()
}

#[test]
fn a_bare_triangle_is_white_and_gets_normals() {
    let maker = Maker::triangle();
    let scene = maker.read().unwrap();
    assert_eq!(triangles(&scene), [[0, 1, 2]]);
    assert_eq!(scene.meshes[0].normals, [Vec3::Z; 3]);
    assert_eq!(scene.materials[0].base_color, [1.0; 4]);
    assert_eq!(scene.meshes[0].name, "mesh 0");
    assert_eq!(scene.source_hash.len(), 64);
    let document = scene.document.unwrap();
    assert_eq!(document.bin, maker.bin);
    assert_eq!(document.json["meshes"], maker.json["meshes"]);
}

/// Five points of a strip in the plane; what strips and fans make of them, written out from the specification.
fn fan_of_five(mode: u32) -> Scene {
    let mut maker = Maker::triangle();
    let points = [[0, 0], [0, 1], [1, 0], [1, 1], [2, 0]];
    let flat: Vec<f32> = points
        .iter()
        .flat_map(|&[x, y]| [x as f32, y as f32, 0.0])
        .collect();
    let accessor = maker.floats("VEC3", &flat);
    maker.attribute("POSITION", accessor);
    maker.primitive()["mode"] = mode.into();
    maker.read().unwrap()
}

#[test]
fn strips_and_fans_unroll_with_their_winding() {
    assert_eq!(
        triangles(&fan_of_five(5)),
        [[0, 1, 2], [1, 3, 2], [2, 3, 4]]
    );
    // (2, 0, …): the last triangle of the fan lies on the x axis only in part; none is flat but (0, 0), (1, 0), (2, 0).
    assert_eq!(
        triangles(&fan_of_five(6)),
        [[1, 2, 0], [2, 3, 0], [3, 4, 0]]
    );
}

#[test]
fn every_index_type_is_read() {
    let indices = [2u32, 0, 1];
    let bytes: [(u32, Vec<u8>); 3] = [
        (5121, indices.iter().map(|&i| i as u8).collect()),
        (
            5123,
            indices
                .iter()
                .flat_map(|&i| (i as u16).to_le_bytes())
                .collect(),
        ),
        (
            5125,
            indices.iter().flat_map(|&i| i.to_le_bytes()).collect(),
        ),
    ];
    for (component, bytes) in bytes {
        let mut maker = Maker::triangle();
        let accessor = maker.accessor(component, "SCALAR", 3, &bytes);
        maker.primitive()["indices"] = accessor.into();
        assert_eq!(triangles(&maker.read().unwrap()), [[2, 0, 1]]);
    }
    for component in [5120, 5122, 5126] {
        let mut maker = Maker::triangle();
        let accessor = maker.accessor(component, "SCALAR", 3, &[0; 12]);
        maker.primitive()["indices"] = accessor.into();
        assert!(maker.message().contains("unsigned type"));
    }
}

#[test]
fn interleaved_views_and_sparse_values_are_read() {
    let mut maker = Maker::triangle();
    let bytes: Vec<u8> = [
        9.0f32, 0.0, 0.0, 0.0, 9.0, 1.0, 0.0, 0.0, 9.0, 0.0, 1.0, 0.0,
    ]
    .iter()
    .flat_map(|v| v.to_le_bytes())
    .collect();
    let accessor = maker.accessor(5126, "VEC3", 3, &bytes);
    maker.json["accessors"][accessor]["byteOffset"] = 4.into();
    maker.json["bufferViews"][accessor]["byteStride"] = 16.into();
    maker.attribute("POSITION", accessor);
    assert_eq!(
        maker.read().unwrap().meshes[0].positions,
        [Vec3::ZERO, Vec3::X, Vec3::Y]
    );

    // The last two positions replaced, with and without a view under them.
    let indices = maker.view(&[1, 0, 2, 0]);
    let values: Vec<u8> = [0.0f32, 0.0, 5.0, 7.0, 0.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let values = maker.view(&values);
    maker.json["accessors"][accessor]["sparse"] = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values}
    });
    let expected = [Vec3::ZERO, 5.0 * Vec3::Z, 7.0 * Vec3::X];
    assert_eq!(maker.read().unwrap().meshes[0].positions, expected);
    let object = maker.json["accessors"][accessor].as_object_mut().unwrap();
    object.remove("bufferView");
    assert_eq!(maker.read().unwrap().meshes[0].positions, expected);
    maker.json["accessors"][accessor]["count"] = 2.into();
    assert!(
        maker
            .message()
            .contains("sparse index 2 is outside its 2 elements")
    );
    maker.json["accessors"][accessor]["count"] = 500_000_000.into();
    assert!(maker.read().is_err());
}

#[test]
fn whole_number_colours_and_coordinates_are_normalised() {
    let mut maker = Maker::triangle();
    let color = maker.accessor(
        5121,
        "VEC4",
        3,
        &[255, 0, 51, 102, 0, 0, 0, 0, 255, 255, 255, 255],
    );
    maker.attribute("COLOR_0", color);
    let scene = maker.read().unwrap();
    assert_eq!(scene.meshes[0].colors[0], [1.0, 0.0, 0.2]);
    assert_eq!(scene.meshes[0].alphas, [0.4, 0.0, 1.0]);
    let color: Vec<u8> = [65535u16, 0, 13107, 0, 0, 0, 0, 0, 0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let color = maker.accessor(5123, "VEC3", 3, &color);
    maker.attribute("COLOR_0", color);
    let scene = maker.read().unwrap();
    assert_eq!(scene.meshes[0].colors[0], [1.0, 0.0, 0.2]);
    assert!(scene.meshes[0].alphas.is_empty());

    // KHR_mesh_quantization: plain and normalised signed positions and normals.
    let position = maker.accessor(5120, "VEC3", 3, &[0, 0, 0, 127, 0, 0, 0, 129, 0]);
    maker.attribute("POSITION", position);
    let normal = maker.accessor(5120, "VEC3", 3, &[0, 0, 127, 0, 0, 127, 0, 0, 127]);
    maker.json["accessors"][normal]["normalized"] = true.into();
    maker.attribute("NORMAL", normal);
    maker.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = maker.read().unwrap();
    assert_eq!(scene.meshes[0].positions[2], Vec3::new(0.0, -127.0, 0.0));
    assert_eq!(scene.meshes[0].normals, [Vec3::Z; 3]);
    maker.json["accessors"][position]["normalized"] = true.into();
    assert_eq!(maker.read().unwrap().meshes[0].positions[2], Vec3::NEG_Y);
}

#[test]
fn transforms_compose_depth_first_and_instances_share_a_mesh() {
    let mut maker = Maker::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    maker.json["scenes"] = json!([{"nodes": [4]}, {"nodes": [3, 0]}]);
    maker.json["scene"] = 1.into();
    maker.json["nodes"] = json!([
        {"mesh": 0, "translation": [1, 2, 3], "children": [2, 1]},
        {"mesh": 0, "scale": [2, 3, 4]},
        // A quarter turn about y: x goes to −z. Not normalised, as exporters write it.
        {"rotation": [0, 2.0 * half, 0, 2.0 * half], "children": [5]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1]},
        {"mesh": 0},
        {"mesh": 0},
        {"mesh": 0, "scale": [0, 1, 1]}
    ]);
    maker.json["scenes"][1]["nodes"]
        .as_array_mut()
        .unwrap()
        .push(6.into());
    let scene = maker.read().unwrap();
    assert_eq!(scene.meshes.len(), 1);
    let nodes: Vec<usize> = scene.instances.iter().map(|i| i.node).collect();
    assert_eq!(nodes, [3, 0, 5, 1]);
    let at = |i: usize, p: DVec3| scene.instances[i].world_from_object.transform_point3(p);
    // Sums in f64: a tenth stays a tenth.
    assert_eq!(at(0, DVec3::X).x, -1.0 + 0.1);
    assert_eq!(at(1, DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    assert!((at(2, DVec3::X) - DVec3::new(1.0, 2.0, 2.0)).length() < 1e-15);
    assert_eq!(at(3, DVec3::ONE), DVec3::new(3.0, 5.0, 7.0));
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("1 meshes were left out"))
    );
    // The mirrored instance is turned back: its normal still faces +z.
    let world = World::new(&scene);
    let [a, b, c] = world.corners(0);
    assert!((b - a).cross(c - a).z > 0.0);

    maker.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(maker.read().unwrap().instances[0].node, 4);
    maker.json.as_object_mut().unwrap().remove("scenes");
    let nodes: Vec<usize> = maker
        .read()
        .unwrap()
        .instances
        .iter()
        .map(|i| i.node)
        .collect();
    assert_eq!(nodes, [0, 5, 1, 3, 4]);
}

#[test]
fn only_trees_of_nodes_are_walked() {
    for (nodes, roots, expected) in [
        (
            json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]),
            json!([0]),
            "also a child of node 1",
        ),
        (
            json!([{"children": [1]}, {"children": [0], "mesh": 0}]),
            json!([0]),
            "their own ancestors",
        ),
        (
            json!([{"mesh": 0}, {"children": [1]}]),
            json!([0]),
            "their own ancestors",
        ),
        (
            json!([{"children": [1]}, {"mesh": 0}]),
            json!([0, 1]),
            "is not a root",
        ),
        (json!([{"mesh": 0}]), json!([0, 0]), "stands there twice"),
        (
            json!([{"mesh": 0}]),
            json!([7]),
            "names node 7, but there are 1",
        ),
        (
            json!([{"children": [9]}]),
            json!([0]),
            "names node 9, but there are 1",
        ),
        (
            json!([{"mesh": 5}]),
            json!([0]),
            "names mesh 5, but there are 1",
        ),
        (
            json!([{"mesh": 0, "scale": [1e300, 1e300, 1e300], "children": [1]}, {"scale": [1e300, 1, 1]}]),
            json!([0]),
            "not finite",
        ),
    ] {
        let mut maker = Maker::triangle();
        maker.json["nodes"] = nodes;
        maker.json["scenes"][0]["nodes"] = roots;
        let message = maker.message();
        assert!(message.contains(expected), "{message}");
    }
    // Deep chains do not exhaust the stack.
    let mut maker = Maker::triangle();
    let chain = (0..200_000).map(|i| json!({"children": [i + 1]}));
    maker.json["nodes"] = chain.chain([json!({"mesh": 0})]).collect();
    assert_eq!(maker.read().unwrap().instances[0].node, 200_000);
}

#[test]
fn lengths_in_the_file_are_not_believed() {
    type Break = fn(&mut Value);
    let cases: [(Break, &str); 12] = [
        (
            |j| j["accessors"][0]["count"] = 4.into(),
            "4 elements do not lie in the 36 bytes",
        ),
        (|j| j["accessors"][0]["count"] = u64::MAX.into(), "count is"),
        (|j| j["accessors"][0]["count"] = 0.into(), "0 elements"),
        (
            |j| j["accessors"][0]["byteOffset"] = u64::MAX.into(),
            "do not lie in",
        ),
        (
            |j| j["accessors"][0]["bufferView"] = 3.into(),
            "names buffer view 3",
        ),
        (
            |j| j["accessors"][0]["type"] = "VEC2".into(),
            "is of type VEC2 where VEC3",
        ),
        (
            |j| j["accessors"][0]["componentType"] = 7.into(),
            "component type 7",
        ),
        (
            |j| j["bufferViews"][0]["byteLength"] = 99.into(),
            "goes past the 36 bytes",
        ),
        (
            |j| j["bufferViews"][0]["byteOffset"] = u64::MAX.into(),
            "goes past",
        ),
        (
            |j| j["bufferViews"][0]["byteStride"] = 8.into(),
            "byteStride is 8",
        ),
        (
            |j| j["bufferViews"][0]["buffer"] = 1.into(),
            "names buffer 1",
        ),
        (
            |j| j["accessors"] = json!([{"count": "x"}]),
            "accessors[0]: ",
        ),
    ];
    for (breaks, expected) in cases {
        let mut maker = Maker::triangle();
        breaks(&mut maker.json);
        let message = maker.message();
        assert!(message.contains(expected), "{message}");
    }
    let mut maker = Maker::triangle();
    let accessor = maker.accessor(5121, "SCALAR", 3, &[0, 1, 3]);
    maker.primitive()["indices"] = accessor.into();
    assert!(maker.message().contains("triangle 0 names vertex 3"));
    maker.json["accessors"][accessor]["count"] = 2.into();
    assert!(maker.message().contains("do not make whole triangles"));
    // A small file with a node for each of many copies of a large mesh.
    let mut maker = Maker::triangle();
    maker.json["accessors"][0]["count"] = (1 << 24).into();
    maker.json["nodes"] = (0..20).map(|_| json!({"mesh": 0})).collect();
    maker.json["scenes"][0]["nodes"] = (0..20).collect();
    assert!(maker.message().contains("vertices, more than the"));
}

#[test]
fn broken_containers_are_refused() {
    let good = Maker::triangle().glb();
    for cut in [0, 3, 4, 11, 12, 19, 20, 60, good.len() - 1] {
        assert!(from_glb(&good[..cut]).is_err(), "cut at {cut}");
    }
    for (at, value) in [(4, 1), (8, 4), (12, u32::MAX - 3), (16, 0)] {
        let mut bad = good.clone();
        bad[at..at + 4].copy_from_slice(&value.to_le_bytes());
        assert!(from_glb(&bad).is_err(), "{value} at {at}");
    }
    assert!(from_glb(&glb(b"[]", b"")).is_err());
    assert!(from_glb(&glb(b"{\"asset\":{\"version\":\"1.0\"}}", b"")).is_err());
    assert!(from_glb(&glb(&b"[".repeat(100_000), b"")).is_err());
}

#[test]
fn every_cut_and_flipped_byte_is_an_error_or_a_scene() {
    let mut maker = Maker::triangle();
    let uv = maker.floats("VEC2", &[0.0; 6]);
    maker.attribute("TEXCOORD_0", uv);
    let good = maker.glb();
    for at in 0..good.len() {
        let _ = from_glb(&good[..at]);
        for flip in [1u8, 0x10, 0x80] {
            let mut bad = good.clone();
            bad[at] ^= flip;
            if let Err(error) = from_glb(&bad) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
}

#[test]
fn extensions_that_cannot_be_done_without_are_named() {
    let mut maker = Maker::triangle();
    for (name, hint) in [
        ("KHR_draco_mesh_compression", "without mesh compression"),
        ("EXT_meshopt_compression", "without mesh compression"),
        ("KHR_texture_basisu", "PNG or JPEG"),
        ("VENDOR_\u{1b}thing", "re-export without it"),
    ] {
        maker.json["extensionsRequired"] = json!(["KHR_materials_sheen", name]);
        let message = maker.message();
        assert!(
            message.contains(&printable(name)) && message.contains(hint),
            "{message}"
        );
    }
    maker.json["extensionsRequired"] = json!(["KHR_materials_sheen", "KHR_texture_transform"]);
    assert!(maker.read().is_ok());
}

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
fn points_lines_skins_and_morphs_are_said() {
    let mut maker = Maker::triangle();
    let primitives = maker.json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap();
    primitives.insert(0, json!({"attributes": {"POSITION": 0}, "mode": 0}));
    primitives[1]["targets"] = json!([{"POSITION": 0}]);
    maker.json["nodes"][0]["skin"] = 0.into();
    maker.json["animations"] = json!([{}]);
    let scene = maker.read().unwrap();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.instances[0].primitive, 1);
    let all = scene.warnings.join("\n");
    assert!(all.contains("1 primitives without triangles"), "{all}");
    assert!(all.contains("animations, skins, morph targets"), "{all}");
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
    use super::super::{ImportOptions, load};
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
    assert_eq!([slice(0), slice(1), slice(2)], [png(), png(), png()]);
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
