//! emitters.json.

use serde_json::{Value, json};

use super::case::{Case, Outcome};
use super::outcome::Made;

const SHADE: &str = "shade a.glb --emitters a.json -o out.npz";

/// One of each shape.
fn good() -> Value {
    json!({"emitters": [
        {"name": "panel", "quad": [1, 2], "radiance": [1, 2, 3], "position": [0, 3, 0], "target": [0, 0, 0]},
        {"disc": 0.5, "radiance": 2, "position": [3, 0, 0], "rotate": [[0, 1, 0, -90]], "exponent": 2},
        {"sphere": 0.5, "radiance": 9, "position": [0, 0, 4], "scale": 0.5},
        {"box": [1, 1, 1], "radiance": [[1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0], [6, 0, 0]], "position": [0, -4, 0]},
        {"blocks": {"columns": 2, "rows": 1, "size": [1, 1], "fill": 0.8}, "radiance": 1, "position": [0, 0, -4], "twoSided": true},
        {"quad": [1, 1], "vertexRadiance": [[1, 1, 1], [0, 0, 0], [0, 1, 0], [9, 9, 9]], "position": [-4, 0, 0], "target": [0, 0, 0]},
        {"mesh": "m.obj", "texture": "t.pfm", "radiance": 0.5, "position": [-4, 4, 0]}
    ]})
}

/// One emitter, and what is said of it.
fn entries() -> Vec<(&'static str, Value, &'static str)> {
    let quad = |key: &str, value: Value| {
        let mut entry = json!({"quad": [1, 1], "radiance": 1});
        entry[key] = value;
        entry
    };
    vec![
        ("no shape", json!({"radiance": 1}), "no shape"),
        ("two shapes", quad("disc", json!(1)), "two shapes"),
        ("no radiance", json!({"quad": [1, 1]}), "no radiance"),
        (
            "a shape without width",
            quad("quad", json!([0, 1])),
            "[width, height]",
        ),
        (
            "negative radiance",
            quad("radiance", json!(-1)),
            "not negative",
        ),
        (
            "radiance past f32",
            quad("radiance", json!(1e39)),
            "at most 1e20",
        ),
        (
            "radiance of two faces for one",
            quad("radiance", json!([[1, 1, 1], [1, 1, 1]])),
            "give one for each",
        ),
        (
            "radiance of no corner",
            quad("vertexRadiance", json!([])),
            "leave one out",
        ),
        ("exponent 9", quad("exponent", json!(9)), "0…8"),
        (
            "a key that is none",
            quad("colour\u{1b}[31m", json!(1)),
            "not a key",
        ),
        (
            "a target where it stands",
            quad("target", json!([0, 0, 0])),
            "move one of them",
        ),
        ("a scale of 0", quad("scale", json!(0)), "above 0"),
        (
            "too many blocks",
            json!({"blocks": {"columns": 1_000_000_000, "rows": 1_000_000_000, "size": [1, 1]}, "radiance": 1}),
            "use fewer blocks",
        ),
        (
            "a mesh outside",
            json!({"mesh": "../secret.obj", "radiance": 1}),
            "put it beside",
        ),
        (
            "a mesh that is missing",
            json!({"mesh": "none.obj", "radiance": 1}),
            "see whether it is there",
        ),
        (
            "a texture that is missing",
            quad("texture", json!("none.png")),
            "see whether it is there",
        ),
        (
            "an entry that is a number",
            json!(3),
            "an emitter is an object",
        ),
    ]
}

pub fn cases(made: &Made) -> Vec<Case> {
    let text = good().to_string();
    let mesh = json!({"emitters": [{"mesh": "m.obj", "radiance": 1}]}).to_string();
    let flat = Case::new(
        "emitters: a mesh without area",
        SHADE,
        Outcome::Refused("faces that have an area"),
    );
    let flat = flat
        .with("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        .with("a.json", mesh);
    let whole: Vec<(&str, Vec<u8>, &'static str)> = vec![
        (
            "emitters cut off",
            text[..text.len() / 2].into(),
            "not valid JSON",
        ),
        (
            "no list of emitters",
            b"{}".to_vec(),
            "no list of \"emitters\"",
        ),
        (
            "an empty list of emitters",
            b"{\"emitters\": []}".to_vec(),
            "lists no emitters",
        ),
        (
            "a key beside the emitters",
            b"{\"emitters\": [], \"x\": 1}".to_vec(),
            "has the key",
        ),
        (
            "glTF by the name of emitters",
            b"{\"asset\": {}}".to_vec(),
            "looks like glTF",
        ),
        (
            "a mesh and a texture that are not there",
            text.into(),
            "see whether it is there",
        ),
    ];
    let entries = entries().into_iter().map(|(name, entry, part)| {
        let text = json!({"emitters": [entry]}).to_string();
        (name, text.into_bytes(), part)
    });
    let refused = |(name, bytes, part): (&str, Vec<u8>, &'static str)| {
        Case::new(format!("emitters: {name}"), SHADE, Outcome::Refused(part)).with("a.json", bytes)
    };
    let cases = whole.into_iter().chain(entries).map(refused);
    let cases = cases.chain([flat]);
    let asset = |case: Case| case.with("a.glb", made.asset.clone());
    cases.map(asset).collect()
}
