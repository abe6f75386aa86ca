//! Glossy assets of our own, damaged, and measured BRDFs that are none.

use serde_json::{Value, json};

use super::assets::{changed_of, extension, primitive};
use super::bytes::{floats, glb, patched, triangle};
use super::case::{Case, Outcome};
use super::outcome::Made;

const SHADE: &str = "shade a.glb --light constant:1,1,1 --eye 1,2,3 -o out.npz";
const BAKE: &str = "bake a.obj -o out.glb --samples 16 --order 2 --transfer glossy --transfer-order 2 --brdf a.binary";

fn refused(name: &str, bytes: Vec<u8>, part: &'static str) -> Case {
    Case::new(name, SHADE, Outcome::Refused(part)).with("a.glb", bytes)
}

/// A double-sided triangle, whose back has matrices, too.
pub fn two_sided() -> Vec<u8> {
    let (mut json, bin) = triangle();
    json["materials"] = json!([{"doubleSided": true}]);
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    glb(&json, &bin)
}

/// A measured BRDF that reflects half of what it receives, everywhere alike.
pub fn measured() -> Vec<u8> {
    let header = [90_i32, 90, 180].map(i32::to_le_bytes).concat();
    let entries = 90 * 90 * 180;
    let planes = [1.0, 1.15, 1.66].map(|scale: f64| {
        let entry = 0.5 / std::f64::consts::PI * 1500.0 / scale;
        entry.to_le_bytes().repeat(entries)
    });
    [header, planes.concat()].concat()
}

pub fn cases(made: &Made) -> Vec<Case> {
    let mut cases = headers(made);
    cases.extend(matrices(made));
    cases.extend(tables(made));
    cases.extend(files());
    cases
}

fn headers(made: &Made) -> Vec<Case> {
    let header = |key: &'static str, value: Value| {
        changed_of(&made.glossy, move |json, _| extension(json)[key] = value)
    };
    let brdf = |value: Value| header("brdf", value);
    let phong = |key: &'static str, value: Value| {
        changed_of(&made.glossy, move |json, _| {
            extension(json)["brdf"][key] = value;
        })
    };
    let mut cases = vec![
        refused(
            "transfer order 0",
            header("transferOrder", json!(0)),
            "impossible transferOrder",
        ),
        refused(
            "transfer order 33",
            header("transferOrder", json!(33)),
            "impossible transferOrder",
        ),
        refused(
            "a transfer order past all",
            header("transferOrder", json!(u64::MAX)),
            "RELUME_transfer has",
        ),
        refused(
            "a transfer order in words",
            header("transferOrder", json!("two")),
            "RELUME_transfer has",
        ),
        refused(
            "a transfer order below zero",
            header("transferOrder", json!(-2)),
            "RELUME_transfer has",
        ),
        refused(
            "another transfer order than the file holds",
            header("transferOrder", json!(3)),
            "bytes, not",
        ),
        refused(
            "a BRDF that is a number",
            brdf(json!(7)),
            "RELUME_transfer has",
        ),
        refused("a BRDF without a model", brdf(json!({})), "model"),
        refused(
            "a model that nobody knows",
            brdf(json!({"model": "velvet"})),
            "velvet",
        ),
        refused(
            "a model with control characters",
            brdf(json!({"model": "\u{1b}[31m\n"})),
            "\\u",
        ),
        refused(
            "Phong without its numbers",
            brdf(json!({"model": "phong"})),
            "diffuse",
        ),
        refused(
            "two colours of Phong",
            phong("diffuse", json!([0.5, 0.5])),
            "RELUME_transfer has",
        ),
        refused(
            "a diffuse colour past white",
            phong("diffuse", json!([2, 0, 0])),
            "out of its range",
        ),
        refused(
            "a specular colour below black",
            phong("specular", json!([0, -0.1, 0])),
            "out of its range",
        ),
        refused(
            "an exponent below zero",
            phong("exponent", json!(-1)),
            "out of its range",
        ),
        refused(
            "an exponent past all",
            phong("exponent", json!(1e300)),
            "out of its range",
        ),
        refused(
            "an exponent that is none",
            phong("exponent", Value::Null),
            "RELUME_transfer has",
        ),
        refused(
            "GGX past a mirror",
            brdf(json!({"model": "ggx", "metallic": 0.5, "roughness": -0.1})),
            "out of its range",
        ),
        refused(
            "more than metal",
            brdf(json!({"model": "ggx", "metallic": 1.1, "roughness": 0.5})),
            "out of its range",
        ),
        refused(
            "a BRDF without its table",
            brdf(json!({"model": "merl"})),
            "table",
        ),
        refused(
            "a table that is not there",
            brdf(json!({"model": "merl", "table": 1_000_000})),
            "not there",
        ),
        refused(
            "a table below zero",
            brdf(json!({"model": "merl", "table": -1})),
            "RELUME_transfer has",
        ),
        refused(
            "a table of positions",
            brdf(json!({"model": "merl", "table": 0})),
            "bytes, not 1458000 times 12",
        ),
    ];
    let diffuse = changed_of(&made.asset, |json, _| {
        extension(json)["transferOrder"] = 2.into();
    });
    cases.push(refused(
        "a transfer order without matrices",
        diffuse,
        "not there",
    ));
    // What all of them are damaged from.
    let good = Case::new("a good glossy asset", SHADE, Outcome::Tolerated(""));
    cases.push(good.with("a.glb", made.glossy.clone()));
    let again = "bake a.glb -o out.glb --samples 16";
    let again = Case::new("a glossy asset, baked again", again, Outcome::Tolerated(""));
    cases.push(again.with("a.glb", made.glossy.clone()));
    cases
}

fn matrices(made: &Made) -> Vec<Case> {
    let changed =
        |change: &dyn Fn(&mut Value)| changed_of(&made.glossy, |json, _| change(primitive(json)));
    let number = |key: &'static str, value: f32| {
        changed_of(&made.glossy, move |json, bin| {
            let view = match key {
                "back" => primitive(json)["back"]["matrices"].clone(),
                _ => primitive(json)["matrices"].clone(),
            };
            let view = &json["bufferViews"][view.as_u64().unwrap() as usize];
            let at = view["byteOffset"].as_u64().unwrap() as usize;
            bin[at + 4..at + 8].copy_from_slice(&floats(&[value]));
        })
    };
    let removed = changed(&|entry| drop(entry.as_object_mut().unwrap().remove("matrices")));
    let removed_back = changed(&|entry| {
        drop(entry["back"].as_object_mut().unwrap().remove("matrices"));
    });
    vec![
        refused("no matrices", removed, "not there"),
        refused("no matrices of backs", removed_back, "not there"),
        refused(
            "matrices that are not there",
            changed(&|entry| entry["matrices"] = 99.into()),
            "not there",
        ),
        refused(
            "matrices that are the vectors",
            changed(&|entry| entry["matrices"] = entry["transfer"].clone()),
            "bytes, not",
        ),
        refused(
            "backs that are fronts",
            changed(&|entry| entry["back"]["matrices"] = entry["matrices"].clone()),
            "overlaps",
        ),
        refused(
            "matrices in words",
            changed(&|entry| entry["matrices"] = "all".into()),
            "primitives",
        ),
        refused("a matrix of NaN", number("front", f32::NAN), "not finite"),
        refused("a matrix past all", number("front", 1e30), "past 1e8"),
        refused(
            "a back of infinity",
            number("back", f32::NEG_INFINITY),
            "not finite",
        ),
    ]
}

fn tables(made: &Made) -> Vec<Case> {
    let table = |json: &mut Value| {
        let view = extension(json)["brdf"]["table"].as_u64().unwrap() as usize;
        json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize
    };
    let entry = |value: f32| {
        changed_of(&made.measured, move |json, bin| {
            let at = table(json);
            bin[at + 12..at + 16].copy_from_slice(&floats(&[value]));
        })
    };
    let short = changed_of(&made.measured, |json, _| {
        let view = extension(json)["brdf"]["table"].as_u64().unwrap() as usize;
        json["bufferViews"][view]["byteLength"] = (12 * 1_457_999).into();
    });
    let cut = made.measured[..made.measured.len() / 2].to_vec();
    let good = Case::new("a good measured asset", SHADE, Outcome::Tolerated(""));
    vec![
        refused("a table with NaN", entry(f32::NAN), "entry 1 is"),
        refused("a table below zero", entry(-1.0), "no reflectance"),
        refused("a table past all", entry(1e30), "no reflectance"),
        refused(
            "a table an entry short",
            short,
            "bytes, not 1458000 times 12",
        ),
        refused("half a measured asset", cut, "not a whole .glb"),
        good.with("a.glb", made.measured.clone()),
    ]
}

fn files() -> Vec<Case> {
    let good = measured();
    let refused = |name: &str, bytes: Vec<u8>, part: &'static str| {
        let case = Case::new(name, BAKE, Outcome::Refused(part));
        case.with("a.obj", super::obj::GOOD).with("a.binary", bytes)
    };
    let size = |at: usize, size: i32| patched(&good[..64], at, &size.to_le_bytes());
    // The third number of the blue plane.
    let place = 12 + 8 * (2 * 90 * 90 * 180 + 2);
    let number = |value: f64| patched(&good, place, &value.to_le_bytes());
    let missing = Case::new("no measured BRDF", BAKE, Outcome::Refused("a.binary"));
    let folder = Case::new(
        "a folder as a measured BRDF",
        BAKE,
        Outcome::Refused("not a regular file"),
    );
    let other = Case::new(
        "a BRDF of another name",
        &BAKE.replace("a.binary", "a.brdf"),
        Outcome::Usage,
    );
    let capitals = BAKE.replace("a.binary", "A.BINARY");
    let negative = Case::new("a measured BRDF with gaps", BAKE, Outcome::Tolerated(""));
    vec![
        refused("an empty measured BRDF", vec![], "it has 0 bytes"),
        refused(
            "a measured BRDF in words",
            b"red 0.5\ngreen 0.5\n".to_vec(),
            "bytes, and a measured BRDF",
        ),
        refused(
            "the header and some numbers",
            good[..12 + 8 * 12].to_vec(),
            "it has 108 bytes",
        ),
        refused("the header alone", good[..12].to_vec(), "it has 12 bytes"),
        refused(
            "a measured BRDF a byte short",
            good[..good.len() - 1].to_vec(),
            "has 34992012",
        ),
        refused(
            "a measured BRDF a byte too long",
            [&good[..], &[0]].concat(),
            "it has 34992013 bytes",
        ),
        refused(
            "a table of 360 azimuths",
            patched(&good, 8, &360_i32.to_le_bytes()),
            "90 × 90 × 360",
        ),
        refused(
            "dimensions that overflow",
            patched(&good, 0, &[255, 255, 255, 127].repeat(3)),
            "2147483647 × 2147483647",
        ),
        refused(
            "dimensions below zero",
            patched(&good, 4, &(-90_i32).to_le_bytes()),
            "90 × -90 × 180",
        ),
        refused(
            "a short file of huge dimensions",
            size(0, i32::MAX),
            "it has 64 bytes",
        ),
        refused(
            "a measurement of NaN",
            number(f64::NAN),
            "entry 2 of the blue table is NaN",
        ),
        refused(
            "a measurement of infinity",
            number(f64::INFINITY),
            "entry 2 of the blue table is inf",
        ),
        refused("a measurement past all", number(1e300), "no reflectance"),
        negative
            .with("a.obj", super::obj::GOOD)
            .with("a.binary", number(-1.0)),
        missing.with("a.obj", super::obj::GOOD),
        folder
            .with("a.obj", super::obj::GOOD)
            .with_folder("a.binary"),
        other.with("a.obj", super::obj::GOOD),
        Case::new(
            "a missing BRDF in capitals",
            &capitals,
            Outcome::Refused("A.BINARY"),
        )
        .with("a.obj", super::obj::GOOD),
    ]
}
