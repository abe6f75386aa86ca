//! What is refused, each in one line that says where and what to do.

use super::*;

/// The message that an entry is refused with.
fn refused(entry: &Value) -> String {
    line(in_folder(Path::new(""), entry))
}

fn check(entry: &Value, needles: &[&str]) {
    let message = refused(entry);
    assert!(message.starts_with("emitters[0]"), "{message}");
    for needle in needles {
        assert!(message.contains(needle), "{message} lacks {needle}");
    }
}

#[test]
fn shapes_that_mean_nothing_are_refused() {
    let white = |key: &str, value: Value| json!({"name": "lamp", (key): value, "radiance": 1});
    for (key, value) in [
        ("quad", json!([1])),
        ("quad", json!([1, 0])),
        ("quad", json!([1, -2])),
        ("quad", json!(1)),
        ("quad", json!([1, "2"])),
        ("quad", json!([1, 2e9])),
        ("disc", json!(0)),
        ("disc", json!([1])),
        ("sphere", json!(-1)),
        ("sphere", json!(null)),
        ("box", json!([1, 2])),
        ("blocks", json!([1, 2])),
        ("blocks", json!({"columns": 1, "rows": 1})),
        ("blocks", json!({"columns": 0, "rows": 1, "size": [1, 1]})),
        ("blocks", json!({"columns": 1.5, "rows": 1, "size": [1, 1]})),
        ("blocks", json!({"columns": -1, "rows": 1, "size": [1, 1]})),
        (
            "blocks",
            json!({"columns": 1, "rows": 1, "size": [1, 1], "fill": 1.5}),
        ),
        (
            "blocks",
            json!({"columns": 1, "rows": 1, "size": [1, 1], "fill": 0}),
        ),
        (
            "blocks",
            json!({"columns": 1, "rows": 1, "size": [1, 1], "gap": 1}),
        ),
        ("mesh", json!(7)),
    ] {
        let shown = format!("\"{key}\" is {value}");
        // What is long is cut.
        let shown: String = shown.chars().take(30).collect();
        check(
            &white(key, value),
            &["emitters[0] (\"lamp\"): ", &shown, "must be"],
        );
    }
    check(&json!({"radiance": 1}), &["no shape", "quad, disc"]);
    check(
        &json!({"quad": [1, 1], "disc": 1, "radiance": 1}),
        &["\"quad\" and \"disc\"", "two emitters"],
    );
    let thin = refused(&json!({"name": "thread", "quad": [1, 1e-13], "radiance": 1}));
    assert!(
        thin.contains("\"thread\": none of its faces has an area"),
        "{thin}"
    );
}

#[test]
fn counts_are_not_believed() {
    let blocks = |columns: u64, rows: u64| {
        let blocks = json!({"columns": columns, "rows": rows, "size": [1, 1]});
        json!({"blocks": blocks, "radiance": 1})
    };
    check(
        &blocks(4_000_000_000, 1),
        &["16000000000 corners", "fewer blocks"],
    );
    check(&blocks(u64::MAX, u64::MAX), &["corners"]);
    check(&blocks(1, (1 << 20) + 1), &["4194308 corners"]);
    // All emitters share what there is: 2²² corners are a million blocks, and one more is too many.
    let both = json!({"emitters": [blocks(1024, 1024), {"disc": 1, "radiance": 1}]});
    let message = line(from_json(both.to_string().as_bytes(), Path::new("")));
    assert!(
        message.starts_with("emitters[1]: with its 48 corners"),
        "{message}"
    );
    let many = vec![json!({"sphere": 1, "radiance": 1}); 4097];
    let many = json!({"emitters": many}).to_string();
    let message = line(from_json(many.as_bytes(), Path::new("")));
    assert!(
        message.contains("4097 emitters are more than the 4096"),
        "{message}"
    );
}

#[test]
fn radiance_that_means_nothing_is_refused() {
    let lamp = |key: &str, value: Value| json!({"name": "lamp", "box": [1, 1, 1], (key): value});
    for value in [
        json!("red"),
        json!([1, 2]),
        json!([1, 2, 3, 4]),
        json!([]),
        json!({}),
        json!(true),
        json!([[1, 2, 3], 4]),
        json!([[1, 2]]),
    ] {
        check(
            &lamp("radiance", value),
            &["emitters[0] (\"lamp\"): \"radiance\" is", "[r, g, b]"],
        );
    }
    for value in [json!(-1), json!([0, 0, -1e-9]), json!(2e20), json!(1e300)] {
        check(
            &lamp("radiance", value),
            &["emitters[0]: emitter \"lamp\"", "not negative"],
        );
    }
    check(
        &lamp("vertexRadiance", json!(1)),
        &["\"vertexRadiance\" is 1", "each corner"],
    );
    check(
        &lamp("vertexRadiance", json!([1])),
        &["\"vertexRadiance\" is 1", "each corner"],
    );
    check(&lamp("vertexRadiance", json!([])), &["0 radiances", "8"]);
    check(
        &lamp("radiance", json!([[1, 1, 1]])),
        &["1 radiances for its faces", "6"],
    );
    check(&json!({"disc": 1}), &["no radiance", "\"radiance\": 0"]);
    for beside in ["radiance", "texture"] {
        let mut entry = lamp("vertexRadiance", json!([]));
        entry[beside] = json!("x.png");
        check(&entry, &["\"vertexRadiance\"", "leave one out"]);
    }
    check(
        &lamp("texture", json!("x.png")),
        &["no place on a box", "use a quad"],
    );
    let faces = json!({"quad": [1, 1], "texture": "x.png", "radiance": [[1, 1, 1]]});
    check(
        &faces,
        &["\"radiance\" is [[1,1,1]]", "a number or [r, g, b]"],
    );
    check(
        &json!({"sphere": 1, "radiance": [[1, 1, 1]]}),
        &["a sphere shines the same"],
    );
    check(
        &json!({"sphere": 1, "radiance": 1, "exponent": 1}),
        &["a sphere shines the same"],
    );
}

#[test]
fn the_other_keys_are_refused_by_name() {
    let lamp = |key: &str, value: Value| json!({"disc": 1, "radiance": 1, (key): value});
    check(
        &lamp("colour", json!(1)),
        &["\"colour\" is not a key", "twoSided"],
    );
    check(&lamp("a\nb", json!(1)), &["\"a\\nb\" is not a key"]);
    check(&lamp("name", json!(1)), &["\"name\" is 1"]);
    check(&lamp("name", json!("n".repeat(201))), &["201 bytes", "200"]);
    check(
        &lamp("twoSided", json!(1)),
        &["\"twoSided\" is 1", "true or false"],
    );
    for value in [json!(9), json!(-1), json!(1.5), json!("2")] {
        check(&lamp("exponent", value), &["\"exponent\" is", "0…8"]);
    }
    for key in ["position", "target"] {
        for value in [
            json!([1, 2]),
            json!([0, 0, 2e9]),
            json!("here"),
            json!([0, null, 0]),
        ] {
            check(&lamp(key, value), &[key, "[x, y, z] in metres"]);
        }
    }
    for value in [json!(0), json!(-1), json!(1e9), json!([1, 1, 1])] {
        check(&lamp("scale", value), &["\"scale\" is", "above 0"]);
    }
    for value in [
        json!([0, 1, 0, 90]),
        json!([[0, 0, 0, 90]]),
        json!([[0, 1, 90]]),
        json!(90),
    ] {
        check(
            &lamp("rotate", value),
            &["\"rotate\" is", "[x, y, z, degrees]"],
        );
    }
    check(
        &lamp("target", json!([0, 0, 0])),
        &["\"target\" is its \"position\""],
    );
    let mut both = lamp("target", json!([0, 1, 0]));
    both["rotate"] = json!([]);
    check(&both, &["\"rotate\" and \"target\"", "leave one out"]);
    for value in [json!(1), json!([]), json!("disc"), json!(null)] {
        check(&value, &["an emitter is an object"]);
    }
}

#[test]
fn names_in_messages_are_printable() {
    check(
        &json!({"name": "a\nb\u{202e}", "disc": 0, "radiance": 1}),
        &["emitters[0] (\"a\\nb\\u{202e}\")"],
    );
    check(
        &json!({"name": "a\nb", "disc": 1, "radiance": -1}),
        &["emitter \"a\\nb\""],
    );
}

#[test]
fn text_that_is_no_list_of_emitters_is_refused() {
    let message = |text: &str| line(from_json(text.as_bytes(), Path::new("")));
    for text in [
        "",
        "{",
        "{\"emitters\": [NaN]}",
        "\u{0}",
        "{\"emitters\": [{\"disc\": 1e999}]}",
    ] {
        assert!(
            message(text).contains("not valid JSON"),
            "{}",
            message(text)
        );
    }
    let deep = "[".repeat(1_000_000);
    assert!(
        message(&deep).contains("recursion limit"),
        "{}",
        message(&deep)
    );
    for (text, needle) in [
        ("[]", "no object"),
        ("{}", "no list"),
        ("{\"emitters\": {}}", "no list"),
        ("{\"emitters\": []}", "lists no emitters"),
        ("{\"emitters\": [], \"version\": 1}", "the key \"version\""),
        ("{\"asset\": {\"version\": \"2.0\"}}", "looks like glTF"),
    ] {
        let message = message(text);
        assert!(
            message.contains(needle) && message.contains("and nothing else"),
            "{message}"
        );
    }
    let long = vec![b' '; (1 << 26) + 1];
    assert!(line(from_json(&long, Path::new(""))).contains("67108865 bytes"));
}

#[test]
fn files_that_cannot_be_used_are_refused_with_their_path() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("folder.json")).unwrap();
    std::fs::write(at("broken.json"), b"{").unwrap();
    std::fs::File::create(at("long.json"))
        .unwrap()
        .set_len(1 << 40)
        .unwrap();
    for (name, needle) in [
        ("none.json", "may be read"),
        ("folder.json", "not a regular file"),
        ("broken.json", "not valid JSON"),
        ("long.json", "1099511627776 bytes"),
        ("lamp.obj", "knows no radiance"),
        ("lamp.PLY", "knows no radiance"),
        ("none.glb", "none.glb"),
    ] {
        let message = line(load(&at(name)));
        assert!(
            message.starts_with(&at(name).display().to_string()),
            "{message}"
        );
        assert!(message.contains(needle), "{message}");
    }
}

#[test]
fn what_an_entry_names_must_be_a_file_in_the_folder() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("scene");
    std::fs::create_dir_all(folder.join("images")).unwrap();
    std::fs::write(outer.path().join("secret.pfm"), pfm()).unwrap();
    std::fs::write(folder.join("text.pfm"), b"hello").unwrap();
    let absolute = outer.path().join("secret.pfm").display().to_string();
    let mut cases = vec![
        ("../secret.pfm", "leads out"),
        ("images/../../secret.pfm", "leads out"),
        (absolute.as_str(), "put it beside"),
        ("c:\\x.pfm", "backslash"),
        ("", "names no file"),
        ("images", "not a regular file"),
        ("none.pfm", "see whether it is there"),
        ("text.pfm", "not an image Relume reads"),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&absolute, folder.join("link.pfm")).unwrap();
        cases.push(("link.pfm", "leads out"));
    }
    for (name, needle) in cases {
        let entry = json!({"name": "lamp", "quad": [1, 1], "texture": name});
        let message = line(in_folder(&folder, &entry));
        assert!(
            message.starts_with("emitters[0] (\"lamp\"): \"texture\" names"),
            "{message}"
        );
        assert!(message.contains(needle), "{message}");
        let entry = json!({"mesh": name, "radiance": 1});
        assert!(line(in_folder(&folder, &entry)).contains("\"mesh\" names"));
    }
}

#[cfg(feature = "import")]
#[test]
fn meshes_that_cannot_be_used_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("bare.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("empty.obj"), "v 0 0 0\n").unwrap();
    std::fs::write(folder.path().join("two.pfm"), pfm()).unwrap();
    for (mesh, key, value, needle) in [
        (
            "bare.obj",
            "texture",
            json!("two.pfm"),
            "no texture coordinates",
        ),
        ("empty.obj", "radiance", json!(1), "no triangles"),
        (
            "two.pfm",
            "radiance",
            json!(1),
            ".pfm is not one of a scene",
        ),
        (
            "bare.obj",
            "vertexRadiance",
            json!([[1, 1, 1]]),
            "1 radiances for its positions",
        ),
    ] {
        let message = line(in_folder(
            folder.path(),
            &json!({"mesh": mesh, (key): value}),
        ));
        assert!(message.contains(needle), "{message}");
    }
}

#[cfg(not(feature = "import"))]
#[test]
fn without_import_meshes_say_what_they_need() {
    check(
        &json!({"mesh": "x.obj", "radiance": 1}),
        &["the feature `import`"],
    );
}
