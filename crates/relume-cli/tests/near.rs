//! Near lights as people use them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod bench;

use std::fs;

use bench::Bench;
use relume::files::npz;

/// A panel beside the scene and a ball before it.
const LAMPS: &str = r#"{"emitters": [
    {"name": "panel", "quad": [2, 2], "position": [3, 2, 0], "target": [0, 0, 0], "radiance": [4, 3, 2]},
    {"name": "ball", "sphere": 0.2, "position": [0, 3, 2], "radiance": 20}
]}"#;

fn lit(flags: &str) -> Bench {
    let bench = Bench::new();
    bench.bake("baked.glb", flags);
    fs::write(bench.path("lamps.json"), LAMPS).unwrap();
    bench
}

/// The radiance in a radiance.npz.
fn radiance(bench: &Bench, name: &str) -> Vec<f32> {
    npz::load(&bench.path(name), "radiance").unwrap().1
}

#[test]
fn emitters_light_an_asset_alone_and_with_the_sky() {
    let bench = lit("--order 4");
    bench.succeed("shade baked.glb --emitters lamps.json -o near.npz");
    bench.succeed("shade baked.glb --light sky:40,3 -o far.npz");
    bench.succeed("shade baked.glb --light sky:40,3 --emitters lamps.json -o both.npz");
    let [near, far, both] = ["near.npz", "far.npz", "both.npz"].map(|name| radiance(&bench, name));
    assert!(near.iter().any(|&x| x > 0.1));
    for ((near, far), both) in near.iter().zip(&far).zip(&both) {
        assert!((near + far - both).abs() < 1e-4 * (1.0 + both.abs()));
    }
    bench.succeed(
        "render baked.glb --emitters lamps.json -o look.png --size 64x48 --samples-per-pixel 1",
    );
    assert!(
        fs::read(bench.path("look.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn light_of_vertices_is_written_once_and_shaded_alike() {
    let bench = lit("--order 4");
    let said = bench
        .succeed("light --emitters lamps.json --for baked.glb -o light.npz")
        .1;
    assert!(said.contains("order 4 at"), "{said}");
    bench.succeed("shade baked.glb --light light.npz -o a.npz");
    bench.succeed("shade baked.glb --emitters lamps.json -o b.npz");
    assert!(fs::read(bench.path("a.npz")).unwrap() == fs::read(bench.path("b.npz")).unwrap());
    let said = bench
        .succeed(
            "light --emitters lamps.json --for baked.glb -o few.npz --budget 31 --epsilon 0.001",
        )
        .1;
    assert!(said.contains(" samples"), "{said}");
    let few = "light --emitters lamps.json --for baked.glb --budget 31";
    bench.succeed(&format!("{few} -o all.npz"));
    bench.succeed(&format!("{few} --eye 4,-9,0.5 -o below.npz"));
    let read = |name: &str| fs::read(bench.path(name)).unwrap();
    assert!(read("all.npz") != read("below.npz"));
    let said = bench.fail(
        2,
        "light --emitters lamps.json --for baked.glb --eye 1,2,3 -o x.npz",
    );
    assert!(said.contains("--budget"), "{said}");
    bench.succeed("light sky:30,3 --emitters lamps.json --for baked.glb -o sum.npz");
    let other = bench.fail(1, "shade scene.obj --light light.npz -o c.npz");
    assert!(other.contains("scene.obj"), "{other}");
}

/// A lamp within the scene's hull is seen from where it stands; a light.npz cannot say what is in its way.
#[test]
fn lamps_within_the_object_light_it() {
    let bench = lit("--order 4 --gather");
    // Over the floor, beside the box.
    let lamp = r#"{"emitters": [{"name": "lantern", "sphere": 0.05, "position": [0.9, 0.5, 0.2], "radiance": 300}]}"#;
    fs::write(bench.path("lantern.json"), lamp).unwrap();
    bench.succeed("shade baked.glb --emitters lantern.json -o direct.npz");
    bench.succeed("shade baked.glb --emitters lantern.json --bounces 2 -o bounced.npz");
    let sum = |name: &str| radiance(&bench, name).iter().sum::<f32>();
    assert!(sum("direct.npz") > 1.0 && sum("bounced.npz") > sum("direct.npz"));
    let line = "compare baked.glb --emitters lantern.json --vertices 20 --paths 4096 --json";
    let figures: serde_json::Value = serde_json::from_str(&bench.succeed(line).0).unwrap();
    let error = figures["relative_rms"]["value"].as_f64().unwrap();
    assert!(error < 0.01, "{error}");
    let said = bench.fail(
        1,
        "light --emitters lantern.json --for baked.glb -o light.npz",
    );
    assert!(
        said.contains("\"lantern\"") && said.contains("convex hull"),
        "{said}"
    );
    assert!(!bench.path("light.npz").exists());
    bench.bake("folded.glb", "--order 4 --bounces 1");
    let said = bench.fail(1, "shade folded.glb --emitters lantern.json -o x.npz");
    assert!(said.contains("--bounces 0 --gather"), "{said}");
}

#[test]
fn the_lanterns_of_the_readme_are_emitters() {
    let file =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/lanterns.json");
    let (emitters, warnings) = relume::light::emitter::load(&file).unwrap();
    assert_eq!((emitters.emitters().len(), warnings.len()), (5, 0));
}

#[test]
fn bounces_are_gathered_when_light_varies() {
    let bench = lit("--order 4 --gather");
    bench.succeed("shade baked.glb --emitters lamps.json -o direct.npz");
    bench.succeed("shade baked.glb --emitters lamps.json --bounces 2 -o bounced.npz");
    let sum = |name: &str| radiance(&bench, name).iter().sum::<f32>();
    assert!(sum("bounced.npz") > 1.001 * sum("direct.npz"));
    bench.bake("folded.glb", "--order 4 --bounces 1");
    let said = bench.fail(1, "shade folded.glb --emitters lamps.json -o x.npz");
    assert!(said.contains("--bounces 0 --gather"), "{said}");
    bench.bake("bare.glb", "--order 4");
    let said = bench.fail(
        1,
        "render bare.glb --emitters lamps.json --bounces 1 -o x.png",
    );
    assert!(said.contains("--gather"), "{said}");
    assert!(!bench.path("x.png").exists());
}

#[test]
fn emitters_are_compared_with_paths() {
    let bench = lit("--order 8 --gather");
    let said = bench
        .succeed(
            "compare baked.glb --emitters lamps.json --bounces 1 --vertices 20 --paths 4096 --json",
        )
        .0;
    let figures: serde_json::Value = serde_json::from_str(&said).unwrap();
    let error = figures["relative_rms"]["value"].as_f64().unwrap();
    assert!(error < 0.1, "{said}");
    bench.succeed("light --emitters lamps.json --for baked.glb -o light.npz");
    let said = bench.fail(1, "compare baked.glb --light light.npz");
    assert!(said.contains("--emitters"), "{said}");
}

#[test]
fn emitters_on_glossy_assets_are_compared_toward_an_eye_bounces_and_all() {
    let how = "--order 8 --transfer glossy --transfer-order 8 --brdf phong --kd 0.4,0.4,0.4 --ks 0.3 --exponent 5";
    let bench = lit(how);
    let line = "compare baked.glb --emitters lamps.json --eye 2,4,3 --vertices 20 --paths 4096";
    let said = bench.succeed(&format!("{line} --json")).0;
    let figures: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(figures["eye"][1].as_f64(), Some(4.0), "{said}");
    let error = figures["relative_rms"]["value"].as_f64().unwrap();
    assert!(error < 0.1, "{said}");
    let said = bench.succeed(&format!("{line} --bounces 1 --json")).0;
    let figures: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(figures["bounces"].as_u64(), Some(1), "{said}");
    let error = figures["relative_rms"]["value"].as_f64().unwrap();
    assert!(error < 0.1, "{said}");
    for bounces in [0, 1] {
        let line = format!(
            "render baked.glb --emitters lamps.json --bounces {bounces} --size 64x36 --exposure 0 -o {bounces}.png"
        );
        bench.succeed(&line);
    }
    let [direct, bounced] = ["0.png", "1.png"].map(|name| fs::read(bench.path(name)).unwrap());
    assert_ne!(direct, bounced);
    bench.bake("folded.glb", &format!("{how} --bounces 1"));
    let line = "render folded.glb --emitters lamps.json --bounces 1 -o x.png";
    let said = bench.fail(1, line);
    assert!(
        said.contains("folded.glb: ") && said.contains("--bounces 0"),
        "{said}"
    );
}

#[test]
fn what_shines_must_be_said_and_all_that_may_is_named() {
    let bench = lit("--order 2");
    for line in [
        "shade baked.glb -o x.npz",
        "render baked.glb -o x.png",
        "compare baked.glb",
    ] {
        let said = bench.fail(2, line);
        assert!(said.contains("--light <ENV>|--emitters <FILE>"), "{said}");
    }
    let said = bench.fail(2, "light -o x.npz");
    assert!(said.contains("ENV|--emitters <FILE>"), "{said}");
}

#[test]
fn what_is_no_emitter_is_said_in_one_line() {
    let bench = lit("--order 2");
    for (text, needle) in [
        ("{}", "emitters"),
        (r#"{"emitters": [{"quad": [1, 1]}]}"#, "radiance"),
        (
            r#"{"emitters": [{"quad": [1, 1], "radiance": -1}]}"#,
            "radiance",
        ),
        (
            r#"{"emitters": [{"quad": [1, 1], "radiance": 1, "colour": 2}]}"#,
            "colour",
        ),
        ("[[[[", "bad.json"),
    ] {
        fs::write(bench.path("bad.json"), text).unwrap();
        let said = bench.fail(1, "shade baked.glb --emitters bad.json -o x.npz");
        assert!(said.contains(needle) && said.contains("bad.json"), "{said}");
        assert!(!bench.path("x.npz").exists());
    }
    bench.fail(
        1,
        "light --emitters lamps.json --for baked.glb -o lamps.json",
    );
    bench.fail(1, "light --emitters missing.json --for baked.glb -o x.npz");
}

#[test]
fn a_papers_table_is_measured_on_any_mesh() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    let line = "reproduce sun2005 4.1 --mesh baked.glb --samples 16 --picture four.png";
    let (table, said) = bench.succeed(line);
    for needle in ["[paper] theirs", "paper's method", "exact at every vertex"] {
        assert!(table.contains(needle), "{table}");
    }
    assert!(said.contains("wrote four.png"), "{said}");
    bench.fail(
        1,
        "reproduce sun2005 4.1 --mesh baked.glb --picture four.gif",
    );
    bench.fail(2, "reproduce sun2005 4.9 --mesh baked.glb");
    bench.fail(2, "reproduce sun1905 4.1 --mesh baked.glb");
}
