//! Assets whose surfaces reflect as one that was measured.

use std::sync::atomic::AtomicBool;

use glam::DVec3;
use serde_json::{Value, json};

use super::super::write::write_within;
use super::{glb, join, parts};
use crate::asset::{Asset, from_glb, read};
use crate::bake::{BakeOptions, Monitor, bake};
use crate::basis::Order;
use crate::brdf::{Brdf, MERL_ENTRIES, Merl, Phong, Reflection, measured};
use crate::light::{IncidentLight, ShLight};
use crate::scene::{World, bundled, gltf, override_reflection};
use crate::shade::{Outgoing, TransferredRadiance};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// A ball over a floor, both of a Phong lobe as a goniometer sees it.
fn asset() -> Asset {
    let phong = Brdf::from(Phong {
        diffuse: DVec3::new(0.3, 0.2, 0.1),
        specular: DVec3::splat(0.4),
        exponent: 9.0,
    });
    covered(Reflection::Fixed(measured(&phong).into()))
}

/// A ball over a floor, both of a reflection.
pub fn covered(reflection: Reflection) -> Asset {
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, 6, 0.6);
    override_reflection(&mut scene, reflection);
    let options = BakeOptions {
        order: order(2),
        transfer_order: Some(order(3)),
        samples: 32,
        bounces: 1,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    let transfer = bake(&World::new(&scene), &options, &monitor)
        .unwrap()
        .transfer;
    Asset { scene, transfer }
}

/// Radiance of every vertex toward an eye, as the asset alone says it.
pub fn shaded(asset: &Asset) -> Vec<[f32; 3]> {
    let world = World::new(&asset.scene);
    let light = ShLight::new(
        order(2),
        vec![[1.0, 0.9, 0.8], [0.3; 3], [0.2; 3], [-0.1; 3]],
    );
    let light = IncidentLight::Distant(light);
    let transferred = TransferredRadiance::new(&asset.transfer, &light).unwrap();
    let outgoing = Outgoing::new(&world, transferred.order).unwrap();
    outgoing.radiance(&asset.transfer, &transferred, DVec3::new(0.5, 3.0, 2.0))
}

pub fn headers(document: &mut Value) -> impl Iterator<Item = &mut Value> {
    let nodes = document["nodes"].as_array_mut().unwrap();
    nodes
        .iter_mut()
        .map(|node| &mut node["extensions"]["RELUME_transfer"])
}

#[test]
fn a_measured_brdf_lies_in_the_asset_once_and_shades_as_it_did() {
    let asset = asset();
    let expected = shaded(&asset);
    assert!(
        expected
            .as_flattened()
            .iter()
            .any(|&radiance| radiance > 0.05)
    );
    let bytes = glb(&asset);
    let back = from_glb(&bytes).unwrap();
    assert_eq!(shaded(&back), expected);
    assert_eq!(glb(&back), bytes);
    let (mut document, _) = parts(&bytes);
    let length = 12 * MERL_ENTRIES;
    let views = document["bufferViews"].as_array().unwrap();
    let tables = views.iter().filter(|view| view["byteLength"] == length);
    assert_eq!(tables.count(), 1);
    let named: Vec<_> = headers(&mut document)
        .map(|header| header["brdf"].clone())
        .collect();
    assert_eq!(named.len(), 2);
    assert!(named[0]["table"].is_u64() && named[0] == named[1] && named[0]["model"] == "merl");
    // What is baked again has no table left over.
    let scene = gltf::from_glb(&bytes).unwrap();
    let reflection = |scene| format!("{:?}", World::new(scene).materials[0].reflection);
    assert!(!reflection(&scene).contains("Merl"));
    let again = Asset { scene, ..back };
    assert!(glb(&again).len() < length);

    // Past the limit of a .glb it goes to the other file with the rest.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    write_within(&asset, &path, 1000).unwrap();
    assert!(std::fs::metadata(&path).unwrap().len() < length as u64);
    assert_eq!(shaded(&read(&path).unwrap()), expected);
}

#[test]
fn tables_that_lie_are_refused_with_what_is_wrong() {
    let bytes = glb(&asset());
    let (document, bin) = parts(&bytes);
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut document = document.clone();
        headers(&mut document).for_each(change);
        from_glb(&join(&document, bin)).unwrap_err().to_string()
    };
    let table = |value: Value| refused(&move |header| header["brdf"]["table"] = value.clone());
    assert!(table(json!(1_000_000)).contains("not there"));
    assert!(table(json!(0)).contains("whose table has buffer view 0"));
    assert!(table(json!(-1)).contains("RELUME_transfer has"));
    assert!(table(Value::Null).contains("RELUME_transfer has"));
    let mut first = document.clone();
    let first = headers(&mut first).next().unwrap()["primitives"][0]["matrices"].clone();
    assert!(table(first).contains("bytes, not 1458000 times 12"));
    let model = |header: &mut Value| header["brdf"]["model"] = "merl2".into();
    assert!(refused(&model).contains("merl2"));

    let mut document = document.clone();
    let view = headers(&mut document).next().unwrap()["brdf"]["table"].clone();
    let view = &document["bufferViews"][view.as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap() as usize;
    for value in [f32::NAN, f32::INFINITY, -1e-3, 2e8] {
        let mut bin = bin.to_vec();
        bin[start + 4 * 4..][..4].copy_from_slice(&value.to_le_bytes());
        let said = from_glb(&join(&document, &bin)).unwrap_err().to_string();
        assert!(
            said.contains("entry 1 is") && said.contains("no reflectance"),
            "{said}"
        );
    }
    assert!(Merl::from_values(vec![[0.0; 3]; 7]).is_err());
}

#[test]
fn checkpoints_tell_tables_apart_that_are_sampled_alike() {
    let mut values = vec![[0.1; 3]; MERL_ENTRIES];
    let first = format!("{:?}", Merl::from_values(values.clone()).unwrap());
    assert_eq!(
        first,
        format!("{:?}", Merl::from_values(values.clone()).unwrap())
    );
    // Far from retroreflection, which is all that the sampling looks at.
    values[MERL_ENTRIES - 1][2] = 0.2;
    assert_ne!(first, format!("{:?}", Merl::from_values(values).unwrap()));
}
