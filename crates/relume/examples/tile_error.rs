//! How far a floor under a tile is from the relief it stands for, pixel by pixel.
//!
//!     cargo run --release -p relume --example tile_error -- PICTURE.png [TEXELS [SAMPLES [TRANSFER_ORDER [PATHS]]]]
//!
//! Bakes pebbles into a tile, covers a floor under a ball with it, renders that from baked transfer, and traces paths among the pebbles themselves,
//! twice. Prints relative RMS differences of the floor, and the times of the parts. PICTURE shows ours, the paths', and the absolute difference.

mod pictures;

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use relume::bake::tile::{TileOptions, bake_tile};
use relume::bake::trace::Tracer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::brdf::{Reflection, Tile};
use relume::display::{self, Camera, GlossyRadiance, Picture, RaycastOptions, ToneMap};
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::reference::{RenderOptions, Sources, material_surfaces, render_surfaces, sh_radiance};
use relume::scene::{self, Group, Instance, Material, Mesh, Scene, World, bundled};

use pictures::NOTHING;

/// Pixels of the picture, each way.
const SIZE: u32 = 480;
/// Periods along each side of the floor, and the length of one.
const PERIODS: usize = 6;
const PERIOD: f64 = 1.0;
/// Light of the picture is of this order.
const LIGHT: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let output = arguments.next().ok_or("which picture?")?;
    let mut number = |otherwise: u32| arguments.next().map_or(Ok(otherwise), |n| n.parse());
    let (texels, samples) = (number(64)?, number(256)?);
    let (transfer_order, paths) = (Order::new(number(7)? as usize)?, number(256)?);
    let sky = light::load(&"sky:30,3".parse()?, &LightOptions::default())?.0;
    let light = sky.project(Order::new(LIGHT)?);
    let relief = pebbles();

    let options = TileOptions {
        texels,
        samples,
        order: transfer_order,
        views: 13,
        bounces: 1,
        ..TileOptions::default()
    };
    let start = Instant::now();
    let tile = bake_tile(&relief, &options, &monitor(&AtomicBool::new(false)))?;
    println!("tile in {:.1} s", start.elapsed().as_secs_f64());
    let ours = covered(tile, &light, transfer_order)?;

    let world = World::new(&with_ball(laid_out(&relief)));
    let start = Instant::now();
    let (first, second) = (
        traced(&world, &light, paths, 1)?,
        traced(&world, &light, paths, 2)?,
    );
    println!("traced in {:.1} s", start.elapsed().as_secs_f64());
    let strip = pictures::compared(&ours, &first, &second);
    strip.write(output.as_ref(), &ToneMap::default())?;
    Ok(())
}

fn monitor(cancelled: &AtomicBool) -> Monitor<'_> {
    Monitor {
        progress: &|_| (),
        cancelled,
    }
}

/// Height and colour where pebbles at places (x, z), of a radius and a number, lie in sand that is a little below the surface.
fn surface(places: &[(f64, f64, f64, usize)], u: f64, v: f64) -> (f64, [f32; 3]) {
    let (mut height, mut color) = (0.0, [0.25, 0.2, 0.16]);
    for &(x, z, radius, i) in places {
        let around = |d: f64| d - d.round();
        let (dx, dz) = (around(u - x), around(v - z));
        let inside = 1.0 - (dx * dx + dz * dz) / (radius * radius);
        let here = 0.75 * radius * inside.max(0.0).sqrt();
        if here > height {
            let tone = |c: usize| 0.5 + 0.22 * libm::sin((i * (c + 2)) as f64) as f32;
            (height, color) = (here, [tone(0), tone(1), tone(2)]);
        }
    }
    (height - 0.04, color)
}

/// One period: pebbles in a bed of sand, as a height field.
fn pebbles() -> Scene {
    let steps = 96;
    let places = (0..16).map(|i| {
        let (row, column) = (i / 4, i % 4);
        let jitter = |k: usize| 0.05 * libm::sin(2.4 * (k * i) as f64 + k as f64);
        let x = (column as f64 + 0.5 + 0.5 * (row % 2) as f64) / 4.0 + jitter(3);
        let z = (row as f64 + 0.5) / 4.0 + jitter(5);
        (x, z, 0.125 + 0.3 * jitter(7), i)
    });
    let places: Vec<_> = places.collect();
    let surface = |u: f64, v: f64| surface(&places, u, v);
    let point = |u: f64, v: f64| {
        let (height, color) = surface(u, v);
        let step = 0.5 / steps as f64;
        let slope = |du, dv| (surface(u + du, v + dv).0 - surface(u - du, v - dv).0) / (2.0 * step);
        let normal = DVec3::new(-slope(step, 0.0), 1.0, -slope(0.0, step)).normalize();
        (
            (DVec3::new(u, height, v) * PERIOD).as_vec3(),
            normal.as_vec3(),
            color,
        )
    };
    let at = |i: usize| i as f64 / steps as f64;
    let rows = steps + 1;
    let points: Vec<_> = (0..rows * rows)
        .map(|i| point(at(i % rows), at(i / rows)))
        .collect();
    let corner = |i: usize, k: usize| (k * rows + i) as u32;
    let cells = (0..steps * steps).map(|cell| (cell % steps, cell / steps));
    let triangles = cells.flat_map(|(i, k)| {
        let (a, b) = (corner(i, k), corner(i + 1, k));
        let (c, d) = (corner(i, k + 1), corner(i + 1, k + 1));
        [[a, c, b], [b, c, d]]
    });
    let mesh = Mesh {
        name: "pebbles".to_owned(),
        positions: points.iter().map(|p| p.0).collect(),
        normals: points.iter().map(|p| p.1).collect(),
        colors: points.iter().map(|p| p.2).collect(),
        groups: vec![Group {
            material: 0,
            triangles: triangles.collect(),
        }],
        input_vertices: points.len(),
        ..Mesh::default()
    };
    Scene {
        meshes: vec![mesh],
        materials: vec![Material::diffuse("pebbles", [1.0; 3])],
        instances: vec![instance(0, DVec3::ZERO)],
        ..Scene::default()
    }
}

fn instance(mesh: usize, moved: DVec3) -> Instance {
    Instance {
        mesh,
        node: mesh,
        primitive: 0,
        world_from_object: DAffine3::from_translation(moved),
    }
}

/// Copies side by side, their middle at the origin.
fn laid_out(relief: &Scene) -> Scene {
    let mut scene = relief.clone();
    let at = |i: usize| (i as f64 - PERIODS as f64 / 2.0) * PERIOD;
    let places = (0..PERIODS * PERIODS).map(|i| (at(i % PERIODS), at(i / PERIODS)));
    scene.instances = places
        .map(|(x, z)| instance(0, DVec3::new(x, 0.0, z)))
        .collect();
    scene
}

/// A grey ball over it.
fn with_ball(mut scene: Scene) -> Scene {
    let mut ball = bundled::sphere(64, 0.5).meshes.swap_remove(0);
    ball.groups[0].material = scene.materials.len();
    scene.materials.push(Material::diffuse("ball", [0.5; 3]));
    let mesh = scene.meshes.len();
    scene.meshes.push(ball);
    scene
        .instances
        .push(instance(mesh, DVec3::new(0.4, 1.3, -0.3)));
    scene
}

/// The floor as a square of few vertices under the tile, and the ball: baked and rendered.
fn covered(tile: Tile, light: &ShLight, transfer_order: Order) -> Result<Picture, Box<dyn Error>> {
    let side = PERIODS as f64 * PERIOD;
    let mut floor = bundled::plane_under_sphere(1.0, 2.0, side, 8, 0.5)
        .meshes
        .swap_remove(0);
    let uv = |p: &Vec3| Vec2::new(p.x, p.z) / PERIOD as f32;
    floor.uvs = floor.positions.iter().map(uv).collect();
    let mut scene = Scene {
        meshes: vec![floor],
        materials: vec![Material::diffuse("floor", [1.0; 3])],
        instances: vec![instance(0, DVec3::ZERO)],
        ..Scene::default()
    };
    let repeat = 1.0;
    let tile = Arc::new(tile);
    scene::override_reflection(&mut scene, Reflection::Tile { tile, repeat });
    let scene = scene::tessellate(&with_ball(scene), 0.15)?;
    let world = World::new(&scene);
    println!(
        "{} vertices under the tile and on the ball",
        world.positions.len()
    );
    let options = BakeOptions {
        samples: 1024,
        bounces: 1,
        order: Order::new(LIGHT)?,
        transfer_order: Some(transfer_order),
        ..BakeOptions::default()
    };
    let start = Instant::now();
    let transfer = bake::bake(&world, &options, &monitor(&AtomicBool::new(false)))?.transfer;
    println!("baked in {:.1} s", start.elapsed().as_secs_f64());
    let outgoing = display::outgoing(&world, &transfer)?.ok_or("no matrices")?;
    let incident = IncidentLight::Distant(light.clone());
    let glossy = GlossyRadiance::new(&outgoing, &transfer, &incident).ok_or("no matrices")?;
    let size = RaycastOptions {
        width: SIZE,
        height: SIZE,
        samples_per_pixel: 16,
    };
    let behind = |_: Vec3| [NOTHING; 3];
    let start = Instant::now();
    let picture = display::render(
        &world,
        &Tracer::new(&world),
        &glossy,
        &behind,
        None,
        &camera(),
        &size,
    )?;
    println!("rendered in {:.1} s", start.elapsed().as_secs_f64());
    Ok(picture)
}

fn camera() -> Camera {
    Camera {
        eye: Vec3::new(2.2, 2.6, 4.2),
        target: Vec3::new(0.1, 0.4, 0.0),
        up: Vec3::Y,
        fov_vertical_deg: 38.0,
    }
}

/// The picture by paths of one bounce.
fn traced(
    world: &World,
    light: &ShLight,
    paths: u32,
    seed: u64,
) -> Result<Picture, Box<dyn Error>> {
    let options = RenderOptions {
        width: SIZE,
        height: SIZE,
        samples_per_pixel: paths,
        bounces: 1,
        seed,
    };
    let behind = |_: DVec3| [f64::from(NOTHING); 3];
    let (surfaces, light) = (material_surfaces(world).ok_or("tiles")?, sh_radiance(light));
    Ok(render_surfaces(
        world,
        &surfaces,
        &Sources::distant(&light),
        &behind,
        &camera(),
        &options,
    )?)
}
