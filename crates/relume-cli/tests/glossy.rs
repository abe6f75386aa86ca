//! Glossy transfer as people use it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod bench;

use std::fs;

use bench::Bench;

const PHONG: &str = "--transfer glossy --transfer-order 4 --order 3 --brdf phong --kd 0.3,0.2,0.1 --ks 0.4 --exponent 6";

#[test]
fn a_glossy_model_is_baked_described_and_looked_at() {
    let bench = Bench::new();
    bench.bake("baked.glb", &format!("{PHONG} --bounces 1"));
    let about = bench.succeed("info baked.glb").0;
    assert!(about.contains("glossy, shadowed, 1 bounce"), "{about}");
    assert!(about.contains("radiance of order 4"), "{about}");
    let json: serde_json::Value =
        serde_json::from_str(&bench.succeed("info baked.glb --json").0).unwrap();
    assert_eq!(json["transfer_order"], 4);
    bench.succeed("shade baked.glb --light sky:40,3 --eye 3,2,3 -o radiance.npz");
    let said = bench
        .succeed("export baked.glb -o compound.npz --compound 6")
        .1;
    assert!(said.contains(", 3, 36, 9]"), "{said}");
    bench.succeed(
        "render baked.glb --light sky:40,3 -o look.png --size 64x48 --samples-per-pixel 1",
    );
    assert!(
        fs::read(bench.path("look.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn threads_and_tiles_do_not_change_matrices() {
    let bench = Bench::new();
    bench.bake(
        "one.glb",
        &format!("{PHONG} --bounces 2 --threads 1 --tracer portable"),
    );
    bench.bake("many.glb", &format!("{PHONG} --bounces 2 --threads 3"));
    assert!(fs::read(bench.path("one.glb")).unwrap() == fs::read(bench.path("many.glb")).unwrap());
}

#[test]
fn an_order_is_chosen_and_said() {
    let bench = Bench::new();
    let orders = ["0.9", "0.3"].map(|roughness| {
        let said = bench.succeed(&format!(
            "bake scene.obj -o baked.glb --samples 16 --transfer glossy --order 2 --brdf ggx --metallic 1 --roughness {roughness}"
        ));
        let said = said.1;
        let line = said.lines().find(|line| line.starts_with("transfer order ")).unwrap();
        let number = line.split([' ', ';']).nth(2).unwrap();
        number.parse::<u32>().unwrap()
    });
    assert!(orders[0] < orders[1] && orders[1] <= 10, "{orders:?}");
}

#[test]
fn flags_that_do_not_go_together_exit_with_2_and_assets_that_do_not_with_1() {
    let bench = Bench::new();
    for flags in [
        "--brdf phong",
        "--transfer-order 5",
        "--transfer glossy --kd 1,1,1",
        "--transfer glossy --brdf ggx --exponent 3",
        "--transfer glossy --brdf phong --kd 0.8,0.8,0.8 --ks 0.5",
        "--transfer glossy --brdf ggx --roughness 1.5",
        "--transfer glossy --gather",
    ] {
        bench.fail(2, &format!("bake scene.obj -o out.glb {flags}"));
        assert!(!bench.path("out.glb").exists(), "{flags}");
    }
    bench.fail(2, "export scene.glb -o compound.npz --compound 33");
    bench.bake("glossy.glb", PHONG);
    bench.bake("diffuse.glb", "");
    for line in [
        "shade glossy.glb --light sky:40,3 -o radiance.npz",
        "shade diffuse.glb --light sky:40,3 --eye 1,2,3 -o radiance.npz",
        "compare glossy.glb --light sky:40,3",
        "export diffuse.glb -o compound.npz --compound 4",
    ] {
        bench.fail(1, line);
    }
}
