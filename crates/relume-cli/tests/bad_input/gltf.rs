//! glTF: containers, accessors, values, nodes, extensions.

use serde_json::{Value, json};

use super::bytes::{floats, glb, glb_of_text, patched, triangle, with_view};
use super::case::{Case, Outcome};

pub fn cases() -> Vec<Case> {
    let mut cases = containers();
    cases.extend(documents());
    cases.extend(values());
    cases.extend(extensions());
    cases.extend(tolerated());
    cases
}

fn good() -> Vec<u8> {
    let (json, bin) = triangle();
    glb(&json, &bin)
}

/// A `.glb` of the triangle with something changed.
pub fn changed(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Vec<u8> {
    let (mut json, mut bin) = triangle();
    change(&mut json, &mut bin);
    glb(&json, &bin)
}

fn containers() -> Vec<Case> {
    let good = good();
    let word = |at, value: u32| patched(&good, at, &value.to_le_bytes());
    let json = u32::from_le_bytes(good[12..16].try_into().unwrap());
    [
        ("an empty file", vec![], "the file is empty"),
        (
            "text with another name",
            b"hello".to_vec(),
            "text of another format",
        ),
        (
            "the magic and no more",
            b"glTF".to_vec(),
            "ends within its header",
        ),
        ("glTF 1", word(4, 1), "version 1"),
        (
            "a length past the end",
            word(8, u32::MAX),
            "copy the file again",
        ),
        (
            "a length within the header",
            word(8, 11),
            "copy the file again",
        ),
        (
            "a chunk past the end",
            word(12, u32::MAX - 3),
            "goes past the end",
        ),
        (
            "a binary chunk first",
            patched(&good, 16, b"BIN\0"),
            "first chunk is not JSON",
        ),
        (
            "half a file",
            good[..good.len() / 2].to_vec(),
            "copy the file again",
        ),
        (
            "a binary chunk past the end",
            word(20 + json as usize, 1 << 20),
            "goes past the end",
        ),
        (
            "no chunks",
            b"glTF\x02\0\0\0\x0c\0\0\0".to_vec(),
            "no JSON chunk",
        ),
        (
            "a chunk of no JSON",
            glb_of_text(b"\xff\xfe", b""),
            "glTF JSON",
        ),
        (
            "JSON cut off",
            glb_of_text(b"{\"asset\": {", b""),
            "re-export",
        ),
        ("an array", glb_of_text(b"[]", b""), "not an object"),
        (
            "a thousand brackets",
            glb_of_text("[".repeat(100_000).as_bytes(), b""),
            "recursion limit",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}

fn documents() -> Vec<Case> {
    [
        (
            "no version",
            changed(|json, _| json["asset"] = json!({})),
            "version is none",
        ),
        (
            "a version to come",
            changed(|json, _| json["asset"]["minVersion"] = "3.0".into()),
            "3.0",
        ),
        (
            "control characters in the version",
            changed(|json, _| json["asset"]["version"] = "\u{1b}[31m\n".into()),
            "\\u{1b}[31m\\n",
        ),
        (
            "accessors that are no array",
            changed(|json, _| json["accessors"] = json!({})),
            "not an array",
        ),
        (
            "nodes that are numbers",
            changed(|json, _| json["nodes"] = json!([1])),
            "nodes[0]",
        ),
        (
            "a negative index",
            changed(|json, _| json["nodes"][0]["mesh"] = json!(-1)),
            "nodes[0]",
        ),
        (
            "a fraction of a count",
            changed(|json, _| json["accessors"][0]["count"] = json!(2.5)),
            "accessors[0]",
        ),
        (
            "a count past all numbers",
            changed(|json, _| json["accessors"][0]["count"] = json!(1e300)),
            "accessors[0]",
        ),
        (
            "a matrix of 15",
            changed(|json, _| json["nodes"][0]["matrix"] = json!(vec![1.0; 15])),
            "nodes[0]",
        ),
        (
            "a length that is text",
            changed(|json, _| json["buffers"][0]["byteLength"] = "36".into()),
            "buffers[0]",
        ),
        (
            "no triangles in it",
            changed(|json, _| json["meshes"][0]["primitives"][0]["mode"] = 0.into()),
            "nothing to bake",
        ),
        (
            "no meshes",
            changed(|json, _| json["nodes"] = json!([{}])),
            "nothing to bake",
        ),
        (
            "a mode that is none",
            changed(|json, _| json["meshes"][0]["primitives"][0]["mode"] = 99.into()),
            "nothing to bake",
        ),
        (
            "an alpha mode with control characters",
            changed(|json, _| json["materials"] = json!([{"alphaMode": "\u{1b}c\u{202e}"}])),
            "\\u{1b}c\\u{202e}",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}

/// The triangle with one number of its positions replaced.
fn position(value: f32) -> Vec<u8> {
    changed(|_, bin| bin[12..16].copy_from_slice(&value.to_le_bytes()))
}

fn values() -> Vec<Case> {
    let color = |value: f32| {
        changed(|json, bin| {
            let index = with_view(json, bin, "VEC3", 5126, 3, &floats(&[value; 9]));
            json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = index.into();
        })
    };
    [
        ("a position of NaN", position(f32::NAN), "position of vertex 1 is not a finite number"),
        ("a position at infinity", position(f32::NEG_INFINITY), "position of vertex 1"),
        ("a position past all sense", position(1e30), "scale the scene down"),
        ("a colour of NaN", color(f32::NAN), "colour of vertex 0"),
        (
            "control characters in a mesh's name",
            changed(|json, bin| {
                json["meshes"][0]["name"] = "\u{1b}]0;x\u{7}\r\n".into();
                bin[..4].copy_from_slice(&f32::NAN.to_le_bytes());
            }),
            "\\u{1b}]0;x\\u{7}\\r\\n",
        ),
        ("a scale past f32", changed(|json, _| json["nodes"][0]["scale"] = json!([1e300, 1e300, 1e300])), "nodes[0]: its transform"),
        ("a translation past all sense", changed(|json, _| json["nodes"][0]["translation"] = json!([0, 1e13, 0])), "scale the scene down"),
        (
            "a product of scales past f64",
            changed(|json, _| {
                json["nodes"] = json!([{"mesh": 0, "scale": [1e99, 1, 1], "children": [1]}, {"mesh": 0, "scale": [1e99, 1, 1]}]);
            }),
            "nodes[1]: its transform",
        ),
        ("a scale of nothing", changed(|json, _| json["nodes"][0]["scale"] = json!([0, 0, 0])), "nothing to bake"),
        ("one vertex", changed(|json, _| json["accessors"][0]["count"] = 1.into()), "whole triangles"),
        ("a triangle without area", position(0.0), "nothing to bake"),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}

fn extensions() -> Vec<Case> {
    let required =
        |name: &'static str| changed(move |json, _| json["extensionsRequired"] = json!([name]));
    [
        (
            "Draco",
            required("KHR_draco_mesh_compression"),
            "re-export without mesh compression",
        ),
        (
            "meshopt",
            required("EXT_meshopt_compression"),
            "re-export without mesh compression",
        ),
        (
            "Basis textures",
            required("KHR_texture_basisu"),
            "PNG or JPEG",
        ),
        (
            "an extension nobody knows",
            required("EVIL\u{1b}[2J\n"),
            "EVIL\\u{1b}[2J\\n",
        ),
        (
            "required extensions that are no list",
            changed(|json, _| json["extensionsRequired"] = "x".into()),
            "not an array",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}

fn tolerated() -> Vec<Case> {
    let normals = |value: f32| {
        changed(move |json, bin| {
            let index = with_view(json, bin, "VEC3", 5126, 3, &floats(&[value; 9]));
            json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = index.into();
        })
    };
    let chain = changed(|json, _| {
        let mut nodes: Vec<Value> = (1..20_000).map(|i| json!({"children": [i]})).collect();
        nodes.push(json!({"mesh": 0}));
        json["nodes"] = nodes.into();
    });
    let extra = |indices: &'static [u8]| {
        changed(move |json, bin| {
            let index = with_view(json, bin, "SCALAR", 5121, indices.len(), indices);
            json["meshes"][0]["primitives"][0]["indices"] = index.into();
        })
    };
    let mut cases: Vec<Case> = [
        ("coordinates of 1e8", position(1e8), ""),
        (
            "coordinates of 1e-8",
            changed(|_, bin| *bin = floats(&[0., 0., 0., 1e-8, 0., 0., 0., 1e-8, 0.])),
            "",
        ),
        (
            "a scale of 1e-30",
            changed(|json, _| json["nodes"][0]["scale"] = json!([1e-30, 1e-30, 1e-30])),
            "",
        ),
        (
            "a face without area among others",
            extra(&[0, 1, 2, 1, 1, 2]),
            "without area were left out",
        ),
        ("normals of zero", normals(0.0), "no usable normal"),
        ("normals of NaN", normals(f32::NAN), "no usable normal"),
        ("normals of 1e38", normals(1e38), ""),
        ("20 000 generations of nodes", chain, ""),
        (
            "a rotation of zero",
            changed(|json, _| json["nodes"][0]["rotation"] = json!([0, 0, 0, 0])),
            "",
        ),
        (
            "a rotation of 1e200",
            changed(|json, _| json["nodes"][0]["rotation"] = json!([0, 0, 0, 1e200])),
            "",
        ),
        (
            "a mesh its node flattens beside one it does not",
            changed(|json, _| {
                json["nodes"] =
                    json!([{"mesh": 0, "children": [1]}, {"mesh": 0, "scale": [1, 0, 1]}]);
            }),
            "flatten",
        ),
        (
            "albedo past white",
            changed(|json, _| {
                json["materials"] =
                    json!([{"pbrMetallicRoughness": {"baseColorFactor": [1e300, -5, 0.5, 1]}}]);
                json["meshes"][0]["primitives"][0]["material"] = 0.into();
            }),
            "clamped",
        ),
        ("bytes behind the end", [good(), vec![1; 99]].concat(), ""),
    ]
    .into_iter()
    .map(|(name, bytes, said)| Case::tolerated(name, "a.glb", bytes, said))
    .collect();
    let line = "info a.glb";
    let escape = changed(|json, _| json["meshes"][0]["name"] = "\u{1b}[31m".into());
    cases.push(
        Case::new(
            "a name with control characters, to info",
            line,
            Outcome::Tolerated(""),
        )
        .with("a.glb", escape),
    );
    cases
}
