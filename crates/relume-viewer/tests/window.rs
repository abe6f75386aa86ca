//! A real window on a virtual display: starts, shows what it was given, takes its picture.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use relume::asset::{self, Asset, TransferKind};
use relume::bake::trace::Tracer;
use relume::bake::{BakeOptions, Monitor, bake};
use relume::basis::Order;
use relume::brdf::Reflection;
use relume::display::{
    self, Camera, GlossyRadiance, Radiance, RaycastOptions, ToneMap, VertexRadiance,
};
use relume::light::emitter::{self, Placed};
use relume::light::{self, IncidentLight};
use relume::scene::{World, bundled};
use relume::shade::{GlossyBounces, TransferredRadiance, bounced};

/// Pixels of the window.
const SIZE: (u32, u32) = (480, 270);

/// A virtual display, as long as it lives.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts one with a number of its own choice; `None` after the line that counts the test as skipped.
    fn open(test: &str) -> Option<Self> {
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "800x600x24",
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = server else {
            println!("skipped: {test}: needs Xvfb (Debian: xvfb)");
            return None;
        };
        let mut number = String::new();
        let out = server.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut number).unwrap();
        Some(Self {
            server,
            name: format!(":{}", number.trim()),
        })
    }

    /// Runs the viewer on it until it ends. Wayland's library, which Mesa asks as well, minds in a line of its own
    /// when there is no folder for what runs.
    fn view(&self, folder: &Path, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_relume-viewer"))
            .args(line.split_whitespace())
            .current_dir(folder)
            .env("DISPLAY", &self.name)
            .env("XDG_RUNTIME_DIR", folder)
            .env_remove("WAYLAND_DISPLAY")
            .output()
            .unwrap()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A ball over a floor, baked; with a transfer order of metal.
fn baked(transfer_order: Option<usize>) -> Asset {
    baked_with(transfer_order, 1)
}

fn baked_with(transfer_order: Option<usize>, bounces: u32) -> Asset {
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, 48, 0.6);
    if transfer_order.is_some() {
        for material in &mut scene.materials {
            material.metallic = 1.0;
            material.reflection = Reflection::MetallicRoughness {
                metallic: 1.0,
                roughness: 0.4,
            };
        }
    }
    let options = BakeOptions {
        samples: 64,
        bounces,
        gather: bounces == 0 && transfer_order.is_none(),
        transfer_order: transfer_order.map(|n| Order::new(n).unwrap()),
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &false.into(),
    };
    let transfer = bake(&World::new(&scene), &options, &monitor)
        .unwrap()
        .transfer;
    Asset { scene, transfer }
}

/// What the CPU sees of it, in codes.
fn expected(asset: &Asset, exposure: f32) -> Vec<[u8; 3]> {
    let world = World::new(&asset.scene);
    let sky = light::load(&"sky:30,3".parse().unwrap(), &Default::default())
        .unwrap()
        .0;
    let incident = IncidentLight::Distant(sky.project(asset.transfer.order));
    let diffuse = VertexRadiance::new(&asset.transfer, &incident);
    let outgoing = display::outgoing(&world, &asset.transfer).unwrap();
    let glossy = outgoing
        .as_ref()
        .and_then(|outgoing| GlossyRadiance::new(outgoing, &asset.transfer, &incident));
    let radiance: &dyn Radiance = glossy.as_ref().map_or(&diffuse, |glossy| glossy);
    let options = RaycastOptions {
        width: SIZE.0,
        height: SIZE.1,
        ..RaycastOptions::default()
    };
    let camera = Camera::framing(&world, SIZE.0 as f32 / SIZE.1 as f32);
    let behind = |direction| sky.radiance(direction);
    let tracer = Tracer::new(&world);
    let picture =
        display::render(&world, &tracer, radiance, &behind, None, &camera, &options).unwrap();
    let tone = ToneMap { exposure };
    picture.pixels.iter().map(|&p| tone.encode(p)).collect()
}

#[test]
fn a_window_shows_the_asset_as_the_cpu_sees_it() {
    let test = "a_window_shows_the_asset_as_the_cpu_sees_it";
    let Some(display) = Display::open(test) else {
        return;
    };
    for transfer_order in [None, Some(5)] {
        shows(&display, test, &baked(transfer_order));
    }
}

fn shows(display: &Display, test: &str, asset: &Asset) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ball.glb");
    asset::write(asset, &file).unwrap();
    let asset = &asset::read(&file).unwrap();
    let line =
        "ball.glb --light sky:30,3 --exposure -1 --no-panels --size 480x270 --screenshot look.png";
    let output = display.view(folder.path(), line);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if said.contains("no window could be opened") {
        println!("skipped: {test}: needs a graphics adapter (Debian: mesa-vulkan-drivers): {said}");
        return;
    }
    assert!(output.status.success(), "{said}");
    let picture = image::open(folder.path().join("look.png"))
        .unwrap()
        .to_rgb8();
    assert_eq!(picture.dimensions(), SIZE);
    let expected = expected(asset, -1.0);
    let off: Vec<u8> = picture
        .pixels()
        .zip(&expected)
        .map(|(ours, theirs)| {
            (0..3)
                .map(|c| ours[c].abs_diff(theirs[c]))
                .max()
                .unwrap_or(0)
        })
        .collect();
    // Within surfaces both sides round once; on edges four samples stand against sixteen.
    let more = off.iter().filter(|&&off| off > 2).count();
    let mean = off.iter().map(|&off| f64::from(off)).sum::<f64>() / off.len() as f64;
    println!(
        "{more} of {} pixels more than 2 codes off, mean {mean:.3}",
        off.len()
    );
    assert!(
        more * 50 < off.len() && mean < 0.5,
        "{more} of {}, mean {mean}",
        off.len()
    );
}

/// Lamps in an emitters.json: what they light, and themselves.
#[test]
fn a_window_shows_near_lights_as_the_cpu_sees_them() {
    let test = "a_window_shows_near_lights_as_the_cpu_sees_them";
    let Some(display) = Display::open(test) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let lamps = r#"{ "emitters": [
      { "quad": [0.5, 0.4], "radiance": [9, 6, 3], "position": [-0.2, 0.9, 0.9], "target": [0, 0.4, 0], "twoSided": true },
      { "sphere": 0.1, "radiance": [1, 3, 9], "position": [0.8, 0.7, 0.3] } ] }"#;
    std::fs::write(folder.path().join("lamps.json"), lamps).unwrap();
    let placed = emitter::from_json(lamps.as_bytes(), folder.path())
        .unwrap()
        .0
        .placed();
    // Bounces that were folded in hold for distant light, so near light waits for a bake of direct transfer, and on glossy surfaces for its bounces.
    for (transfer_order, bounces) in [(None, 0), (None, 1), (Some(5), 1)] {
        let baked = baked_with(transfer_order, bounces);
        asset::write(&baked, &folder.path().join("ball.glb")).unwrap();
        let line = "ball.glb --emitters lamps.json --light constant:0.2,0.2,0.3 --exposure -1 --no-panels --size 480x270 --screenshot look.png";
        let output = display.view(folder.path(), line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        if said.contains("no window could be opened") {
            println!(
                "skipped: {test}: needs a graphics adapter (Debian: mesa-vulkan-drivers): {said}"
            );
            return;
        }
        assert!(output.status.success(), "{said}");
        let picture = image::open(folder.path().join("look.png"))
            .unwrap()
            .to_rgb8();
        let expected = with_lamps(&baked, &placed);
        let pairs = picture.pixels().zip(&expected);
        let off = pairs.map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap());
        let off: Vec<u8> = off.collect();
        let more = off.iter().filter(|&&off| off > 3).count();
        println!(
            "{bounces} bounces: {more} of {} pixels more than 3 codes off",
            off.len()
        );
        assert!(more * 40 < off.len(), "{more} of {}", off.len());
    }
}

/// What the CPU sees of distant light as it was baked, and of near light by a bake of direct transfer and bounces of its own, in codes.
fn with_lamps(asset: &Asset, placed: &Placed) -> Vec<[u8; 3]> {
    let world = World::new(&asset.scene);
    let sky = light::load(
        &"constant:0.2,0.2,0.3".parse().unwrap(),
        &Default::default(),
    )
    .unwrap()
    .0;
    let order = asset.transfer.order;
    let far = IncidentLight::Distant(sky.project(order));
    let near = emitter::light_at_vertices(&world.positions, placed, order);
    let near = IncidentLight::PerVertex(near);
    let outgoing = display::outgoing(&world, &asset.transfer).unwrap();
    let (glossy, diffuse);
    let radiance: &dyn Radiance = match &outgoing {
        Some(outgoing) => {
            let arriving = arriving(&world, asset, &far, &near);
            glossy = GlossyRadiance::of(outgoing, &asset.transfer, arriving);
            &glossy
        }
        None => {
            let mut sides = bounced(&asset.transfer, &far, 0).unwrap();
            let more = bounced(&baked_with(None, 0).transfer, &near, folded(asset)).unwrap();
            sides.add(&more);
            diffuse = VertexRadiance::of_sides(&asset.transfer, sides);
            &diffuse
        }
    };
    let options = RaycastOptions {
        width: SIZE.0,
        height: SIZE.1,
        ..RaycastOptions::default()
    };
    let camera = Camera::framing(&world, SIZE.0 as f32 / SIZE.1 as f32);
    let (tracer, behind) = (Tracer::new(&world), |d| sky.radiance(d));
    let picture = display::render(
        &world,
        &tracer,
        radiance,
        &behind,
        Some(placed),
        &camera,
        &options,
    )
    .unwrap();
    let tone = ToneMap { exposure: -1.0 };
    picture.pixels.iter().map(|&p| tone.encode(p)).collect()
}

/// The bounces in its transfer.
fn folded(asset: &Asset) -> u32 {
    match asset.transfer.kind {
        TransferKind::Shadowed { bounces } => bounces,
        TransferKind::Unshadowed => 0,
    }
}

/// At the glossy surfaces of an asset.
fn arriving(
    world: &World,
    asset: &Asset,
    far: &IncidentLight,
    near: &IncidentLight,
) -> TransferredRadiance {
    let matrices = asset.transfer.matrices.as_ref().unwrap();
    let direct = baked_with(Some(matrices.order.get()), 0).transfer;
    let near = TransferredRadiance::new(&direct, near).unwrap();
    let bounces = GlossyBounces::new(world, &direct).unwrap();
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &false.into(),
    };
    let samples = bounces.usual_samples();
    let near = bounces.bounced(&near, folded(asset), samples, &monitor);
    let mut sum = TransferredRadiance::new(&asset.transfer, far).unwrap();
    sum.add(&near.unwrap());
    sum
}

#[test]
fn a_model_is_baked_and_a_file_that_is_none_is_an_error_in_one_line() {
    let test = "a_model_is_baked_and_a_file_that_is_none_is_an_error_in_one_line";
    let Some(display) = Display::open(test) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let model = "v 0 0 0\nv 1 0 0\nv 0 0 -1\nv 1 0 -1\nf 1 2 3\nf 2 4 3\n";
    std::fs::write(folder.path().join("floor.obj"), model).unwrap();
    std::fs::write(folder.path().join("text.glb"), "no glb at all").unwrap();
    let output = display.view(folder.path(), "floor.obj --screenshot floor.png");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if said.contains("no window could be opened") {
        println!("skipped: {test}: needs a graphics adapter (Debian: mesa-vulkan-drivers): {said}");
        return;
    }
    assert!(output.status.success(), "{said}");
    let picture = image::open(folder.path().join("floor.png"))
        .unwrap()
        .to_rgb8();
    let first = picture.get_pixel(0, 0);
    assert!(
        picture.pixels().any(|pixel| pixel != first),
        "a picture of nothing"
    );
    let output = display.view(folder.path(), "text.glb --screenshot none.png");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    // Drivers may have said something before.
    let ours: Vec<&str> = said
        .lines()
        .filter(|line| line.contains("text.glb"))
        .collect();
    assert_eq!(ours.len(), 1, "{said}");
    assert!(
        ours[0].starts_with("error: text.glb: ") && said.trim().ends_with(ours[0]),
        "{said}"
    );
    assert!(!folder.path().join("none.png").exists());
}
