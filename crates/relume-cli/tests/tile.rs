//! Tiles as people use them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod bench;

use std::fs;

use bench::Bench;

/// A ridge along z in the middle of a period.
const RELIEF: &str = "v 0 0 0\nv 0.5 0.4 0\nv 1 0 0\nv 0 0 1\nv 0.5 0.4 1\nv 1 0 1\n\
                      f 1 4 5 2\nf 2 5 6 3\n";
/// A square that faces up, and its image.
const FLOOR: &str = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
                     f 1/1 2/2 3/3 4/4\n";

fn bench() -> Bench {
    let bench = Bench::new();
    fs::write(bench.path("relief.obj"), RELIEF).unwrap();
    fs::write(bench.path("floor.obj"), FLOOR).unwrap();
    bench
}

const SMALL: &str = "--size 8 --views 3 --order 3 --samples 16";
const COVER: &str = "--order 3 --samples 16 --transfer glossy --transfer-order 3";

#[test]
fn a_relief_becomes_a_tile_that_covers_a_scene() {
    let bench = bench();
    let said = bench
        .succeed(&format!("tile relief.obj -o ridge.npz {SMALL}"))
        .1;
    assert!(
        said.contains("8 × 8 texels, 3 × 3 views, order 3"),
        "{said}"
    );
    let first = fs::read(bench.path("ridge.npz")).unwrap();
    bench.succeed(&format!("tile relief.obj -o again.npz {SMALL}"));
    assert!(fs::read(bench.path("again.npz")).unwrap() == first);

    bench.succeed(&format!(
        "bake floor.obj -o baked.glb {COVER} --brdf ridge.npz --repeat 3"
    ));
    let about = bench.succeed("info baked.glb").0;
    assert!(about.contains("a tile of 8 × 8 texels"), "{about}");
    // The asset has it: the file may go.
    fs::remove_file(bench.path("ridge.npz")).unwrap();
    let view = "--light sun:-1,1,0,10,5,5,5 --eye 0.5,2,0.6 --target 0.5,0,0.5 --fov 20 --size 96x96 --samples-per-pixel 4";
    bench.succeed(&format!("render baked.glb -o tile.png {view}"));
    bench.succeed(&format!(
        "bake floor.obj -o plain.glb {COVER} --brdf lambert"
    ));
    bench.succeed(&format!("render plain.glb -o plain.png {view}"));
    let size = |name: &str| fs::metadata(bench.path(name)).unwrap().len();
    // A plain floor is one colour; ridges are not.
    assert!(size("tile.png") > 2 * size("plain.png"));
    bench.succeed("shade baked.glb --light sky:40,3 --eye 1,2,1 -o radiance.npz");
    let refused = bench.fail(1, "compare baked.glb --light sky:40,3 --eye 1,2,1");
    assert!(refused.contains("covered with a tile"), "{refused}");
}

#[test]
fn what_is_no_tile_or_no_relief_is_refused_in_a_line() {
    let bench = bench();
    fs::write(bench.path("text.npz"), "not an archive").unwrap();
    for (status, line, part) in [
        (
            1,
            format!("bake floor.obj -o out.glb {COVER} --brdf text.npz"),
            "is no .npz file",
        ),
        (
            1,
            format!("bake floor.obj -o out.glb {COVER} --brdf none.npz"),
            "none.npz: ",
        ),
        (
            2,
            format!("bake floor.obj -o out.glb {COVER} --brdf phong --repeat 3"),
            "--repeat is not of",
        ),
        (
            2,
            format!("bake floor.obj -o out.glb {COVER} --brdf text.npz --repeat 0"),
            "not a number in",
        ),
        (
            2,
            "tile relief.obj -o out.npz --period 0,1".to_owned(),
            "not two positive lengths",
        ),
        (
            2,
            "tile relief.obj -o out.npz --views 1".to_owned(),
            "--views",
        ),
        (1, "tile relief.obj -o out.png".to_owned(), ".npz"),
        (1, "tile none.obj -o out.npz".to_owned(), "none.obj"),
    ] {
        let said = bench.fail(status, &line);
        assert!(said.contains(part), "{line}: {said}");
        assert!(!bench.path("out.glb").exists() && !bench.path("out.npz").exists());
    }
    // These read the scene first, and warn of it.
    for (flags, part) in [
        ("--period 0.3,1", "a --period of 0.3 × 1"),
        ("--size 1024 --views 64", "take another --size"),
    ] {
        let output = bench.run(&format!("tile relief.obj -o out.npz {flags}"));
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.lines().last().unwrap().contains(part), "{said}");
        assert!(!bench.path("out.npz").exists());
    }
    // Without texture coordinates the mean of a tile is shown, and that is said.
    bench.succeed(&format!("tile relief.obj -o ridge.npz {SMALL}"));
    let said = bench
        .succeed(&format!(
            "bake relief.obj -o out.glb {COVER} --brdf ridge.npz"
        ))
        .1;
    assert!(
        said.contains("no texture coordinates for the tile"),
        "{said}"
    );
}
