//! Absurd arguments, and outputs that cannot be.

use super::case::{Case, Outcome};
use super::obj::GOOD;

/// Each flag with what it refuses.
const FLAGS: [(&str, &[&str]); 12] = [
    (
        "bake a.obj -o out.glb --samples",
        &["0", "-1", "4294967296", "1e3", "many"],
    ),
    (
        "bake a.obj -o out.glb --order",
        &["0", "33", "-5", "18446744073709551616", "five"],
    ),
    (
        "bake a.obj -o out.glb --bounces",
        &["-1", "4294967295", "x"],
    ),
    ("bake a.obj -o out.glb --threads", &["0", "1000000", "-1"]),
    (
        "bake a.obj -o out.glb --albedo",
        &["2,0,0", "nan,0,0", "0.5", "1,1,1,1", "-0.1,0,0"],
    ),
    (
        "bake a.obj -o out.glb --max-edge",
        &["0", "-1", "nan", "inf", "small"],
    ),
    (
        "bake a.obj -o out.glb --seed",
        &["-1", "1.5", "18446744073709551616"],
    ),
    (
        "bake a.obj -o out.glb --precision",
        &["f8", "f64", "16", "half"],
    ),
    (
        "bake a.obj -o out.glb --transfer glossy --brdf",
        &["velvet", "", "phong.txt", ".binary", "PHONG", "\u{1b}[31m"],
    ),
    (
        "compare a.glb --light sky:40,3 --eye",
        &["1,2", "nan,0,0", "here", "1,2,inf"],
    ),
    (
        "light sky:40,3 -o out.json --rotate",
        &["0,0,0:90", "nan,0,0:90", "0,1,0:inf", "up:9", "0,1,0"],
    ),
    (
        "light sky:40,3 -o out.json --layout",
        &["mercator", "\u{1b}[31m"],
    ),
];

/// Lights that mean nothing.
const LIGHTS: [&str; 14] = [
    "constant:1,1",
    "constant:nan,0,0",
    "constant:-1,0,0",
    "constant:1e21,0,0",
    "constant:inf,0,0",
    "sun:0,0,0,1,1,1,1",
    "sun:0,1,0,0,1,1,1",
    "sun:0,1,0,361,1,1,1",
    "sun:0,1,0,1,1,1,1e30",
    "sky:-1,3",
    "sky:91,3",
    "sky:40,1000",
    "faces_{a,b,c}.hdr",
    "faces_{a,b,c,d,e,a}.hdr",
];

/// What pictures refuse.
const PICTURES: [&str; 14] = [
    "--size 0x0",
    "--size 1000000x1000000",
    "--size -1x5",
    "--size 5",
    "--fov 0",
    "--fov 180",
    "--fov nan",
    "--exposure nan",
    "--exposure 1e9",
    "--eye nan,0,0",
    "--eye 1,2",
    "--samples-per-pixel 0",
    "--frames 0 --sweep light",
    "--frames 1000000000 --sweep light",
];

pub fn cases() -> Vec<Case> {
    let usage = |line: String| Case::new(line.clone(), &line, Outcome::Usage).with("a.obj", GOOD);
    let mut cases = Vec::new();
    for (flag, values) in FLAGS {
        cases.extend(values.iter().map(|value| usage(format!("{flag}={value}"))));
    }
    cases.extend(
        LIGHTS
            .iter()
            .map(|light| usage(format!("light {light} -o out.json"))),
    );
    let render = "render a.glb --light sky:40,3 -o out.png";
    cases.extend(
        PICTURES
            .iter()
            .map(|flags| usage(format!("{render} {flags}"))),
    );
    cases.extend(
        ["paint", "bake", "bake a.obj", "bake a.obj b.obj -o out.glb"]
            .map(|line| usage(line.to_owned())),
    );
    cases.extend(refused());
    cases
}

fn refused() -> Vec<Case> {
    let case = |line: &str, part| Case::new(line, line, Outcome::Refused(part)).with("a.obj", GOOD);
    vec![
        case("bake a.obj -o out.glb --max-edge 1e-9", "raise --max-edge"),
        case("bake a.obj -o out.npz", ".glb"),
        case("bake a.obj -o nowhere/out.glb", "no such folder"),
        case("bake a.obj -o sub.glb", "is a folder").with_folder("sub.glb"),
        case("bake a.glb -o a.glb", "is an input").with("a.glb", "x"),
        case("bake a.glb -o ./a.glb", "is an input").with("a.glb", "x"),
        case("light a.json -o a.json", "is an input").with("a.json", "{}"),
        case("light sky:40,3 -o out.hdr", ".json"),
        case("light sub -o out.json", "not a regular file").with_folder("sub"),
        case("light gone.hdr -o out.json", "gone.hdr"),
    ]
}
