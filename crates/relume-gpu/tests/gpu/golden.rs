//! Pictures as they looked when somebody last looked at them: what no number says.
//!
//! `RELUME_GOLDEN=write cargo test -p relume-gpu golden` writes them anew. A test that fails leaves its picture and the difference in
//! `target/golden`.

use std::path::{Path, PathBuf};

use image::RgbImage;
use relume::bake::{BakeOptions, Monitor, bake};
use relume::basis::Order;
use relume::display::Camera;
use relume::light::{IncidentLight, load};
use relume::scene::{World, bundled};
use relume_gpu::{Look, Renderer, Surface, Target};

use crate::device::{Gpu, on_each_back_end};

on_each_back_end! {
    surfaces_look_as_they_did
    edges_look_as_they_did
}

/// Pixels of the pictures.
const SIZE: (u32, u32) = (320, 180);

/// Codes that rounding may change: the transfer, the tone map and the samples of a pixel are rounded once each.
const ROUNDED: u8 = 3;

/// One pixel in so many may differ by more: drivers put edges to 1/256 of a pixel, and some pixels have an edge through a sample. Lines are
/// nothing but edges.
const EDGES: usize = 50;

fn surfaces_look_as_they_did(gpu: &Gpu) {
    let world = World::new(&bundled::courtyard());
    let look = Look {
        exposure: -1.5,
        ..Look::default()
    };
    draw(
        gpu,
        "courtyard",
        &world,
        &bundled::courtyard_camera(),
        &look,
    );
}

fn edges_look_as_they_did(gpu: &Gpu) {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.7, 2.0, 10, 0.5));
    let look = Look {
        exposure: -1.5,
        wireframe: true,
        background: false,
        surface: Surface::White,
        ..Look::default()
    };
    let camera = Camera::framing(&world, SIZE.0 as f32 / SIZE.1 as f32);
    draw(gpu, "edges", &world, &camera, &look);
}

/// Draws a world without shadows under a sky, and compares.
fn draw(gpu: &Gpu, name: &str, world: &World, camera: &Camera, look: &Look) {
    let options = BakeOptions {
        order: Order::new(6).unwrap(),
        shadows: false,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &false.into(),
    };
    let transfer = bake(world, &options, &monitor).unwrap().transfer;
    let sky = "sky:38,2.5".parse().unwrap();
    let sky = load(&sky, &Default::default()).unwrap().0;
    let target = Target {
        format: wgpu::TextureFormat::Rgba8Unorm,
        samples: 4,
    };
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, target);
    renderer.upload(world, &transfer).unwrap();
    renderer.set_background(&sky);
    let light = IncidentLight::Distant(sky.project(transfer.order));
    renderer.set_light(&light).unwrap();
    let bytes = gpu.bytes(&mut renderer, target, camera, look, SIZE);
    let texels = bytes.chunks_exact(4);
    let rgb = texels.flat_map(|p| [p[0], p[1], p[2]]).collect();
    check(name, &RgbImage::from_raw(SIZE.0, SIZE.1, rgb).unwrap());
}

fn check(name: &str, drawn: &RgbImage) {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var_os("RELUME_GOLDEN").is_some_and(|value| value == "write") {
        drawn.save(&golden).unwrap();
        return;
    }
    let golden = image::open(golden).unwrap().to_rgb8();
    assert_eq!(drawn.dimensions(), golden.dimensions());
    let off = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| [0, 1, 2].map(|c| a[c].abs_diff(b[c]));
    let off: Vec<[u8; 3]> = drawn.pixels().zip(golden.pixels()).map(off).collect();
    let more = off
        .iter()
        .filter(|off| off.iter().any(|&c| c > ROUNDED))
        .count();
    println!(
        "{name}: {more} of {} pixels differ by more than {ROUNDED} codes",
        off.len()
    );
    if more * EDGES > off.len() {
        let folder = leave(name, drawn, off.into_flattened());
        panic!("{name}: {more} pixels differ; look at {}", folder.display());
    }
}

/// Leaves the picture and, brightened, the difference.
fn leave(name: &str, drawn: &RgbImage, off: Vec<u8>) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../golden");
    std::fs::create_dir_all(&folder).unwrap();
    drawn.save(folder.join(format!("{name}.png"))).unwrap();
    let bright = off.into_iter().map(|c| c.saturating_mul(8)).collect();
    let difference = RgbImage::from_raw(SIZE.0, SIZE.1, bright).unwrap();
    difference
        .save(folder.join(format!("{name}_difference.png")))
        .unwrap();
    folder
}
