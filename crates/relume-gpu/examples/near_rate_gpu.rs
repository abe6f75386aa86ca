//! How fast light of near panels is found on the device: exactly at every vertex, and through cube maps at points.
//!
//! ```text
//! cargo run --release -p relume-gpu --example near_rate_gpu
//! ```
//!
//! The panels of the library's example of the same name, around a unit sphere. `WGPU_BACKEND` chooses a back end. The best of seven runs, each waited for; nothing of other programs should
//! run beside it.

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DAffine3, DQuat, DVec3};
use relume::asset::Transfer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::display::Camera;
use relume::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape};
use relume::scene::{World, bundled};
use relume_gpu::{CubeSampler, Look, Offscreen, Renderer, Target};
use wgpu::{Device, Queue, TextureFormat};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const RUNS: u32 = 7;
const SIZE: (u32, u32) = (640, 360);
/// Points of one run through cube maps.
const POINTS: usize = 256;

fn main() -> Result<()> {
    let (device, queue) = pollster::block_on(open())?;
    println!("vertices  panels  order  ms a relight  vertices/ms  frames/s, light moving, drawn");
    for across in [142, 318] {
        let world = World::new(&bundled::sphere(across, 0.5));
        for order in [4, 5] {
            let mut bench = Bench::new(&device, &queue, &world, Order::new(order)?)?;
            for panels in [1, 16, 64] {
                let still = around(panels, 0.0)?;
                let seconds = best(|| bench.relight(&still))?;
                let moving = (0..RUNS).map(|i| around(panels, 0.01 * f64::from(i)));
                let mut moving = moving.collect::<Result<Vec<_>>>()?.into_iter().cycle();
                let frame = best(|| bench.frame(&moving.next().ok_or("no panels")?))?;
                println!(
                    "{:>8}  {panels:>6}  {order:>5}  {:>12.2}  {:>11.0}  {:>8.1}",
                    world.positions.len(),
                    1e3 * seconds,
                    world.positions.len() as f64 / (1e3 * seconds),
                    1.0 / frame
                );
            }
        }
    }
    println!("\npixels  panels  samples/s through cube maps, order 4");
    let points = spiral(POINTS, 0.01);
    for size in [32, 64] {
        let mut sampler = CubeSampler::new(&device, &queue, Order::new(4)?, size)?;
        for panels in [1, 16, 64] {
            let placed = around(panels, 0.0)?;
            let seconds = best(|| {
                sampler.sample(&placed, &points)?;
                Ok(())
            })?;
            println!("{size:>6}  {panels:>6}  {:>9.0}", POINTS as f64 / seconds);
        }
    }
    Ok(())
}

async fn open() -> Result<(Device, Queue)> {
    let instance = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    let instance = wgpu::Instance::new(instance);
    let adapter = instance.request_adapter(&Default::default()).await?;
    let info = adapter.get_info();
    println!("{} ({}, {})", info.name, info.backend, info.driver_info);
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: adapter.limits(),
        ..wgpu::DeviceDescriptor::default()
    };
    Ok(adapter.request_device(&descriptor).await?)
}

/// Seconds of the fastest run, after one that compiles shaders.
fn best(mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    work()?;
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        work()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}

/// A scene on the device.
struct Bench<'a> {
    device: &'a Device,
    queue: &'a Queue,
    renderer: Renderer,
    picture: Offscreen,
    camera: Camera,
}

impl<'a> Bench<'a> {
    fn new(device: &'a Device, queue: &'a Queue, world: &World, order: Order) -> Result<Self> {
        let target = Target::from(TextureFormat::Rgba8UnormSrgb);
        let mut renderer = Renderer::new(device, queue, target);
        renderer.upload(world, &transfer(world, order)?)?;
        Ok(Self {
            device,
            queue,
            renderer,
            picture: Offscreen::new(device, target, SIZE.0, SIZE.1),
            camera: Camera::framing(world, SIZE.0 as f32 / SIZE.1 as f32),
        })
    }

    /// Light alone.
    fn relight(&mut self, placed: &Placed) -> Result<()> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.renderer.stage_emitters(Some(placed))?;
        self.renderer.relight(&mut encoder, None);
        self.wait(encoder)
    }

    /// Light and picture.
    fn frame(&mut self, placed: &Placed) -> Result<()> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.renderer.stage_emitters(Some(placed))?;
        self.renderer.relight(&mut encoder, None);
        let mut pass = self.picture.pass(&mut encoder, wgpu::Color::BLACK, None);
        self.renderer
            .draw(&mut pass, &self.camera, &Look::default())?;
        drop(pass);
        self.wait(encoder)
    }

    fn wait(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(())
    }
}

/// What is in it does not matter here, so it is made quickly.
fn transfer(world: &World, order: Order) -> Result<Transfer> {
    let options = BakeOptions {
        order,
        samples: 16,
        shadows: false,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    Ok(bake::bake(world, &options, &monitor)?.transfer)
}

/// Points on the unit sphere from pole to pole, each `turn` radians on from the last.
fn spiral(count: usize, turn: f64) -> Vec<DVec3> {
    let point = |i: usize| {
        let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (i as f64 * turn).sin_cos();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * cos, y, r * sin)
    };
    (0..count).map(point).collect()
}

/// Panels on a sphere of twice the radius, that face the middle; all turned by an angle about y.
fn around(count: usize, angle: f64) -> Result<Placed> {
    let side = 1.5 / (count as f64).sqrt();
    // The golden angle keeps them apart.
    let places = spiral(count, 2.399_963).into_iter().enumerate();
    let emitters = places.map(|(i, at)| {
        let at = DQuat::from_rotation_y(angle) * at * 2.0;
        let turn = DQuat::from_rotation_arc(DVec3::Z, -at.normalize());
        Emitter {
            name: format!("panel {i}"),
            shape: Shape::Mesh(EmitterMesh::quad(side, side)),
            pattern: Pattern::Uniform([1.0, 0.8, 0.6]),
            two_sided: false,
            exponent: 0,
            world_from_emitter: DAffine3::from_rotation_translation(turn, at),
        }
    });
    Ok(Emitters::new(emitters.collect())?.placed())
}
