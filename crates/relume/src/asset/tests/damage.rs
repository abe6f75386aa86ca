//! Files that lie: a typed error each, never a panic and never more memory than the file is long.

use proptest::prelude::*;

use super::*;

/// Changes the extension of node `node` in a good file; the error that reading then gives.
fn error_of(change: impl Fn(&mut Value, &mut Vec<u8>)) -> String {
    let bytes = glb(&imported());
    let (mut json, bin) = parts(&bytes);
    let mut bin = bin.to_vec();
    change(&mut json, &mut bin);
    let error = from_glb(&join(&json, &bin)).unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

fn extension(json: &mut Value) -> &mut Value {
    &mut json["nodes"][2]["extensions"][header::NAME]
}

fn first(json: &mut Value) -> &mut Value {
    &mut extension(json)["primitives"][1]
}

fn view<'v>(json: &'v mut Value, key: &str) -> &'v mut Value {
    let index = first(json)[key].as_u64().unwrap() as usize;
    &mut json["bufferViews"][index]
}

#[test]
fn versions_and_headers_that_differ_are_refused() {
    let error = error_of(|json, _| extension(json)["version"] = 2.into());
    assert_eq!(
        error,
        "has RELUME_transfer of version 2, but this relume reads version 1; update relume"
    );
    let error = error_of(|json, _| extension(json)["order"] = 3.into());
    assert!(
        error.contains("node 2: RELUME_transfer has another header than other nodes"),
        "{error}"
    );
    let error = error_of(|json, _| {
        let extensions = json["nodes"][2]["extensions"].as_object_mut().unwrap();
        extensions.remove(header::NAME);
    });
    assert!(
        error.contains("node 2: RELUME_transfer is missing"),
        "{error}"
    );
}

#[test]
fn counts_are_held_against_the_scene() {
    for (change, expected) in [
        (("count", json!(5)), "counts 5 vertices, but there are 4"),
        (("count", Value::Null), "counts 0 vertices, but there are 4"),
        (("inputVertices", json!(5)), "wrong inputVertices"),
        (
            ("transfer", json!(999)),
            "names a buffer view that is not there",
        ),
        (("transfer", json!(-1)), "has primitives with invalid value"),
        (("transfer", Value::Null), "has no transfer for primitive 1"),
        (("sameAs", json!(0)), "shares what primitive 0 has not"),
        (("sameAs", json!(2)), "shares what primitive 2 has not"),
    ] {
        let (key, value) = change;
        let error = error_of(|json, _| first(json)[key] = value.clone());
        let expected = expected.replace("shares", "lets primitive 1 share");
        assert!(error.contains(&expected), "{error}");
    }
    let error = error_of(|json, _| _ = extension(json)["primitives"].as_array_mut().unwrap().pop());
    assert!(error.contains("has no transfer for primitive 2"), "{error}");
}

#[test]
fn views_are_held_against_the_bytes() {
    for (key, value, expected) in [
        ("byteLength", json!(44), "has 44 bytes, not 4 times 48"),
        ("byteLength", json!(u64::MAX), "bytes, not 4 times 48"),
        (
            "byteOffset",
            json!(137),
            "does not begin at a multiple of 4",
        ),
        (
            "byteOffset",
            json!(1u64 << 40),
            "ends past the binary chunk",
        ),
        (
            "byteOffset",
            json!(u64::MAX - 3),
            "ends past the binary chunk",
        ),
        ("byteStride", json!(4), "is not a plain run"),
        ("buffer", json!(1), ""),
        ("byteOffset", json!("x"), ""),
    ] {
        let error = error_of(|json, _| view(json, "transfer")[key] = value.clone());
        assert!(error.contains(expected), "{error}");
    }
    let error = error_of(|json, _| {
        let other = view(json, "transfer")["byteOffset"].as_u64().unwrap();
        let second = extension(json)["primitives"][2]["transfer"]
            .as_u64()
            .unwrap() as usize;
        json["bufferViews"][second]["byteOffset"] = (other + 4).into();
    });
    assert!(error.contains("overlaps another"), "{error}");
    let error = error_of(|json, _| {
        let shared = first(json)["transfer"].clone();
        extension(json)["primitives"][2]["transfer"] = shared;
    });
    assert!(error.contains("overlaps another"), "{error}");
}

#[test]
fn numbers_are_held_against_what_they_mean() {
    let place =
        |json: &mut Value, key: &str| view(json, key)["byteOffset"].as_u64().unwrap() as usize;
    let error = error_of(|json, bin| {
        let at = place(json, "transfer") + 48;
        bin[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
    assert!(
        error.contains("of primitive 1 has a coefficient that is not finite, for vertex 1"),
        "{error}"
    );
    let error = error_of(|json, bin| {
        // The second primitive holds vertices 4…7: the seventh of all is buried.
        let valid = extension(json)["primitives"][2]["valid"].as_u64().unwrap() as usize;
        let at = json["bufferViews"][valid]["byteOffset"].as_u64().unwrap() as usize;
        assert_eq!(bin[at..at + 4], [1, 1, 0, 1]);
        bin[at + 1] = 2;
    });
    assert!(error.contains("neither 0 nor 1"), "{error}");
    let error = error_of(|json, bin| {
        let back = first(json)["back"]["vertices"].as_u64().unwrap() as usize;
        let at = json["bufferViews"][back]["byteOffset"].as_u64().unwrap() as usize;
        bin[at..at + 4].copy_from_slice(&4u32.to_le_bytes());
    });
    assert!(error.contains("not ascending vertices"), "{error}");
}

#[test]
fn vertices_said_to_be_the_same_must_be() {
    let bytes = glb(&samples::asset());
    let (mut json, bin) = parts(&bytes);
    // The second primitive of the fern gets the texture coordinates as normals: other vertices, as many.
    let mesh = &mut json["meshes"][1]["primitives"][1]["attributes"];
    mesh["POSITION"] = mesh["NORMAL"].clone();
    let error = from_glb(&join(&json, bin)).unwrap_err().to_string();
    assert!(
        error.contains("calls vertices the same that differ"),
        "{error}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]
    #[test]
    fn no_change_of_bytes_brings_the_reader_down(
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<proptest::sample::Index>(),
        cuts in any::<bool>(),
    ) {
        let mut bytes = glb(&samples::asset());
        for (place, value) in changes {
            let length = bytes.len();
            bytes[place.index(length)] = value;
        }
        if cuts {
            bytes.truncate(cut.index(bytes.len()));
        }
        // Most changes hit the coefficients, and are no error.
        if let Err(error) = from_glb(&bytes) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}
