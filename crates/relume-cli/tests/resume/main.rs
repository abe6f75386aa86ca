//! Bakes that are killed, interrupted, fought over and starved, and what `--resume` makes of them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

#[path = "../bench/mod.rs"]
mod bench;
mod disturb;
mod refused;

use std::fs;

use bench::Bench;
use disturb::{Random, copy, counted, killed, partial, recorded, temporaries, there};

/// Some 20 tiles in each of three passes, a second or two.
const LINE: &str = "bake scene.obj -o out.glb --samples 128 --max-edge 0.08 --bounces 2";
const STREAMS: [&str; 3] = ["direct", "bounce-1", "bounce-2"];
/// What this machine has, for `--tracer`.
fn tracers() -> Vec<&'static str> {
    let has = |name: &&str| name.parse::<relume::bake::Engine>().is_ok();
    ["portable", "avx2", "avx512"]
        .into_iter()
        .filter(has)
        .collect()
}

fn output(bench: &Bench) -> Vec<u8> {
    fs::read(bench.path("out.glb")).unwrap()
}

/// The bytes of [`LINE`] undisturbed, and its number of tiles in a pass; the output is gone again.
fn undisturbed(bench: &Bench) -> (Vec<u8>, usize) {
    let (_, said) = bench.succeed(&format!("{LINE} --json"));
    assert_eq!(counted(&said), None);
    let bytes = output(bench);
    fs::remove_file(bench.path("out.glb")).unwrap();
    let vertices = relume::asset::from_glb(&bytes)
        .unwrap()
        .transfer
        .vertex_count();
    (bytes, vertices.div_ceil(256))
}

/// Resumes what was killed, to the end: the counter is that of the tiles that were there, the bytes are `expected`, and nothing else is left.
fn finish(bench: &Bench, flags: &str, expected: &[u8], tiles: usize) -> usize {
    let reused = there(bench);
    let (_, said) = bench.succeed(&format!("{LINE} --resume {flags}"));
    assert_eq!(counted(&said), Some((reused, 3 * tiles)), "{said}");
    assert!(output(bench) == expected, "other bytes with {flags}");
    assert_eq!(bench.names(), ["out.glb", "scene.mtl", "scene.obj"]);
    fs::remove_file(bench.path("out.glb")).unwrap();
    reused
}

#[test]
fn killed_in_any_pass_a_bake_goes_on_from_there_to_the_same_bytes() {
    let bench = Bench::new();
    let (expected, tiles) = undisturbed(&bench);
    assert!(tiles > 10, "{tiles} tiles are too few to be killed among");
    let tracers = tracers();
    let mut random = Random(3);
    for run in 0..3 {
        let mut last = 0;
        for stream in STREAMS {
            let moment = 1 + random.below(tiles - 3);
            // Each on other threads and other instructions than the one before.
            let threads = 1 + random.below(3);
            let tracer = tracers[random.below(tracers.len())];
            let line = format!("{LINE} --resume --threads {threads} --tracer {tracer}");
            if killed(&bench, &line, || recorded(&bench, stream) >= moment) {
                println!(
                    "run {run}: killed in {stream}: {} tiles are there",
                    there(&bench)
                );
                assert!(there(&bench) >= last && recorded(&bench, stream) >= moment);
                last = there(&bench);
            } else {
                // A pass that was quicker than we looked: from the start.
                fs::remove_file(bench.path("out.glb")).unwrap();
                last = 0;
            }
        }
        // If all three were missed, the machine cannot run this test.
        assert!(last > 0);
        let flags = format!(
            "--threads {} --tracer {}",
            3 - run,
            tracers[run % tracers.len()]
        );
        assert_eq!(finish(&bench, &flags, &expected, tiles), last);
    }
}

#[test]
fn killed_in_the_final_write_a_bake_leaves_nothing_that_the_next_one_does_not_remove() {
    let bench = Bench::new();
    let (expected, tiles) = undisturbed(&bench);
    let in_bounces = || recorded(&bench, "bounce-2") > tiles / 2;
    while !killed(&bench, LINE, in_bounces) {
        fs::remove_file(bench.path("out.glb")).unwrap();
    }
    // The write takes a moment only: as often as it takes to hit it.
    let saved = bench.path("saved");
    copy(&partial(&bench), &saved);
    let resume = format!("{LINE} --resume");
    let mut hits = 0;
    for _ in 0..200 {
        if killed(&bench, &resume, || !temporaries(&bench).is_empty())
            && !bench.path("out.glb").exists()
        {
            hits += 1;
            break;
        }
        let _ = fs::remove_file(bench.path("out.glb"));
        let _ = fs::remove_dir_all(partial(&bench));
        copy(&saved, &partial(&bench));
    }
    assert_eq!(hits, 1, "the final write was never hit");
    assert_eq!(temporaries(&bench).len(), 1);
    fs::remove_dir_all(&saved).unwrap();
    // Somebody else's stay.
    fs::write(bench.path(".relume-other.glb-abcdef.tmp"), "x").unwrap();
    let (_, said) = bench.succeed(&resume);
    assert_eq!(counted(&said), Some((3 * tiles, 3 * tiles)), "{said}");
    assert!(output(&bench) == expected);
    assert_eq!(
        bench.names(),
        [
            ".relume-other.glb-abcdef.tmp",
            "out.glb",
            "scene.mtl",
            "scene.obj"
        ]
    );
}

#[test]
fn what_is_finished_is_resumed_at_once_and_its_checkpoint_goes() {
    let bench = Bench::new();
    assert!(killed(&bench, LINE, || recorded(&bench, "direct") > 1));
    let saved = bench.path("saved");
    copy(&partial(&bench), &saved);
    bench.succeed(&format!("{LINE} --resume"));
    let bytes = output(&bench);
    let written = || {
        fs::metadata(bench.path("out.glb"))
            .unwrap()
            .modified()
            .unwrap()
    };
    let before = written();
    // As if killed between the final write and the removal; half way through the removal; and with nothing left.
    let lefts: [&[&str]; 4] = [
        &[],
        &["direct.journal", "found.tiles"],
        &["relume-checkpoint.json"],
        &["lock"],
    ];
    for gone in lefts {
        copy(&saved, &partial(&bench));
        for name in gone {
            fs::remove_file(partial(&bench).join(name)).unwrap();
        }
        if gone == ["relume-checkpoint.json"] {
            // By then the streams are gone.
            for entry in fs::read_dir(partial(&bench)).unwrap() {
                let path = entry.unwrap().path();
                if !path.ends_with("lock") {
                    fs::remove_file(path).unwrap();
                }
            }
        }
        let (out, said) = bench.succeed(&format!("{LINE} --resume"));
        assert!(
            said.contains("out.glb is this bake, finished") && out.is_empty(),
            "{said}"
        );
        assert!(!partial(&bench).exists(), "without {gone:?}: {said}");
    }
    let (out, _) = bench.succeed(&format!("{LINE} --resume --json"));
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&value["rays"], &value["bounces"]), (&0.into(), &2.into()));
    assert_eq!(value["file_bytes"], bytes.len());
    // A checkpoint of another bake is not ours to remove; the output is finished all the same.
    copy(&saved, &partial(&bench));
    let header = partial(&bench).join("relume-checkpoint.json");
    let other = fs::read_to_string(&header)
        .unwrap()
        .replace("\"128\"", "\"129\"");
    fs::write(&header, other).unwrap();
    let (_, said) = bench.succeed(&format!("{LINE} --resume"));
    assert!(
        said.contains("finished") && said.contains("--samples was 129, is 128"),
        "{said}"
    );
    assert!(partial(&bench).exists());
    assert_eq!((output(&bench) == bytes, written()), (true, before));
    // Other options are another bake, and this one is not finished.
    fs::remove_dir_all(partial(&bench)).unwrap();
    let (_, said) = bench.succeed("bake scene.obj -o out.glb --samples 16 --resume");
    assert!(said.contains("no interrupted bake is there"), "{said}");
    assert_ne!(output(&bench), bytes);
}

#[test]
fn half_floats_are_resumed_to_the_same_bytes_and_are_another_bake_than_floats() {
    let bench = Bench::new();
    let line = format!("{LINE} --precision f16");
    bench.succeed(&line);
    let expected = output(&bench);
    fs::remove_file(bench.path("out.glb")).unwrap();
    assert!(killed(&bench, &line, || recorded(&bench, "bounce-1") > 2));
    let before = there(&bench);
    let (_, said) = bench.succeed(&format!("{line} --resume"));
    assert_eq!(counted(&said).unwrap().0, before, "{said}");
    assert!(output(&bench) == expected);
    let (_, said) = bench.succeed(&format!("{line} --resume"));
    assert!(said.contains("out.glb is this bake, finished"), "{said}");
    let (_, said) = bench.succeed(&format!("{LINE} --resume"));
    assert!(said.contains("no interrupted bake is there"), "{said}");
    assert!(output(&bench).len() > expected.len());
    let (_, said) = bench.succeed(&format!("{line} --resume"));
    assert!(said.contains("no interrupted bake is there"), "{said}");
    assert!(output(&bench) == expected);
}

#[test]
fn without_resume_a_bake_starts_afresh_and_says_so() {
    let bench = Bench::new();
    let (expected, _) = undisturbed(&bench);
    assert!(killed(&bench, LINE, || recorded(&bench, "direct") > 1));
    let (_, said) = bench.succeed(LINE);
    assert!(
        said.contains("out.glb.partial: an interrupted bake was there"),
        "{said}"
    );
    assert_eq!(counted(&said), None);
    assert!(output(&bench) == expected && !partial(&bench).exists());
}

#[test]
fn threads_instructions_and_bounces_leave_the_bytes_as_they_are() {
    let bench = Bench::new();
    for bounces in [0, 2] {
        let mut expected: Option<Vec<u8>> = None;
        for tracer in tracers() {
            for threads in 1..=3 {
                let flags = format!("--bounces {bounces} --threads {threads} --tracer {tracer}");
                bench.bake("out.glb", &flags);
                let bytes = output(&bench);
                assert!(
                    bytes == *expected.get_or_insert_with(|| bytes.clone()),
                    "{flags}"
                );
            }
        }
    }
}
