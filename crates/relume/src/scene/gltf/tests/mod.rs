#[cfg(feature = "images")]
#[cfg(feature = "import")]
mod gather;
mod hostile;
mod materials;
mod nodes;

use glam::Vec3;
use serde_json::{Value, json};

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
