//! What every input must hold: an error, or something whole.

mod checkpoint;
mod emitters;

use std::collections::BTreeMap;

use glam::DVec3;
use relume::asset;
use relume::basis::Order;
use relume::brdf::{Brdf, HemisphereRule, Merl};
use relume::light::{EnvMap, Environment, HdrImage, LayoutChoice, LightFile, MAX_RADIANCE};
use relume::scene::{ImportOptions, Scene, SceneError, SceneFormat, World, from_bytes};

pub use checkpoint::checkpoint;
pub use emitters::emitters_json;

/// Scenes and images larger than this are only read: what comes after takes its time.
const SMALL: usize = 1 << 12;

/// A message is one line, fit to print.
fn check_message(error: &impl std::error::Error) {
    let text = error.to_string();
    assert!(
        !text.is_empty() && !text.contains(char::is_control),
        "{text:?}"
    );
}

fn check_scene(scene: Result<Scene, SceneError>) {
    let scene = match scene {
        Ok(scene) => scene,
        Err(error) => return check_message(&error),
    };
    for warning in &scene.warnings {
        assert!(!warning.contains(char::is_control), "{warning:?}");
    }
    assert!(scene.triangle_count() > 0);
    if scene.vertex_count() > SMALL || scene.triangle_count() > SMALL {
        return;
    }
    let world = World::new(&scene);
    let count = world.positions.len() as u32;
    assert!(
        world
            .triangles
            .iter()
            .flatten()
            .all(|&corner| corner < count)
    );
    assert!(world.positions.iter().all(|p| p.is_finite()));
    assert!(
        world
            .normals
            .iter()
            .all(|n| (n.length() - 1.0).abs() < 1e-4)
    );
    assert!(world.uvs.iter().all(|uv| uv.is_finite()));
    let albedos = world.vertex_albedos();
    assert!(
        albedos
            .iter()
            .all(|a| a.min_element() >= 0.0 && a.max_element() <= 1.0001)
    );
}

fn read(bytes: &[u8], format: SceneFormat, files: &BTreeMap<String, Vec<u8>>) {
    check_scene(from_bytes(bytes, format, files, &ImportOptions::default()));
}

/// A binary glTF file.
pub fn glb(bytes: &[u8]) {
    check_scene(relume::scene::gltf::from_glb(bytes));
}

/// A glTF document, with a buffer beside it.
pub fn gltf(bytes: &[u8]) {
    let buffer: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    read(
        bytes,
        SceneFormat::Gltf,
        &BTreeMap::from([("a.bin".to_owned(), buffer)]),
    );
}

/// An OBJ file that stands alone.
pub fn obj(bytes: &[u8]) {
    read(bytes, SceneFormat::Obj, &BTreeMap::new());
}

/// An MTL file beside an OBJ file.
pub fn mtl(bytes: &[u8]) {
    const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    read(
        OBJ,
        SceneFormat::Obj,
        &BTreeMap::from([("a.mtl".to_owned(), bytes.to_vec())]),
    );
}

/// A PLY file.
pub fn ply(bytes: &[u8]) {
    read(bytes, SceneFormat::Ply, &BTreeMap::new());
}

/// An image, as light and as the texture of an OBJ file.
pub fn image(bytes: &[u8]) {
    const OBJ: &[u8] =
        b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.3 0.7\nusemtl m\nf 1/1 2/1 3/1\n";
    const MTL: &[u8] = b"newmtl m\nmap_Kd t.png\n";
    dds(bytes);
    let files = [("a.mtl", MTL), ("t.png", bytes)];
    let files = files.map(|(name, bytes)| (name.to_owned(), bytes.to_vec()));
    read(OBJ, SceneFormat::Obj, &files.into());
}

/// An image as light.
pub fn dds(bytes: &[u8]) {
    let (image, warnings) = match HdrImage::decode(bytes) {
        Ok(decoded) => decoded,
        Err(error) => return check_message(&error),
    };
    assert!(
        warnings
            .iter()
            .all(|warning| !warning.contains(char::is_control))
    );
    let mut values = image.pixels().iter().flatten();
    assert!(values.all(|value| (0.0..=MAX_RADIANCE).contains(value)));
    if image.pixels().len() > SMALL {
        return;
    }
    match EnvMap::new(image, LayoutChoice::Auto) {
        Ok(map) => {
            let light = Environment::Map(map).project(Order::new(3).expect("an order"));
            assert!(light.coefficients().iter().flatten().all(|c| c.is_finite()));
        }
        Err(error) => check_message(&error),
    }
}

/// A light.json.
pub fn light_json(bytes: &[u8]) {
    match LightFile::from_json(bytes) {
        Ok(file) => assert_eq!(LightFile::from_json(file.to_json().as_bytes()), Ok(file)),
        Err(error) => check_message(&error),
    }
}

/// A baked asset.
pub fn asset(bytes: &[u8]) {
    let read = match asset::from_glb(bytes) {
        Ok(read) => read,
        Err(error) => return check_message(&error),
    };
    assert_eq!(read.scene.vertex_count(), read.transfer.vertex_count());
    let written = match asset::to_glb(&read) {
        Ok(written) => written,
        Err(error) => return check_message(&error),
    };
    let again = asset::from_glb(&written).expect("what was written is read");
    let twice = asset::to_glb(&again).expect("and written again");
    assert!(written == twice, "the same asset gives other bytes");
}

/// Bytes of a measured BRDF.
const MERL: usize = 12 + 3 * 8 * 90 * 90 * 180;

/// A measured BRDF: as it is, and where its header is right also with its numbers over and over until it is as long as a file must be.
pub fn merl(bytes: &[u8]) {
    check_merl(bytes);
    let whole = [90_i32, 90, 180].map(i32::to_le_bytes).concat();
    if bytes.len() >= 20 && bytes.starts_with(&whole) {
        let numbers = bytes[12..].iter().copied().cycle().take(MERL - 12);
        check_merl(
            &bytes[..12]
                .iter()
                .copied()
                .chain(numbers)
                .collect::<Vec<u8>>(),
        );
    }
}

fn check_merl(bytes: &[u8]) {
    let brdf = match Merl::from_bytes(bytes, "a\nname.binary") {
        Ok(merl) => Brdf::from(merl),
        Err(error) => return check_message(&error),
    };
    let above = HemisphereRule::about_mirror(DVec3::Z);
    for (direction, _) in above.nodes().step_by(1009) {
        let value = brdf.eval(direction, DVec3::Z);
        assert!(value.is_finite() && value.min_element() >= 0.0, "{value}");
        let density = brdf.pdf(direction, DVec3::Z);
        assert!(density.is_finite() && density >= 0.0, "{density}");
        let drawn = brdf.sample(direction, [0.3, 0.6, 0.9]);
        assert!(drawn.is_none_or(|drawn| drawn.is_finite()), "{drawn:?}");
    }
}
