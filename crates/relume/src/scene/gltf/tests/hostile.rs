use serde_json::{Value, json};

use super::super::*;
use super::{Maker, glb};

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
}

#[test]
fn indices_and_totals_are_checked_before_use() {
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
    // Some writers pad the JSON with zeros.
    let mut maker = Maker::triangle();
    maker.json["buffers"][0]["byteLength"] = maker.bin.len().into();
    assert!(from_glb(&glb(format!("{}\0\0", maker.json).as_bytes(), &maker.bin)).is_ok());
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
