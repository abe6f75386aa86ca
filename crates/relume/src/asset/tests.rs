//! Whole assets, written and read again.

use glam::Vec3;
use serde_json::{Value, json};

use super::samples;
use super::*;
use crate::scene::{Document, Mesh, World, gltf};
use document::document;

fn glb(asset: &Asset) -> Vec<u8> {
    to_glb(asset).unwrap()
}

fn parts(bytes: &[u8]) -> (Value, &[u8]) {
    let (json, bin) = container::split(bytes).unwrap();
    (serde_json::from_slice(json).unwrap(), bin)
}

/// A `.glb` of this JSON and binary chunk.
fn join(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut chunk = container::Bin::default();
    chunk.push(container::Part::Bytes(bin.into()));
    let json = serde_json::to_vec(json).unwrap();
    let container = container::Container::new(json, chunk).unwrap();
    let mut bytes = Vec::new();
    container.write(&mut bytes).unwrap();
    bytes
}

/// Fails unless two scenes look alike to everything that bakes or shades. Importing brings normals to length 1, which can move each
/// component by one unit in the last place.
fn assert_same_world(found: &Scene, expected: &Scene) {
    let [found, expected] = [found, expected].map(World::new);
    assert_eq!(found.positions, expected.positions);
    assert_eq!(found.uvs, expected.uvs);
    assert_eq!(found.colors, expected.colors);
    assert_eq!(found.alphas, expected.alphas);
    assert_eq!(found.triangles, expected.triangles);
    assert_eq!(found.instance_vertices, expected.instance_vertices);
    assert_eq!(found.from_input, expected.from_input);
    assert_eq!(found.vertex_albedos(), expected.vertex_albedos());
    for (a, b) in found.normals.iter().zip(&expected.normals) {
        assert!((*a - *b).abs().max_element() <= f32::EPSILON, "{a} for {b}");
    }
}

#[test]
fn a_scene_made_in_memory_comes_back_with_its_transfer() {
    let asset = samples::asset();
    let bytes = glb(&asset);
    let read = from_glb(&bytes).unwrap();
    assert_eq!(read.transfer, asset.transfer);
    assert_eq!(read.scene.source_hash, asset.scene.source_hash);
    assert_same_world(&read.scene, &asset.scene);
    let names = |scene: &Scene| {
        scene
            .meshes
            .iter()
            .map(|m| m.name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&read.scene), ["plate", "fern"]);
    let materials = |scene: &Scene| format!("{:?}", scene.materials);
    assert_eq!(materials(&read.scene), materials(&asset.scene));
    // Read, written, read: nothing moves, nothing grows.
    assert_eq!(glb(&read), bytes);
}

#[test]
fn every_kind_of_transfer_comes_back() {
    let scene = samples::scene();
    let vertices = scene.vertex_count();
    for (order, channels, back) in [
        (1, 1, None),
        (5, 1, Some(0)),
        (32, 3, None),
        (2, 3, Some(vertices - 1)),
    ] {
        let mut transfer = samples::transfer(vertices, order, channels, back);
        if order == 1 {
            transfer.kind = TransferKind::Unshadowed;
            transfer.valid.fill(true);
            transfer.seed = 7;
        }
        let scene = scene.clone();
        let asset = Asset { scene, transfer };
        assert_eq!(from_glb(&glb(&asset)).unwrap().transfer, asset.transfer);
    }
}

/// The document, imported, with transfer.
fn imported() -> Asset {
    let Document { json, bin } = document();
    let scene = gltf::from_glb(&join(&json, &bin)).unwrap();
    assert_eq!(scene.instances.len(), 4);
    let transfer = samples::transfer(scene.vertex_count(), 2, 3, Some(3));
    Asset { scene, transfer }
}

/// Fails unless everything in `old` stands in `new` at the same place, additions at the end of arrays and in `extensions` aside.
pub fn assert_contains(new: &Value, old: &Value, path: &str) {
    match (new, old) {
        (Value::Object(new), Value::Object(old)) => {
            for (key, value) in old {
                let path = format!("{path}/{key}");
                let found = new.get(key).unwrap_or_else(|| panic!("{path} is gone"));
                assert_contains(found, value, &path);
            }
            let added: Vec<_> = new.keys().filter(|key| !old.contains_key(*key)).collect();
            let allowed = ["extensions", "extensionsUsed", "RELUME_transfer"];
            assert!(
                added.iter().all(|key| allowed.contains(&key.as_str())),
                "{path}: {added:?}"
            );
        }
        (Value::Array(new), Value::Array(old)) => {
            let grows = ["/bufferViews", "/extensionsUsed"].contains(&path);
            assert!(
                new.len() == old.len() || grows && new.len() > old.len(),
                "{path}"
            );
            for (i, (new, old)) in new.iter().zip(old).enumerate() {
                assert_contains(new, old, &format!("{path}/{i}"));
            }
        }
        // The one number that must change.
        _ if path == "/buffers/0/byteLength" => {}
        _ => assert_eq!(new, old, "{path}"),
    }
}

#[test]
fn a_document_survives_entry_by_entry_and_byte_by_byte() {
    let asset = imported();
    let bytes = glb(&asset);
    let Document {
        json: old,
        bin: old_bin,
    } = document();
    let (new, bin) = parts(&bytes);
    assert!(bin.starts_with(&old_bin));
    assert_contains(&new, &old, "");
    let extension = &new["nodes"][2]["extensions"][header::NAME];
    assert_eq!(
        extension["primitives"][0],
        json!({}),
        "lines have no transfer"
    );
    assert_eq!(extension["primitives"][2]["count"], 4);
    assert!(
        new["nodes"][3].get("extensions").is_none(),
        "a camera has none"
    );
    let read = from_glb(&bytes).unwrap();
    assert_eq!(read.transfer, asset.transfer);
    assert_eq!(
        format!("{:?}", read.scene.meshes),
        format!("{:?}", asset.scene.meshes)
    );
    assert_eq!(glb(&read), bytes);
}

/// Every triangle gets a vertex at its middle, as a tessellator would append them; instances are unshared.
fn split(scene: &mut Scene, which: impl Fn(usize) -> bool) {
    let meshes: Vec<Mesh> = scene
        .instances
        .iter()
        .map(|i| scene.meshes[i.mesh].clone())
        .collect();
    scene.meshes = meshes;
    for (i, instance) in scene.instances.iter_mut().enumerate() {
        instance.mesh = i;
        let mesh = &mut scene.meshes[i];
        if !which(i) {
            continue;
        }
        for corners in std::mem::take(&mut mesh.groups[0].triangles) {
            let [a, b, c] = corners;
            let at = |of: &dyn Fn(usize) -> Vec3| {
                corners.iter().map(|&i| of(i as usize)).sum::<Vec3>() / 3.0
            };
            let (position, normal) = (
                at(&|i| mesh.positions[i]),
                at(&|i| mesh.normals[i]).normalize(),
            );
            let new = mesh.positions.len() as u32;
            if !mesh.uvs.is_empty() {
                mesh.uvs.push(at(&|i| mesh.uvs[i].extend(0.0)).truncate());
            }
            mesh.positions.push(position);
            mesh.normals.push(normal);
            mesh.groups[0]
                .triangles
                .extend([[a, b, new], [b, c, new], [c, a, new]]);
        }
    }
}

#[test]
fn split_triangles_get_a_mesh_of_their_own_and_the_old_one_stays() {
    let mut scene = imported().scene;
    // Node 2 comes first: both of its primitives; of node 0 the textured one only.
    split(&mut scene, |i| i != 3);
    let transfer = samples::transfer(scene.vertex_count(), 2, 3, None);
    let asset = Asset { scene, transfer };
    let bytes = glb(&asset);
    let (new, bin) = parts(&bytes);
    let Document {
        json: old,
        bin: old_bin,
    } = document();
    assert!(bin.starts_with(&old_bin));
    for key in [
        "accessors",
        "bufferViews",
        "meshes",
        "materials",
        "images",
        "textures",
        "cameras",
    ] {
        let old = old[key].as_array().unwrap();
        assert_eq!(&new[key].as_array().unwrap()[..old.len()], old, "{key}");
    }
    let meshes = [2, 0].map(|node: usize| new["nodes"][node]["mesh"].as_u64().unwrap() as usize);
    assert_eq!(meshes, [1, 2]);
    let primitives = &new["meshes"][2]["primitives"];
    assert_eq!(primitives[0], old["meshes"][0]["primitives"][0]);
    assert_eq!(primitives[2], old["meshes"][0]["primitives"][2]);
    assert_eq!(primitives[1]["extras"], "kept");
    // The copy of the material: what was looked up elsewhere is gone, what was looked up there reads set 0.
    let material = &new["materials"][1];
    assert_eq!(primitives[1]["material"], 1);
    assert_eq!(new["materials"].as_array().map(Vec::len), Some(2));
    assert_eq!(
        material["pbrMetallicRoughness"]["baseColorTexture"],
        json!({ "index": 0 })
    );
    assert!(material.get("emissiveTexture").is_none());
    let read = from_glb(&bytes).unwrap();
    assert_eq!(read.transfer, asset.transfer);
    assert_same_world(&read.scene, &asset.scene);
    assert_eq!(glb(&read), bytes);
}

#[test]
fn baking_a_baked_file_replaces_its_transfer() {
    let asset = imported();
    let bytes = glb(&asset);
    let scene = gltf::from_glb(&bytes).unwrap();
    assert_eq!(scene.vertex_count(), asset.transfer.vertex_count());
    let again = Asset {
        transfer: asset.transfer.clone(),
        scene: Scene {
            source_hash: asset.scene.source_hash,
            ..scene
        },
    };
    assert_eq!(glb(&again), bytes);
}

#[test]
fn an_albedo_for_everything_comes_back_though_the_document_has_another() {
    let mut asset = imported();
    crate::scene::override_albedo(&mut asset.scene, [0.5, 0.25, 0.1]).unwrap();
    let bytes = glb(&asset);
    assert_contains(&parts(&bytes).0, &document().json, "");
    let read = from_glb(&bytes).unwrap();
    assert_same_world(&read.scene, &asset.scene);
    assert_eq!(glb(&read), bytes);
}

#[test]
fn a_file_is_written_and_read_by_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    let asset = samples::asset();
    write(&asset, &path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), glb(&asset));
    assert_eq!(read(&path).unwrap().transfer, asset.transfer);
    assert!(same_file(&path, &folder.path().join(".").join("out.glb")));
    assert!(!same_file(&path, folder.path()));
    let error = read(&folder.path().join("none.glb"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("none.glb: "), "{error}");
    std::fs::write(&path, join(&document().json, &document().bin)).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(
        error.ends_with("out.glb: has no baked transfer; make one with `relume bake`"),
        "{error}"
    );
}

#[test]
fn a_description_counts_and_warns() {
    let asset = samples::asset();
    let found = describe(&asset);
    assert_eq!(found.vertices, 10 + 17 + 10);
    assert_eq!(found.input_vertices, 6 + 12 + 6);
    assert_eq!(found.bytes_per_vertex, 4 * 3 * 9);
    assert_eq!(found.invalid, 5);
    assert_eq!(found.triangles, 8 + 18 + 8);
    assert_eq!(
        found.back_vertices,
        asset.transfer.back.unwrap().vertices.len()
    );
    let text = found.to_string();
    assert!(
        text.contains("order 3 (9 coefficients), real-no-cs"),
        "{text}"
    );
    assert!(
        text.contains("ignores metalness: material \"brass\""),
        "{text}"
    );
}

mod beside;
mod damage;
mod docs;
mod document;
mod gather;
mod halves;
#[cfg(feature = "bake")]
mod measured;
#[cfg(feature = "import")]
mod real;
mod refused;
#[cfg(feature = "bake")]
mod tiles;
