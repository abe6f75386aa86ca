//! The program as people use it: what it writes, what it says, how it exits.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod bench;

use std::fs;

use bench::Bench;

#[test]
fn a_model_is_baked_relit_and_looked_at() {
    let bench = Bench::new();
    bench.bake("baked.glb", "--bounces 1");
    let (_, said) = bench.succeed("light sky:40,3 -o light.json --window auto --rotate 0,1,0:30");
    assert!(said.contains("wrote light.json"));
    bench.succeed("shade baked.glb --light light.json -o radiance.npz");
    bench.succeed("export baked.glb -o transfer.npz");
    bench.succeed(
        "render baked.glb --light sky:40,3 -o look.png --size 64x48 --samples-per-pixel 1",
    );
    bench.succeed("render baked.glb --light light.json -o look.exr --size 64x48 --eye 3,2,3 --target 0,0,0 --fov 50");
    let (table, _) =
        bench.succeed("compare baked.glb --light light.json --vertices 20 --paths 4096");
    assert!(
        table.contains("relative RMS error") && table.contains("bias"),
        "{table}"
    );
    for (name, magic) in [
        ("look.png", &b"\x89PNG"[..]),
        ("look.exr", b"v/1\x01"),
        ("radiance.npz", b"PK"),
        ("transfer.npz", b"PK"),
    ] {
        assert!(
            fs::read(bench.path(name)).unwrap().starts_with(magic),
            "{name}"
        );
    }
}

#[test]
fn info_tells_assets_scenes_and_lights_apart() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    bench.succeed("light constant:1,1,1 -o light.json --order 3");
    assert!(bench.succeed("info scene.obj").0.contains("not baked yet"));
    assert!(bench.succeed("info light.json").0.contains("order 3"));
    let about_asset = bench.succeed("info baked.glb").0;
    assert!(
        about_asset.contains("order") && about_asset.contains("vertices"),
        "{about_asset}"
    );
}

#[test]
fn half_floats_take_half_the_room_and_info_says_so() {
    let bench = Bench::new();
    bench.bake("floats.glb", "--bounces 1 --precision f32");
    bench.bake("plain.glb", "--bounces 1");
    bench.bake("halves.glb", "--bounces 1 --precision f16");
    let size = |name: &str| fs::metadata(bench.path(name)).unwrap().len();
    assert!(
        fs::read(bench.path("floats.glb")).unwrap() == fs::read(bench.path("plain.glb")).unwrap()
    );
    let about = |name: &str| -> serde_json::Value {
        serde_json::from_str(&bench.succeed(&format!("info {name} --json")).0).unwrap()
    };
    let [floats, halves] = ["floats.glb", "halves.glb"].map(about);
    assert_eq!(
        (&floats["precision"], &halves["precision"]),
        (&"f32".into(), &"f16".into())
    );
    let [large, small] = [&floats, &halves].map(|about| about["transfer_bytes"].as_u64().unwrap());
    assert_eq!(large, 2 * small);
    // Besides, headers name a hash, and arrays begin at multiples of four.
    assert!((size("floats.glb") - size("halves.glb")).abs_diff(small) < 64);
    let (said, _) = bench.succeed("info halves.glb");
    assert!(said.contains("f16: rounded to half floats"), "{said}");
    let [exact, rounded] = ["floats.glb", "halves.glb"]
        .map(|name| relume::asset::read(&bench.path(name)).unwrap().transfer);
    let squares =
        |values: &mut dyn Iterator<Item = f32>| values.map(|x| f64::from(x).powi(2)).sum::<f64>();
    let pairs = exact.coefficients.iter().zip(&*rounded.coefficients);
    let error = squares(&mut pairs.map(|(exact, rounded)| exact - rounded));
    let error = (error / squares(&mut exact.coefficients.iter().copied())).sqrt();
    // No number is further from its half float than 2⁻¹¹ of it.
    assert!(error > 0.0 && error < 2.0_f64.powi(-11), "{error}");
}

#[test]
fn threads_do_not_change_the_asset() {
    let bench = Bench::new();
    bench.bake("one.glb", "--bounces 2 --threads 1");
    bench.bake("three.glb", "--bounces 2 --threads 3");
    assert!(fs::read(bench.path("one.glb")).unwrap() == fs::read(bench.path("three.glb")).unwrap());
}

#[test]
fn sweeps_are_numbered_frames() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    for sweep in ["light", "camera"] {
        bench.succeed(&format!(
            "render baked.glb --light sun:1,1,0,20,9,9,9 -o {sweep}_%02d.png --frames 3 --sweep {sweep} --size 16x16"
        ));
        let frames: Vec<Vec<u8>> = (0..3)
            .map(|i| fs::read(bench.path(&format!("{sweep}_0{i}.png"))).unwrap())
            .collect();
        assert!(
            frames[0] != frames[1] && frames[1] != frames[2],
            "{sweep} does not move"
        );
    }
}

#[test]
fn a_coarse_mesh_is_told_about_the_flag_and_a_split_one_is_not() {
    let bench = Bench::new();
    let (_, warned) = bench.succeed("bake scene.obj -o coarse.glb --samples 16");
    assert!(
        warned.contains("warning") && warned.contains("--max-edge"),
        "{warned}"
    );
    let (_, quiet) = bench.succeed("bake scene.obj -o fine.glb --samples 16 --max-edge auto");
    assert!(!quiet.contains("--max-edge"), "{quiet}");
}

#[test]
fn what_the_command_line_shows_to_be_wrong_exits_with_2() {
    let bench = Bench::new();
    for line in [
        "bake scene.obj",
        "bake scene.obj -o a.glb --order 33",
        "bake scene.obj -o a.glb --samples 0",
        "bake scene.obj -o a.glb --albedo 2,0,0",
        "bake scene.obj -o a.glb --max-edge -1",
        "bake scene.obj -o a.glb --no-shadows --bounces 2",
        "bake scene.obj -o a.glb --threads 0",
        "light sun:1,2 -o l.json",
        "light constant:NaN,0,0 -o l.json",
        "light sky:40,3 -o l.json --rotate up:90",
        "render a.glb --light sky:40,3 -o p.png --size 0x0",
        "render a.glb --light sky:40,3 -o p.png --frames 3",
        "unknown",
    ] {
        bench.fail(2, line);
    }
}

#[test]
fn inputs_that_are_wrong_exit_with_1_and_one_line() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    fs::write(bench.path("text.glb"), "not a glb").unwrap();
    fs::write(bench.path("empty.obj"), "v 0 0 0\n").unwrap();
    fs::write(bench.path("broken.json"), "{\"basis\": \"sh\"").unwrap();
    fs::write(bench.path("noise.hdr"), [7_u8; 64]).unwrap();
    for (line, part) in [
        ("bake missing.obj -o a.glb", "missing.obj"),
        ("bake text.glb -o a.glb", "text.glb"),
        ("bake empty.obj -o a.glb", "nothing to bake"),
        ("bake scene.obj -o a.npz", ".glb"),
        ("bake scene.obj -o nowhere/a.glb", "no such folder"),
        ("shade text.glb --light sky:40,3 -o r.npz", "text.glb"),
        ("shade baked.glb --light noise.hdr -o r.npz", "noise.hdr"),
        (
            "shade baked.glb --light broken.json -o r.npz",
            "broken.json",
        ),
        (
            "shade baked.glb --light missing.hdr -o r.npz",
            "missing.hdr",
        ),
        ("export baked.glb -o t.csv", ".npz"),
        ("render baked.glb --light sky:40,3 -o p.jpg", ".png"),
        (
            "render baked.glb --light sky:40,3 -o p.png --frames 2 --sweep light",
            "%04d",
        ),
        (
            "render baked.glb --light sky:40,3 -o p.png --eye 0,0,0 --target 0,0,0",
            "eye",
        ),
        ("info missing.glb", "missing.glb"),
    ] {
        let error = bench.fail(1, line);
        assert!(error.contains(part), "relume {line}\n{error}");
    }
}

#[test]
fn inputs_are_not_written_over() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    bench.succeed("light constant:1,1,1 -o light.json");
    for line in [
        "bake baked.glb -o baked.glb",
        "bake baked.glb -o ./baked.glb",
        "light light.json -o light.json",
    ] {
        assert!(bench.fail(1, line).contains("is an input"), "{line}");
    }
}

#[test]
fn frames_are_not_written_over_the_light() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    bench.succeed("render baked.glb --light constant:1,1,1 -o f_1.png --size 8x4");
    let line = "render baked.glb --light f_1.png -o f_%d.png --frames 2 --sweep light";
    assert!(bench.fail(1, line).contains("f_1.png: is an input"));
}

#[test]
fn every_help_page_shows_examples() {
    let bench = Bench::new();
    assert!(bench.succeed("--help").0.contains("Examples:"));
    for verb in [
        "demo",
        "bake",
        "light",
        "shade",
        "render",
        "view",
        "compare",
        "export",
        "info",
        "completions",
    ] {
        let (page, _) = bench.succeed(&format!("{verb} --help"));
        assert!(
            page.contains(&format!("relume {verb}")),
            "{verb} has no example"
        );
    }
}
