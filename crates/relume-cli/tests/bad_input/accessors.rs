//! glTF accessors and buffer views that lie.

use serde_json::{Value, json};

use super::bytes::{floats, with_view};
use super::case::Case;
use super::gltf::changed;

pub fn cases() -> Vec<Case> {
    let accessor =
        |key: &'static str, value: Value| changed(move |json, _| json["accessors"][0][key] = value);
    let view = |key: &'static str, value: Value| {
        changed(move |json, _| json["bufferViews"][0][key] = value)
    };
    let unbacked = |count: u64| {
        changed(move |json, _| {
            json["accessors"][0] = json!({"componentType": 5126, "type": "VEC3", "count": count});
        })
    };
    let indices = |component: u32, data: &'static [u8]| {
        changed(move |json, bin| {
            let index = with_view(json, bin, "SCALAR", component, 3, data);
            json["meshes"][0]["primitives"][0]["indices"] = index.into();
        })
    };
    let attribute = |name: &'static str, count: usize| {
        changed(move |json, bin| {
            let index = with_view(
                json,
                bin,
                "VEC3",
                5126,
                count,
                &floats(&vec![1.0; 3 * count]),
            );
            json["meshes"][0]["primitives"][0]["attributes"][name] = index.into();
        })
    };
    [
        ("more elements than bytes", accessor("count", json!(4)), "do not lie in the 36 bytes"),
        ("an element count of 2^40", accessor("count", json!(1u64 << 40)), "count is"),
        ("2^27 elements of nothing", unbacked(1 << 27), "have no data"),
        ("an offset past the end", accessor("byteOffset", json!(37)), "do not lie"),
        ("an offset that overflows", accessor("byteOffset", json!(u64::MAX)), "do not lie"),
        ("no elements", accessor("count", json!(0)), "0 elements"),
        ("an unknown component type", accessor("componentType", json!(5130)), "component type 5130"),
        ("positions of two numbers", accessor("type", json!("VEC2")), "VEC3 is needed"),
        ("a view that is not there", accessor("bufferView", json!(7)), "buffer view 7"),
        ("an accessor that is not there", changed(|json, _| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9.into()), "accessor 9"),
        ("a view past the end", view("byteLength", json!(40)), "goes past the 36 bytes"),
        ("a view that overflows", view("byteOffset", json!(u64::MAX)), "goes past"),
        ("a view of no buffer", view("buffer", json!(1)), "buffer 1"),
        ("a stride within its elements", view("byteStride", json!(4)), "byteStride is 4"),
        ("a stride of terabytes", view("byteStride", json!(1u64 << 40)), "byteStride"),
        ("an index past the vertices", indices(5121, &[0, 1, 3]), "names vertex 3"),
        ("indices of floats", indices(5126, &[0; 12]), "unsigned type"),
        ("indices of negative numbers", indices(5120, &[0, 1, 0xff]), "unsigned type"),
        ("two normals for three positions", attribute("NORMAL", 2), "NORMAL has 2 elements"),
        ("four colours for three positions", attribute("COLOR_0", 4), "COLOR_0 has 4"),
        ("indices that are no whole triangle", changed(|json, bin| {
            let index = with_view(json, bin, "SCALAR", 5121, 2, &[0, 1]);
            json["meshes"][0]["primitives"][0]["indices"] = index.into();
        }), "whole triangles"),
        ("a sparse index outside", changed(|json, bin| {
            with_view(json, bin, "SCALAR", 5121, 1, &[9]);
            with_view(json, bin, "VEC3", 5126, 1, &[0; 12]);
            json["accessors"][0]["sparse"] = json!({"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2}});
        }), "sparse index 9"),
        ("more sparse values than bytes", changed(|json, _| {
            json["accessors"][0]["sparse"] = json!({"count": 1u64 << 50, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}});
        }), "do not lie"),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}
