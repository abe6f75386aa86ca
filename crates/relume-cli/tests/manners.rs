//! The program for other programs and for strangers: JSON, completions, error pictures, explanations.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod bench;

use std::fs;
use std::process::Command;

use bench::Bench;

/// The value that a line prints on stdout as JSON, each of its names being promised in docs/json.md.
fn json(bench: &Bench, line: &str) -> serde_json::Value {
    let (out, _) = bench.succeed(line);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    let promises = include_str!("../../../docs/json.md");
    let mut left = vec![&value];
    while let Some(value) = left.pop() {
        match value {
            serde_json::Value::Object(map) => {
                for (name, value) in map {
                    assert!(promises.contains(&format!("`{name}`")), "{name}: {line}");
                    left.push(value);
                }
            }
            serde_json::Value::Array(values) => left.extend(values),
            _ => (),
        }
    }
    value
}

#[test]
fn json_is_printed_on_stdout_under_promised_names() {
    let bench = Bench::new();
    let baked = json(
        &bench,
        "bake scene.obj -o baked.glb --samples 64 --bounces 1 --json",
    );
    let size = fs::metadata(bench.path("baked.glb")).unwrap().len();
    assert_eq!(baked["file_bytes"], size);
    // Twelve corners in the file; the floor and the box share none.
    assert_eq!(baked["vertices"], baked["input_vertices"]);
    // The bounce reuses what they met.
    assert_eq!(baked["rays"], baked["vertices"].as_u64().unwrap() * 64);
    assert_eq!(baked["channels"], 3);
    let info = json(&bench, "info baked.glb --json");
    for (name, value) in info.as_object().unwrap() {
        assert_eq!(value, &baked[name], "{name}");
    }
    let open = json(&bench, "bake scene.obj -o open.glb --no-shadows --json");
    assert_eq!(
        (&open["bounces"], &open["rays"], &open["shadows"]),
        (&serde_json::Value::Null, &0.into(), &false.into())
    );
    let scene = json(&bench, "info scene.obj --json");
    assert_eq!(
        (&scene["kind"], &scene["triangles"]),
        (&"scene".into(), &14.into())
    );
    assert_eq!(scene["bounds_low"], serde_json::json!([-2.0, 0.0, -2.0]));
    bench.succeed("light constant:1,1,1 -o light.json --order 3");
    let light = json(&bench, "info light.json --json");
    assert_eq!(
        (&light["kind"], &light["coefficients"]),
        (&"light".into(), &9.into())
    );
    bench.succeed(
        "render baked.glb --light constant:1,1,1 -o look.exr --size 8x4 --samples-per-pixel 1",
    );
    let image = json(&bench, "info look.exr --json");
    assert_eq!(
        (&image["kind"], &image["layout"]),
        (&"image".into(), &"latlong".into())
    );
}

#[test]
fn a_comparison_is_the_same_in_words_and_in_json_and_can_be_seen() {
    let bench = Bench::new();
    bench.bake("baked.glb", "--bounces 1");
    let line = "compare baked.glb --light sky:40,3 --vertices 20 --paths 1024";
    let (words, _) = bench.succeed(line);
    let value = json(
        &bench,
        &format!("{line} --json --picture error.png --size 96x64"),
    );
    let rms = 100.0 * value["relative_rms"]["value"].as_f64().unwrap();
    assert!(words.contains(&format!("{rms:.3} %")), "{rms} in {words}");
    assert_eq!(value["worst"][0]["ours"].as_array().unwrap().len(), 3);
    let picture = &value["picture"];
    let figure = |name: &str| picture[name].as_f64().unwrap();
    // Ours is nearly right: its error is not much more than the noise and far less than the light.
    assert!(
        figure("noise") > 0.0 && figure("relative_rms") < 0.5,
        "{picture}"
    );
    assert!(figure("largest") >= figure("relative_rms"), "{picture}");
    // Width and height stand at bytes 16 and 20: three views with gaps, and the scale below.
    let png = fs::read(bench.path("error.png")).unwrap();
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    assert_eq!(number(16), 3 * 96 + 2 * 4);
    assert!(number(20) > 64);
    let (words, _) = bench.succeed(&format!("{line} --picture error.png --size 96x64"));
    assert!(words.contains("full colour at ±"), "{words}");
    assert_eq!(fs::read(bench.path("error.png")).unwrap(), png);
}

#[test]
fn error_pictures_that_cannot_be_are_refused() {
    let bench = Bench::new();
    bench.bake("baked.glb", "");
    bench.succeed("bake scene.obj -o open.glb --no-shadows");
    let compare = |rest: &str| format!("compare {rest} --light sky:40,3 --vertices 2 --paths 64");
    for (line, part) in [
        (compare("baked.glb --picture error.jpg"), ".png"),
        (
            compare("baked.glb --picture nowhere/error.png"),
            "no such folder",
        ),
        (
            compare("open.glb --picture error.png --size 8x8"),
            "without shadows",
        ),
    ] {
        let error = bench.fail(1, &line);
        assert!(error.contains(part), "relume {line}\n{error}");
    }
    bench.fail(2, &compare("baked.glb --size 8x8"));
}

#[test]
fn info_explains_an_asset_to_a_stranger() {
    let bench = Bench::new();
    bench.bake("baked.glb", "--order 3 --bounces 1");
    let (said, _) = bench.succeed("info baked.glb");
    for part in [
        "with 27 numbers at each vertex",
        "up to degree 2",
        "t₈",
        "colour bleeding",
    ] {
        assert!(said.replace("t_8", "t₈").contains(part), "{part}: {said}");
    }
    // What it tells to do works.
    let lines: Vec<&str> = said
        .lines()
        .filter_map(|l| l.trim().strip_prefix("relume "))
        .collect();
    assert_eq!(lines.len(), 3, "{said}");
    for line in lines {
        let (command, _) = line.split_once("  ").unwrap();
        bench.succeed(&command.replace("-o look.png", "-o look.png --size 8x4"));
    }
}

#[test]
fn completions_are_scripts_that_know_every_verb() {
    let bench = Bench::new();
    for (shell, mark) in [
        ("bash", "complete -F _relume"),
        ("zsh", "#compdef relume"),
        ("fish", "complete -c relume"),
        ("powershell", "Register-ArgumentCompleter"),
    ] {
        let (script, said) = bench.succeed(&format!("completions {shell}"));
        assert!(script.contains(mark) && said.is_empty(), "{shell}: {said}");
        for word in [
            "bake", "light", "shade", "render", "compare", "export", "info", "max-edge",
        ] {
            assert!(script.contains(word), "{word} is not in {shell}");
        }
    }
    bench.fail(2, "completions tcsh");
    // A script that its shell can read.
    if let Ok(bash) = Command::new("bash").arg("--version").output()
        && bash.status.success()
    {
        fs::write(
            bench.path("relume.bash"),
            bench.succeed("completions bash").0,
        )
        .unwrap();
        let script = bench.path("relume.bash");
        assert!(
            Command::new("bash")
                .arg("-n")
                .arg(script)
                .status()
                .unwrap()
                .success()
        );
    }
}
