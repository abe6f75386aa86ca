//! Real files, where they are at hand.

use super::*;
use crate::scene::{ImportOptions, load, tessellate};
use crate::test_data::shared_or_skip;

/// The asset of a real file with made-up transfer.
fn asset(test: &str, path: &str) -> Option<(Asset, Vec<u8>)> {
    let path = shared_or_skip(test, path)?;
    let bytes = std::fs::read(&path).unwrap();
    let scene = load(&path, &ImportOptions::default()).unwrap();
    let transfer = samples::transfer(scene.vertex_count(), 3, 1, None);
    Some((Asset { scene, transfer }, bytes))
}

/// The acceptance test of the container: what an artist made comes back, every accessor, image, node and extension.
#[test]
fn the_flight_helmet_comes_back_byte_for_byte() {
    let test = "the_flight_helmet_comes_back_byte_for_byte";
    let Some((asset, input)) = asset(test, "meshes/flight_helmet.glb") else {
        return;
    };
    let output = glb(&asset);
    let ((old, old_bin), (new, new_bin)) = (parts(&input), parts(&output));
    assert!(new_bin.starts_with(old_bin));
    assert_contains(&new, &old, "");
    for key in [
        "accessors",
        "images",
        "textures",
        "samplers",
        "materials",
        "meshes",
        "scenes",
        "asset",
    ] {
        assert_eq!(new[key].to_string(), old[key].to_string(), "{key}");
    }
    let nodes = new["nodes"].as_array().unwrap();
    assert_eq!(
        nodes
            .iter()
            .filter(|n| !n["extensions"][header::NAME].is_null())
            .count(),
        6
    );
    let read = from_glb(&output).unwrap();
    assert_eq!(read.transfer, asset.transfer);
    assert_eq!(read.transfer.vertex_count(), 55_392);
    let document = read.scene.document.as_ref().unwrap();
    assert_eq!(document.bin, old_bin);
    assert_eq!(glb(&read), output);
}

#[test]
fn instances_of_one_mesh_keep_their_own_transfer() {
    let test = "instances_of_one_mesh_keep_their_own_transfer";
    let Some((asset, input)) = asset(test, "meshes/domed_building.glb") else {
        return;
    };
    let output = glb(&asset);
    assert_contains(&parts(&output).0, &parts(&input).0, "");
    let read = from_glb(&output).unwrap();
    assert_eq!(read.scene.meshes.len(), asset.scene.meshes.len());
    assert!(read.scene.instances.len() > 4 * read.scene.meshes.len());
    assert_eq!(read.transfer, asset.transfer);
    assert_eq!(glb(&read), output);
}

#[test]
fn files_without_a_document_come_back_in_their_own_order() {
    let test = "files_without_a_document_come_back_in_their_own_order";
    for (path, vertices) in [
        ("meshes/stanford_bunny_36k.ply", 35_947),
        ("meshes/armadillo_14k.obj", 14_587),
        ("meshes/room_teapot_pillars.gltf", 0),
    ] {
        let Some((asset, _)) = asset(test, path) else {
            return;
        };
        let output = glb(&asset);
        let read = from_glb(&output).unwrap();
        assert_eq!(read.transfer, asset.transfer);
        assert!(read.transfer.vertex_count() >= vertices);
        assert_same_world(&read.scene, &asset.scene);
        assert_eq!(glb(&read), output);
    }
}

#[test]
fn real_files_come_back_with_split_triangles() {
    let test = "real_files_come_back_with_split_triangles";
    for (path, max_edge) in [
        ("meshes/cornell_box.obj", 100.0),
        ("meshes/avocado.glb", 0.003),
        ("meshes/domed_building.glb", 3.0),
    ] {
        let Some((Asset { scene, .. }, _)) = asset(test, path) else {
            return;
        };
        let scene = tessellate(&scene, max_edge).unwrap();
        let transfer = samples::transfer(scene.vertex_count(), 2, 1, None);
        let asset = Asset { scene, transfer };
        let output = glb(&asset);
        let read = from_glb(&output).unwrap();
        assert_eq!(read.transfer, asset.transfer);
        let added = describe(&read).vertices - describe(&read).input_vertices;
        assert!(added > 100, "{path}: {added}");
        assert_same_world(&read.scene, &asset.scene);
        assert_eq!(glb(&read), output);
    }
}
