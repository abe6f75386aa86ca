//! How far a picture of a glossy asset with maps is from path tracing, pixel by pixel.
//!
//!     cargo run --release -p relume --example biscale_error -- SCENE PICTURE.png [SAMPLES [BOUNCES [ORDER [TRANSFER_ORDER [PATHS]]]]]
//!
//! Bakes the scene, renders it under a sky with its sun, traces the same picture with PATHS paths a pixel, twice, and prints relative RMS differences over
//! the pixels that show a surface. PICTURE shows ours, the paths', and the absolute difference.

mod pictures;

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DVec3, Vec3};
use relume::bake::trace::Tracer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::display::{self, Camera, GlossyRadiance, Picture, RaycastOptions, ToneMap};
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::reference::{RenderOptions, Sources, material_surfaces, render_surfaces, sh_radiance};
use relume::scene::{self, ImportOptions, World};

use pictures::NOTHING;

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
    let strip = pictures::compared(&ours, &first, &second);
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
    let picture = display::render(world, &tracer, &glossy, &behind, None, camera, &size)?;
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
    let picture = render_surfaces(
        world,
        &surfaces,
        &Sources::distant(&light),
        &behind,
        camera,
        &options,
    )?;
    Ok(picture)
}
