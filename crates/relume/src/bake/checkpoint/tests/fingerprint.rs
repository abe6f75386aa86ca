//! Another bake's checkpoint is refused, and the message says why.

use super::*;
use crate::scene::{AlphaMode, Wrap};

fn options(pairs: &[(&str, &str)]) -> Fingerprint {
    let owned: Vec<(&str, String)> = pairs.iter().map(|&(n, v)| (n, v.to_owned())).collect();
    Fingerprint::new(&world(), &owned)
}

#[test]
fn the_option_that_changed_is_named() {
    let (_parent, folder) = place();
    let before = options(&[("--samples", "1024"), ("--seed", "0")]);
    drop(Checkpoint::open(&folder, &before, false).unwrap());
    for (now, expected) in [
        (
            options(&[("--samples", "4096"), ("--seed", "0")]),
            "--samples was 1024, is 4096",
        ),
        (
            options(&[("--samples", "1024"), ("--seed", "7")]),
            "--seed was 0, is 7",
        ),
        (
            options(&[("--samples", "1024")]),
            "--seed was 0, is not given",
        ),
        (
            options(&[("--samples", "1024"), ("--seed", "0"), ("--gather", "yes")]),
            "--gather was not given, is yes",
        ),
    ] {
        let error = error_of(Checkpoint::open(&folder, &now, true));
        let expected = format!(
            "out.glb.partial: the checkpoint is of another bake: {expected}; bake as before, or without --resume to start afresh"
        );
        assert!(error.ends_with(&expected), "{error}");
    }
    // Nothing of it was touched, and who does not ask for it starts afresh.
    assert!(Checkpoint::open(&folder, &before, true).unwrap().resumed());
    let afresh = options(&[("--samples", "4096"), ("--seed", "0")]);
    assert!(!Checkpoint::open(&folder, &afresh, false).unwrap().resumed());
    assert!(Checkpoint::open(&folder, &before, true).is_err());
}

#[test]
fn another_scene_or_version_is_named() {
    let (_parent, folder) = place();
    drop(open(&folder, false));
    let mut other = world();
    other.positions[1].z = -0.0;
    let other = Fingerprint::new(&other, &[("--samples", "1024".to_owned())]);
    let error = error_of(Checkpoint::open(&folder, &other, true));
    assert!(
        error.contains("another bake: the scene has changed; "),
        "{error}"
    );

    let path = folder.join("relume-checkpoint.json");
    let header = fs::read_to_string(&path).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    for (from, to, expected) in [
        (
            format!("\"relume\": \"{version}\""),
            "\"relume\": \"0.0.9\\u001b\"".to_owned(),
            format!("version 0.0.9\\u{{1b}} of relume wrote it, and this is {version}; "),
        ),
        (
            "\"format\": 1".to_owned(),
            "\"format\": 2".to_owned(),
            "format 2 of relume wrote it, and this is 1; ".to_owned(),
        ),
    ] {
        fs::write(&path, header.replace(&from, &to)).unwrap();
        let error = error_of(Checkpoint::open(&folder, &print(), true));
        assert!(error.contains(&expected), "{error}");
    }
}

#[test]
fn a_damaged_header_is_refused_or_replaced() {
    let (_parent, folder) = place();
    drop(open(&folder, false));
    let path = folder.join("relume-checkpoint.json");
    let whole = fs::read(&path).unwrap();
    let cuts = [0, 1, 20, whole.len() - 3].map(|end| whole[..end].to_vec());
    let others = [&b"null"[..], b"{}", b"{\"what\": \"relume checkpoint\"}"].map(<[u8]>::to_vec);
    let long = vec![b' '; 3 << 20];
    for header in cuts.into_iter().chain(others).chain([long]) {
        fs::write(&path, header).unwrap();
        let error = Checkpoint::open(&folder, &print(), true)
            .unwrap_err()
            .to_string();
        assert!(!error.contains('\n'), "{error}");
        assert!(
            error.contains("without --resume to start afresh"),
            "{error}"
        );
    }
    assert!(!open(&folder, false).resumed());
    assert!(open(&folder, true).resumed());
}

#[test]
fn everything_a_bake_reads_is_in_the_fingerprint() {
    let changes: [fn(&mut World); 19] = [
        |w| w.positions[2].x += 1e-7,
        |w| w.normals[0] = glam::Vec3::X,
        |w| w.uvs[1].y = 0.5,
        |w| w.colors[0].z = 0.25,
        |w| w.alphas[2] = 0.5,
        |w| w.triangles[0] = [1, 2, 0],
        |w| w.triangles.push([0, 1, 2]),
        |w| w.triangle_materials[0] = 1,
        |w| w.instance_vertices[0].end = 3,
        |w| w.from_input[2] = false,
        |w| w.materials[0].base_color[1] = 0.25,
        |w| w.materials[0].base_color_texture = Some(0),
        |w| w.materials[0].alpha = AlphaMode::Mask(0.5),
        |w| w.materials[0].double_sided = true,
        |w| w.materials.push(Material::diffuse("", [0.1; 3])),
        |w| w.textures[0].texels[1][3] = 9,
        |w| (w.textures[0].width, w.textures[0].height) = (1, 2),
        |w| w.textures[0].sampler.wrap_v = Wrap::Mirror,
        |w| w.textures[0].sampler.nearest = true,
    ];
    let of = |world: &World| Fingerprint::new(world, &[]);
    let mut seen = vec![of(&world())];
    for (i, change) in changes.into_iter().enumerate() {
        let mut changed = world();
        change(&mut changed);
        let print = of(&changed);
        assert!(!seen.contains(&print), "change {i}");
        seen.push(print);
    }
    let mut renamed = world();
    renamed.materials[0].name = "gray".to_owned();
    assert_eq!(of(&renamed), seen[0], "a name changes nothing");
}
