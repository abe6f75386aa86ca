//! Real meshes, and everything the formats share.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::*;
use crate::test_data::shared_or_skip;

fn import(path: &Path) -> Scene {
    let scene = load(path, &ImportOptions::default()).unwrap();
    for mesh in &scene.meshes {
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        assert_eq!(mesh.input_vertices, mesh.positions.len());
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
    scene
}

fn write(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// Of each mesh: vertices (positions in the file for OBJ), seam vertices appended, triangles over all instances including those without an
/// area, and the latter, as the manifest of the data counts them.
const MESHES: [(&str, usize, usize, usize, usize); 19] = [
    ("armadillo_10k.ply", 10002, 0, 20000, 0),
    ("armadillo_14k.obj", 14587, 0, 29170, 0),
    ("armadillo_43k.obj", 43243, 0, 86482, 0),
    ("stanford_bunny_36k.ply", 35947, 0, 69451, 0),
    ("happy_buddha_50k.obj", 49950, 0, 100_000, 0),
    ("xyzrgb_dragon_10k.ply", 9994, 0, 19984, 0),
    ("max_planck_5k.obj", 5272, 0, 10540, 0),
    ("max_planck_face_open_32k.obj", 31894, 0, 63347, 0),
    ("igea_134k.ply", 134_345, 0, 268_686, 0),
    ("utah_teapot.obj", 3644, 0, 6320, 0),
    ("crytek_sponza_core.obj", 29653, 15516, 33662, 0),
    ("domed_building.glb", 43033, 0, 23388, 4168),
    ("cornell_box.obj", 84, 0, 38, 0),
    ("room_teapot_pillars.gltf", 2093, 0, 2180, 0),
    ("prt_wall_with_pillars.obj", 13063, 9909, 26078, 34),
    ("prt_head_big_ears.obj", 17282, 293, 34560, 0),
    ("avocado.glb", 406, 0, 682, 0),
    ("flight_helmet.glb", 55392, 0, 94722, 0),
    ("damaged_helmet.glb", 14556, 0, 15452, 0),
];

#[test]
fn real_meshes_have_the_counts_of_their_manifest() {
    let test = "real_meshes_have_the_counts_of_their_manifest";
    for (name, vertices, seams, triangles, degenerate) in MESHES {
        let Some(path) = shared_or_skip(test, &format!("meshes/{name}")) else {
            return;
        };
        let scene = import(&path);
        assert_eq!(scene.vertex_count(), vertices + seams, "{name}");
        assert_eq!(scene.triangle_count(), triangles - degenerate, "{name}");
        let said = scene.warnings.iter().any(|w| w.contains("without area"));
        assert_eq!(said, degenerate > 0, "{name}: {:?}", scene.warnings);
        if !name.ends_with(".obj") {
            let digest = Sha256::digest(std::fs::read(&path).unwrap());
            let hex: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(scene.source_hash, hex);
        }
    }
}

/// Positions of an OBJ file by a reader that knows nothing but `v x y z`.
fn obj_positions(path: &Path) -> Vec<[f32; 3]> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    lines
        .map(|line| {
            let mut numbers = line.split_whitespace().map(|n| n.parse().unwrap());
            std::array::from_fn(|_| numbers.next().unwrap())
        })
        .collect()
}

#[test]
fn positions_of_real_obj_files_keep_the_order_of_the_file() {
    let test = "positions_of_real_obj_files_keep_the_order_of_the_file";
    for (name, vertices, ..) in MESHES {
        let path = shared_or_skip(test, &format!("meshes/{name}"));
        let Some(path) = path else { return };
        if !name.ends_with(".obj") {
            continue;
        }
        let scene = import(&path);
        let positions = obj_positions(&path);
        assert_eq!(positions.len(), vertices);
        let mesh = &scene.meshes[0];
        assert!(
            positions
                .iter()
                .zip(&mesh.positions)
                .all(|(&a, &b)| glam::Vec3::from(a) == b)
        );
    }
}

#[test]
fn real_gltf_instances_materials_and_textures() {
    let test = "real_gltf_instances_materials_and_textures";
    let Some(path) = shared_or_skip(test, "meshes/domed_building.glb") else {
        return;
    };
    let dome = import(&path);
    let nodes: std::collections::BTreeSet<_> = dome.instances.iter().map(|i| i.node).collect();
    assert_eq!(nodes.len(), 70);
    let meshes = dome.document.as_ref().unwrap().json["meshes"]
        .as_array()
        .unwrap();
    assert_eq!(meshes.len(), 12);
    let primitives: usize = meshes
        .iter()
        .map(|m| m["primitives"].as_array().unwrap().len())
        .sum();
    assert_eq!(dome.meshes.len(), primitives);
    let (low, high) = World::new(&dome).bounds().unwrap();
    let corner = glam::Vec3::new(11.0, 9.28, 11.0);
    assert!((high - corner).length() < 1e-2, "{high}");
    assert!(
        (low - glam::Vec3::new(-11.0, -0.921, -11.0)).length() < 1e-2,
        "{low}"
    );

    let Some(path) = shared_or_skip(test, "meshes/flight_helmet.glb") else {
        return;
    };
    let helmet = import(&path);
    assert_eq!((helmet.meshes.len(), helmet.materials.len()), (6, 6));
    assert!(helmet.materials.iter().all(|m| m.has_normal_map));
    assert!(helmet.warnings.iter().any(|w| w.contains("BLEND")));
    let (low, high) = World::new(&helmet).bounds().unwrap();
    assert!(
        (low - glam::Vec3::new(-0.204, 0.0, -0.172)).length() < 1e-3,
        "{low}"
    );
    assert!(
        (high - glam::Vec3::new(0.163, 0.716, 0.2)).length() < 1e-3,
        "{high}"
    );
    if cfg!(feature = "images") {
        assert!(
            helmet
                .materials
                .iter()
                .all(|m| m.base_color_texture.is_some())
        );
        assert!(
            helmet
                .textures
                .iter()
                .all(|t| (t.width, t.height) == (512, 512))
        );
    }
}

#[test]
fn the_document_of_a_lone_glb_is_the_input_bit_for_bit() {
    let test = "the_document_of_a_lone_glb_is_the_input_bit_for_bit";
    let Some(path) = shared_or_skip(test, "meshes/flight_helmet.glb") else {
        return;
    };
    let helmet = import(&path);
    let bytes = std::fs::read(&path).unwrap();
    let json_length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let document = helmet.document.unwrap();
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + json_length]).unwrap();
    assert_eq!(document.json, json);
    assert_eq!(document.bin, bytes[28 + json_length..]);
    // From bytes alone it is the same scene.
    let again = gltf::from_glb(&bytes).unwrap();
    assert_eq!(again.source_hash, helmet.source_hash);
    assert_eq!(again.meshes[3].positions, helmet.meshes[3].positions);
}

#[test]
fn the_cornell_box_has_its_colours_and_flat_walls() {
    let test = "the_cornell_box_has_its_colours_and_flat_walls";
    let Some(path) = shared_or_skip(test, "meshes/cornell_box.obj") else {
        return;
    };
    let scene = import(&path);
    let colors: Vec<_> = scene
        .materials
        .iter()
        .map(|m| (m.name.as_str(), m.base_color))
        .collect();
    let expected = [
        ("white", [0.725, 0.71, 0.68, 1.0]),
        ("green", [0.14, 0.45, 0.091, 1.0]),
        ("red", [0.63, 0.065, 0.05, 1.0]),
        ("light", [0.0, 0.0, 0.0, 1.0]),
    ];
    assert_eq!(colors, expected);
    // The floor looks up at all four corners, although the walls start there.
    for normal in &scene.meshes[0].normals[..4] {
        assert!((*normal - glam::Vec3::Y).length() < 1e-6, "{normal}");
    }
    let options = ImportOptions {
        albedo: Some([0.1, 0.2, 0.3]),
        ..ImportOptions::default()
    };
    let gray = load(&path, &options).unwrap();
    assert!(
        gray.materials
            .iter()
            .all(|m| m.base_color == [0.1, 0.2, 0.3, 1.0])
    );
}

fn error(folder: &Path, name: &str, content: &[u8]) -> String {
    let path = write(folder, name, content);
    let message = load(&path, &ImportOptions::default())
        .unwrap_err()
        .to_string();
    assert!(!message.contains('\n'), "{message}");
    assert!(message.starts_with(path.to_str().unwrap()), "{message}");
    message
}

#[test]
fn content_that_is_not_what_the_name_says_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, content, expected) in [
        (
            "a.glb",
            &b"v 0 0 0\n"[..],
            "ends in .glb, but the content is text",
        ),
        (
            "a.gltf",
            b"glTF\x02\0\0\0",
            "ends in .gltf, but the content is binary glTF",
        ),
        (
            "a.obj",
            b"ply\nformat ascii 1.0\n",
            "ends in .obj, but the content is PLY",
        ),
        (
            "b.obj",
            b"v 0 0 0\n\0",
            "ends in .obj, but the content is binary data",
        ),
        ("a.ply", b"{}", "ends in .ply, but the content is JSON"),
        ("b.ply", b"", "ends in .ply, but the file is empty"),
        (
            "a.fbx",
            b"Kaydara",
            "the extension .fbx is not one of a scene",
        ),
        ("plain", b"", "the name has no extension"),
    ] {
        let message = error(folder, name, content);
        assert!(message.contains(expected), "{message}");
    }
    let missing = load(&folder.join("none.ply"), &ImportOptions::default()).unwrap_err();
    assert!(
        missing.to_string().contains("none.ply: cannot read it: "),
        "{missing}"
    );
    std::fs::create_dir(folder.join("folder.obj")).unwrap();
    let message = load(&folder.join("folder.obj"), &ImportOptions::default()).unwrap_err();
    assert!(
        message.to_string().contains("is not a regular file"),
        "{message}"
    );
}

#[test]
fn a_scene_without_triangles_has_nothing_to_bake() {
    let folder = tempfile::tempdir().unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
               property float z\nend_header\n0 0 0\n";
    for (name, content) in [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("b.obj", "# nothing\n"),
        ("a.ply", ply),
        ("a.gltf", r#"{"asset": {"version": "2.0"}}"#),
    ] {
        let message = error(folder.path(), name, content.as_bytes());
        assert!(
            message.contains("has no triangles, so there is nothing to bake"),
            "{message}"
        );
    }
}

#[test]
fn a_scene_in_memory_is_the_scene_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib sub/a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let mtl = "newmtl m\nKd 0.25 0.5 1\nmap_Kd gone.png\n";
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    std::fs::write(folder.path().join("sub/a.mtl"), mtl).unwrap();
    std::fs::write(folder.path().join("a.obj"), obj).unwrap();
    let options = ImportOptions::default();
    let disk = load(&folder.path().join("a.obj"), &options).unwrap();
    let mut files = std::collections::BTreeMap::new();
    let read = |files: &_| from_bytes(obj.as_bytes(), SceneFormat::Obj, files, &options).unwrap();
    assert_eq!(read(&files).materials[0].base_color[0], 0.5);
    files.insert("sub/a.mtl".to_owned(), mtl.into());
    let memory = read(&files);
    assert_eq!(memory.materials[0].base_color, [0.25, 0.5, 1.0, 1.0]);
    assert_eq!(memory.source_hash, disk.source_hash);
    assert_eq!(memory.warnings, disk.warnings);
    assert_eq!(memory.meshes[0].positions, disk.meshes[0].positions);
}
