//! What a scene refers to: only regular files in its own folder.

use serde_json::{Value, json};

use super::bytes::{good_png, png, triangle};
use super::case::{Case, Outcome};

pub fn cases() -> Vec<Case> {
    let mut cases = buffers();
    cases.extend(images());
    cases.extend(places());
    cases
}

/// A `.gltf` whose buffer is this.
fn gltf(uri: &str) -> String {
    let (mut json, _) = triangle();
    json["buffers"][0]["uri"] = uri.into();
    json.to_string()
}

fn buffers() -> Vec<Case> {
    let mut cases: Vec<Case> = [
        ("a buffer above", "../secret.bin", "leads out"),
        ("a buffer above, encoded", "%2e%2e/secret.bin", "leads out"),
        (
            "a buffer above, encoded whole",
            "..%2fsecret.bin",
            "leads out",
        ),
        (
            "a buffer above, the long way",
            "a/../../secret.bin",
            "leads out",
        ),
        (
            "a buffer above, as Windows has it",
            "..\\secret.bin",
            "backslash",
        ),
        (
            "a buffer above, as Windows has it, encoded",
            "..%5csecret.bin",
            "backslash",
        ),
        ("an absolute path", "/etc/hostname", "absolute"),
        ("an absolute path, encoded", "%2fetc/hostname", "absolute"),
        ("another host", "//host/share", "absolute"),
        ("a drive", "C:/secret.bin", "scheme"),
        ("a drive, encoded", "C%3a/secret.bin", "drive letter"),
        ("a file URL", "file:///etc/hostname", "scheme"),
        ("a web address", "https://example.org/a.bin", "scheme"),
        ("a zero byte", "a%00.bin", "zero byte"),
        ("no UTF-8", "%ff%fe", "UTF-8"),
        ("the folder itself", ".", "names no file"),
        ("a name of nothing", "", "names no file"),
        ("a missing buffer", "gone.bin", "\"gone.bin\""),
        (
            "control characters in a name",
            "\u{1b}[31m\n.bin",
            "\\u{1b}[31m\\n.bin",
        ),
        ("broken base64", "data:;base64,@@@@", "broken data: URI"),
        (
            "a data URI without a comma",
            "data:application/octet-stream",
            "broken data: URI",
        ),
        (
            "a data URI that is too short",
            "data:;base64,AAAA",
            "says it has 36 bytes and has 3",
        ),
    ]
    .into_iter()
    .map(|(name, uri, part)| Case::scene(name, "a.gltf", gltf(uri), part))
    .collect();
    let long = gltf(&"x/".repeat(100_000));
    cases.push(Case::scene("a name of 200 kB", "a.gltf", long, "…"));
    cases.push(
        Case::scene(
            "a folder as a buffer",
            "a.gltf",
            gltf("sub"),
            "not a regular file",
        )
        .with_folder("sub"),
    );
    cases.push(
        Case::scene("a short buffer", "a.gltf", gltf("a.bin"), "has 35").with("a.bin", [0; 35]),
    );
    let (json, _) = triangle();
    cases.push(Case::scene(
        "a buffer of nothing",
        "a.gltf",
        json.to_string(),
        "has no data",
    ));
    cases
}

/// A `.gltf` with a base colour texture.
fn textured(image: &Value) -> String {
    let (mut json, _) = triangle();
    json["buffers"][0]["uri"] =
        "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA".into();
    json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([image]);
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    json.to_string()
}

fn images() -> Vec<Case> {
    let file = || textured(&json!({"uri": "t.png"}));
    let good = good_png();
    let mut cases = vec![
        Case::tolerated(
            "a texture without coordinates",
            "a.gltf",
            file(),
            "TEXCOORD_0",
        )
        .with("t.png", good.clone()),
        Case::scene("a missing texture", "a.gltf", file(), "\"t.png\""),
        Case::scene(
            "a texture above",
            "a.gltf",
            textured(&json!({"uri": "../secret.png"})),
            "leads out",
        ),
        Case::scene(
            "an image of nothing",
            "a.gltf",
            textured(&json!({})),
            "neither uri nor bufferView",
        ),
        Case::scene(
            "an image that is not there",
            "a.gltf",
            textured(&json!({"bufferView": 9})),
            "buffer view 9",
        ),
    ];
    for (name, bytes, part) in [
        (
            "a texture of text",
            b"hello".to_vec(),
            "neither PNG nor JPEG",
        ),
        ("an empty texture", vec![], "neither PNG nor JPEG"),
        ("a texture of no pixels", png(0, 0, &[]), "t"),
        ("a texture of 2^62 pixels", png(1 << 31, 1 << 31, &[]), "t"),
        (
            "a texture of 2^28 pixels",
            png(1 << 14, 1 << 14, &[]),
            "more than 134217728",
        ),
        (
            "a texture cut off",
            good[..good.len() - 20].to_vec(),
            "cannot be decoded",
        ),
        (
            "a texture of a JPEG's first bytes",
            b"\xff\xd8\xff\xe0\0\x10JFIF".to_vec(),
            "cannot be decoded",
        ),
        (
            "a WebP texture",
            b"RIFF\0\0\0\0WEBPVP8 ".to_vec(),
            "neither PNG nor JPEG",
        ),
    ] {
        cases.push(Case::scene(name, "a.gltf", file(), part).with("t.png", bytes));
    }
    cases
}

fn places() -> Vec<Case> {
    let bake = |file: &str| format!("bake {file} -o out.glb");
    let mut cases = vec![
        Case::new(
            "no such scene",
            &bake("gone.glb"),
            Outcome::Refused("gone.glb"),
        ),
        Case::new(
            "a folder as a scene",
            &bake("sub.glb"),
            Outcome::Refused("not a regular file"),
        )
        .with_folder("sub.glb"),
        Case::new(
            "a scene of no format",
            &bake("a.fbx"),
            Outcome::Refused(".fbx"),
        )
        .with("a.fbx", "x"),
        Case::new(
            "a name of two lines",
            &bake("a\n\u{1b}b.obj"),
            Outcome::Refused("a\\n\\u{1b}b.obj"),
        )
        .with("a\n\u{1b}b.obj", ""),
    ];
    #[cfg(unix)]
    cases.extend([
        Case::scene(
            "a link out of the folder",
            "a.gltf",
            gltf("link.bin"),
            "leads out",
        )
        .with_link("link.bin", "../secret.bin"),
        Case::scene(
            "a way out through a folder",
            "a.gltf",
            gltf("up/secret.bin"),
            "leads out",
        )
        .with_link("up", ".."),
        Case::scene(
            "a link to a device",
            "a.gltf",
            gltf("zero.bin"),
            "leads out",
        )
        .with_link("zero.bin", "/dev/zero"),
        Case::scene("a link to itself", "a.gltf", gltf("loop.bin"), "loop.bin")
            .with_link("loop.bin", "loop.bin"),
        Case::new(
            "a scene that never ends",
            &bake("a.ply"),
            Outcome::Refused("not a regular file"),
        )
        .with_link("a.ply", "/dev/zero"),
        Case::new(
            "a light that never ends",
            "light a.hdr -o out.json",
            Outcome::Refused("not a regular file"),
        )
        .with_link("a.hdr", "/dev/zero"),
        Case::new(
            "an asset that never ends",
            "info a.glb",
            Outcome::Refused("no regular file"),
        )
        .with_link("a.glb", "/dev/zero"),
    ]);
    cases
}
