//! A scene in many files becomes one buffer.

use std::path::Path;

use base64::Engine;
use serde_json::{Value, json};

use super::super::from_glb;
use super::materials::{png, textured};
use super::{Maker, glb};
use crate::scene::{ImportOptions, load};

/// The textured triangle as a `.gltf` with its parts in files beside it and in data URIs.
fn scatter(whole: &Maker, folder: &Path) -> Value {
    let parts = folder.join("my parts");
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
    json
}

#[test]
fn scattered_parts_are_gathered_into_one_buffer() {
    let whole = textured();
    let folder = tempfile::tempdir().unwrap();
    let json = scatter(&whole, folder.path());
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
}

#[test]
fn parts_that_must_not_or_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut json = scatter(&textured(), folder.path());
    let path = folder.path().join("scene.gltf");
    for (uri, expected) in [
        ("../secret.png", "leads out of the folder of the file"),
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
