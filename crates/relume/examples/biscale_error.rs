//! How far a picture of a glossy asset with maps is from path tracing, pixel by pixel.
//!
//!     cargo run --release -p relume --example biscale_error -- SCENE PICTURE.png [SAMPLES [BOUNCES [ORDER [TRANSFER_ORDER [PATHS]]]]]
//!
//! Bakes the scene, renders it under a sky with its sun, traces the same picture with PATHS paths a pixel, twice, and prints relative RMS differences over
//! the pixels that show a surface. PICTURE shows ours, the paths', and the absolute difference.

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DVec3, Vec3};
use relume::bake::trace::Tracer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::display::{self, Camera, GlossyRadiance, Picture, RaycastOptions, ToneMap};
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::reference::{RenderOptions, material_surfaces, render_surfaces, sh_radiance};
use relume::scene::{self, ImportOptions, World};

/// What stands behind the scene: far below any radiance, so that its pixels are known.
const NOTHING: f32 = -1e6;
/// Pixels of the picture, each way.
const SIZE: u32 = 480;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().ok_or("which scene?")?;
    let output = arguments.next().ok_or("which picture?")?;
    let mut number = |otherwise: u32| arguments.next().map_or(Ok(otherwise), |n| n.parse());
    let options = BakeOptions {
        samples: number(1024)?,
        bounces: number(0)?,
        order: Order::new(number(5)? as usize)?,
        transfer_order: Some(Order::new(number(10)? as usize)?),
        ..BakeOptions::default()
    };
    let paths = number(256)?;
    let import = ImportOptions {
        maps: true,
        ..ImportOptions::default()
    };
    let world = World::new(&scene::load(scene.as_ref(), &import)?);
    let sky = light::load(&"sky:30,3".parse()?, &LightOptions::default())?.0;
    let light = sky.project(options.order);
    let camera = Camera::framing(&world, 1.0);

    let ours = baked(&world, &light, &camera, &options)?;
    let start = Instant::now();
    let trace = |seed| traced(&world, &light, &camera, (paths, options.bounces), seed);
    let (first, second) = (trace(1)?, trace(2)?);
    println!("traced in {:.1} s", start.elapsed().as_secs_f64());
    let mean = combined(&first, &second, |a, b| (a + b) / 2.0);
    let noise = difference(&first, &second, &mean) / 2.0;
    let off = difference(&ours, &mean, &mean);
    println!(
        "off by {:.2} %, paths' noise {:.2} %, without it {:.2} %",
        100.0 * off,
        100.0 * noise,
        100.0 * (off * off - noise * noise).max(0.0).sqrt()
    );
    let shown = |picture: &Picture| combined(picture, picture, |a, _| a.max(0.0));
    let error = combined(&ours, &mean, |a, b| (a - b).abs());
    let strip = display::strip(&[shown(&ours), shown(&mean), shown(&error)], 0, [0.0; 3]);
    strip.write(output.as_ref(), &ToneMap::default())?;
    Ok(())
}

/// The picture from transfer.
fn baked(
    world: &World,
    light: &ShLight,
    camera: &Camera,
    options: &BakeOptions,
) -> Result<Picture, Box<dyn Error>> {
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    let start = Instant::now();
    let transfer = bake::bake(world, options, &monitor)?.transfer;
    println!("baked in {:.1} s", start.elapsed().as_secs_f64());
    let outgoing = display::outgoing(world, &transfer)?.ok_or("no matrices")?;
    let incident = IncidentLight::Distant(light.clone());
    let glossy = GlossyRadiance::new(&outgoing, &transfer, &incident).ok_or("no matrices")?;
    let size = RaycastOptions {
        width: SIZE,
        height: SIZE,
        samples_per_pixel: 16,
    };
    let behind = |_: Vec3| [NOTHING; 3];
    let start = Instant::now();
    let tracer = Tracer::new(world);
    let picture = display::render(world, &tracer, &glossy, &behind, camera, &size)?;
    println!("rendered in {:.1} s", start.elapsed().as_secs_f64());
    Ok(picture)
}

/// The picture by paths of that many bounces, that many to a pixel.
fn traced(
    world: &World,
    light: &ShLight,
    camera: &Camera,
    (paths, bounces): (u32, u32),
    seed: u64,
) -> Result<Picture, Box<dyn Error>> {
    let options = RenderOptions {
        width: SIZE,
        height: SIZE,
        samples_per_pixel: paths,
        bounces,
        seed,
    };
    let behind = |_: DVec3| [f64::from(NOTHING); 3];
    let (surfaces, light) = (material_surfaces(world).ok_or("tiles")?, sh_radiance(light));
    let picture = render_surfaces(world, &surfaces, &light, &behind, camera, &options)?;
    Ok(picture)
}

/// Pixel by pixel and channel by channel.
fn combined(a: &Picture, b: &Picture, of: impl Fn(f32, f32) -> f32) -> Picture {
    let pairs = a.pixels.iter().zip(&b.pixels);
    Picture {
        width: a.width,
        height: a.height,
        pixels: pairs
            .map(|(a, b)| std::array::from_fn(|c| of(a[c], b[c])))
            .collect(),
    }
}

/// Relative RMS over the pixels that show nothing but surfaces.
fn difference(a: &Picture, b: &Picture, scale: &Picture) -> f64 {
    let (mut off, mut all) = (0.0, 0.0);
    for ((a, b), scale) in a.pixels.iter().zip(&b.pixels).zip(&scale.pixels) {
        // A camera ray that leaves the scene outweighs all that a surface sends.
        if a[0].min(b[0]).min(scale[0]) < -1e3 {
            continue;
        }
        for c in 0..3 {
            off += f64::from(a[c] - b[c]).powi(2);
            all += f64::from(scale[c]).powi(2);
        }
    }
    (off / all).sqrt()
}
