//! Baked assets of our own, damaged.

use serde_json::{Value, json};

use super::bytes::{glb, parts, patched, triangle};
use super::case::{Case, Outcome};
use super::outcome::Made;

const SHADE: &str = "shade a.glb --light constant:1,1,1 -o out.npz";

fn refused(name: &str, bytes: Vec<u8>, part: &'static str) -> Case {
    Case::new(name, SHADE, Outcome::Refused(part)).with("a.glb", bytes)
}

pub fn extension(json: &mut Value) -> &mut Value {
    &mut json["nodes"][0]["extensions"]["RELUME_transfer"]
}

pub fn primitive(json: &mut Value) -> &mut Value {
    &mut extension(json)["primitives"][0]
}

/// Where the transfer's coefficients begin.
fn offset(json: &mut Value) -> usize {
    let view = primitive(json)["transfer"].as_u64().unwrap() as usize;
    json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize
}

pub fn cases(made: &Made) -> Vec<Case> {
    let mut cases = headers(made);
    cases.extend(views(made));
    cases.extend(halves(made));
    cases.extend(files(made));
    cases
}

fn changed(made: &Made, change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Vec<u8> {
    changed_of(&made.asset, change)
}

pub fn changed_of(asset: &[u8], change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Vec<u8> {
    let (mut json, mut bin) = parts(asset);
    change(&mut json, &mut bin);
    glb(&json, &bin)
}

fn headers(made: &Made) -> Vec<Case> {
    let header = |key: &'static str, value: Value| {
        changed(made, move |json, _| extension(json)[key] = value)
    };
    let entry = |key: &'static str, value: Value| {
        changed(made, move |json, _| primitive(json)[key] = value)
    };
    vec![
        refused(
            "a version to come",
            header("version", json!(2)),
            "update relume",
        ),
        refused(
            "a version in words",
            header("version", json!("1")),
            "no version",
        ),
        refused("order 33", header("order", json!(33)), "order"),
        refused("order 0", header("order", json!(0)), "order"),
        refused(
            "another order than the file holds",
            header("order", json!(4)),
            "bytes, not",
        ),
        refused(
            "a count that is not n²",
            header("order", json!(2.5)),
            "RELUME_transfer has",
        ),
        refused("two channels", header("channels", json!(2)), "2 channels"),
        refused(
            "three channels of one",
            header("channels", json!(3)),
            "bytes, not",
        ),
        refused("another basis", header("basis", json!("haar")), "basis"),
        refused(
            "another convention",
            header("convention", json!("real-cs")),
            "convention",
        ),
        refused(
            "another precision",
            header("precision", json!("f64")),
            "not \"f32\" or \"f16\"",
        ),
        refused(
            "a kind with control characters",
            header("kind", json!("\u{1b}[31m\n")),
            "\\u",
        ),
        refused(
            "an albedo past white",
            header("albedo", json!([2, 0, 0])),
            "albedo outside",
        ),
        refused(
            "a hash that is none",
            header("source", json!("sha256:xyz")),
            "no sha256",
        ),
        refused(
            "primitives that are none",
            header("primitives", json!("x")),
            "primitives",
        ),
        refused(
            "no primitives",
            header("primitives", json!([])),
            "no transfer for primitive 0",
        ),
        refused(
            "a million primitives elsewhere",
            header("primitives", json!([{"sameAs": 1_000_000}])),
            "sameAs",
        )
        .about_sharing(),
        refused(
            "fewer vertices than there are",
            entry("count", json!(1)),
            "counts 1 vertices",
        ),
        refused(
            "2^63 vertices",
            entry("count", json!(1_u64 << 63)),
            "counts",
        ),
        refused(
            "more input vertices than vertices",
            entry("inputVertices", json!(1_000_000)),
            "inputVertices",
        ),
        refused(
            "a view that is not there",
            entry("transfer", json!(1_000_000)),
            "not there",
        ),
        refused(
            "no view",
            entry("transfer", Value::Null),
            "no transfer for primitive 0",
        ),
        refused(
            "back sides of everything",
            entry(
                "back",
                json!({"count": 1_u64 << 62, "vertices": 0, "transfer": 0}),
            ),
            "bytes, not",
        ),
        refused(
            "no extension",
            changed(made, |json, _| {
                drop(
                    json["nodes"][0]
                        .as_object_mut()
                        .unwrap()
                        .remove("extensions"),
                );
            }),
            "no baked transfer",
        ),
    ]
}

impl Case {
    /// Its message is about sharing.
    fn about_sharing(mut self) -> Self {
        self.outcome = Outcome::Refused("share what primitive 1000000 has not");
        self
    }
}

fn views(made: &Made) -> Vec<Case> {
    let view = |key: &'static str, value: Value| {
        changed(made, move |json, _| {
            let view = primitive(json)["transfer"].as_u64().unwrap() as usize;
            json["bufferViews"][view][key] = value;
        })
    };
    let coefficient = |value: f32| {
        changed(made, move |json, bin| {
            let at = offset(json);
            bin[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
        })
    };
    let overlapping = changed(made, |json, _| {
        let view = primitive(json)["transfer"].clone();
        let count = primitive(json)["count"].as_u64().unwrap();
        // The flags lie in the first bytes of the coefficients.
        let at = offset(json);
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": count}));
        let new = views.len() - 1;
        assert!(view.is_u64());
        primitive(json)["valid"] = new.into();
    });
    let flags = changed(made, |json, bin| {
        let count = primitive(json)["count"].as_u64().unwrap() as usize;
        let at = bin.len();
        bin.extend(vec![2; count]);
        bin.resize(bin.len().next_multiple_of(4), 0);
        json["buffers"][0]["byteLength"] = bin.len().into();
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": count}));
        let new = views.len() - 1;
        primitive(json)["valid"] = new.into();
    });
    vec![
        refused(
            "coefficients four bytes short",
            view("byteLength", json!(4)),
            "has 4 bytes, not",
        ),
        refused(
            "coefficients past the end",
            view("byteOffset", json!(1_u64 << 40)),
            "past the",
        ),
        refused(
            "coefficients at an odd place",
            view("byteOffset", json!(1)),
            "multiple of 4",
        ),
        refused(
            "coefficients that overflow",
            view("byteOffset", json!(u64::MAX - 3)),
            "past the",
        ),
        refused(
            "coefficients with gaps",
            view("byteStride", json!(4)),
            "plain run of bytes",
        ),
        refused(
            "coefficients of another buffer",
            view("buffer", json!(1)),
            "buffer",
        ),
        refused("a coefficient of NaN", coefficient(f32::NAN), "not finite"),
        refused(
            "a coefficient of infinity",
            coefficient(f32::INFINITY),
            "not finite",
        ),
        refused(
            "a coefficient past all sense",
            coefficient(1e30),
            "past 1e8",
        ),
        refused("views that overlap", overlapping, "overlaps"),
        refused("a flag of 2", flags, "neither 0 nor 1"),
    ]
}

fn halves(made: &Made) -> Vec<Case> {
    let view = |key: &'static str, value: Value| {
        changed_of(&made.half, move |json, _| {
            let view = primitive(json)["transfer"].as_u64().unwrap() as usize;
            json["bufferViews"][view][key] = value;
        })
    };
    let coefficient = |bits: u16| {
        changed_of(&made.half, move |json, bin| {
            let at = offset(json);
            bin[at + 6..at + 8].copy_from_slice(&bits.to_le_bytes());
        })
    };
    let called = |asset: &[u8], precision: &str| {
        changed_of(asset, |json, _| {
            extension(json)["precision"] = precision.into();
        })
    };
    let at = offset(&mut parts(&made.half).0);
    let good = Case::new("a good asset of half floats", SHADE, Outcome::Tolerated(""));
    vec![
        refused(
            "floats called half floats",
            called(&made.asset, "f16"),
            "bytes, not",
        ),
        refused(
            "half floats called floats",
            called(&made.half, "f32"),
            "bytes, not",
        ),
        refused(
            "half a half float",
            view("byteLength", json!(7)),
            "has 7 bytes, not",
        ),
        refused(
            "half floats between two floats",
            view("byteOffset", json!(at - 2)),
            "multiple of 4",
        ),
        refused(
            "half floats past the end",
            view("byteOffset", json!(1_u64 << 40)),
            "past the",
        ),
        refused("a half float of NaN", coefficient(0x7e00), "not finite"),
        refused(
            "a half float of infinity",
            coefficient(0xfc00),
            "not finite",
        ),
        good.with("a.glb", made.half.clone()),
    ]
}

fn files(made: &Made) -> Vec<Case> {
    let (json, bin) = triangle();
    let good = &made.asset;
    let foreign = changed(made, |json, bin| {
        // The transfer of one mesh on the positions of another.
        let (other, other_bin) = triangle();
        let mut taken = extension(json).clone();
        taken["primitives"][0]["transfer"] = 0.into();
        *json = other;
        *bin = other_bin;
        json["nodes"][0]["extensions"] = json!({"RELUME_transfer": taken});
    });
    let mut cases = vec![
        refused(
            "a scene that is not baked",
            glb(&json, &bin),
            "no baked transfer",
        ),
        refused(
            "half an asset",
            good[..good.len() / 2].to_vec(),
            "not a whole .glb",
        ),
        refused(
            "an asset a byte short",
            good[..good.len() - 1].to_vec(),
            "not a whole .glb",
        ),
        refused("an empty asset", vec![], "not a whole .glb"),
        refused(
            "text with another name",
            b"hello".to_vec(),
            "not a whole .glb",
        ),
        refused("another container", patched(good, 4, &[3]), "version 3"),
        refused(
            "the transfer of another mesh",
            foreign,
            "vertices, but there are 3",
        ),
        Case::new("no such asset", SHADE, Outcome::Refused("a.glb")),
        Case::new("a folder as an asset", SHADE, Outcome::Refused("a.glb")).with_folder("a.glb"),
    ];
    for (verb, line) in [
        ("render", "render a.glb --light constant:1,1,1 -o out.png"),
        ("export", "export a.glb -o out.npz"),
        ("compare", "compare a.glb --light constant:1,1,1"),
        ("info", "info a.glb"),
    ] {
        let case = Case::new(
            format!("half an asset, to {verb}"),
            line,
            Outcome::Refused("not a whole .glb"),
        );
        cases.push(case.with("a.glb", &good[..good.len() / 2]));
    }
    // What all the others are damaged from: it, too, is a seed.
    cases
        .push(Case::new("a good asset", SHADE, Outcome::Tolerated("")).with("a.glb", good.clone()));
    let again = "bake a.glb -o out.glb --samples 16";
    cases.push(
        Case::new("a baked asset, baked again", again, Outcome::Tolerated(""))
            .with("a.glb", good.clone()),
    );
    cases
}
