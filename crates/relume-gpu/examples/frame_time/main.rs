//! What a frame costs when the light turns every frame, against the same mesh under a plain Lambert shader.
//!
//!     cargo run --release -p relume-gpu --example frame_time -- MESH [FRAMES [TRANSFER_ORDER]]
//!
//! With a transfer order surfaces are metal, and the one line is of matrices for light of order 5.
//!
//! 1280 × 720 pixels, one sample each, no window; `WGPU_BACKEND` chooses vulkan, gl, metal or dx12. A frame turns the light's coefficients on the CPU,
//! stages them, runs the relight pass and the view pass, and waits for the device. The kinds of frames take turns; each line is
//! tab-separated: order, channels, then milliseconds (medians; for the whole frame the 99th percentile, too), and the price of transfer: frame
//! over Lambert, the median of the ratios of each turn. Passes are timed by the device where it can, else each by a frame of its own.

mod lambert;
mod stopwatch;

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use glam::DMat3;
use relume::asset::Transfer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::brdf::Reflection;
use relume::display::Camera;
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::scene::{self, ImportOptions, Material, World};
use relume_gpu::{Look, Offscreen, Renderer, Target};
use wgpu::TextureFormat;

use lambert::Lambert;
use stopwatch::{Pass, Stopwatch, median, percentile};

const SIZE: (u32, u32) = (1280, 720);
/// As windows have it: the device encodes colours.
const TARGET: Target = Target {
    format: TextureFormat::Rgba8UnormSrgb,
    samples: 1,
};
/// Before the clock counts: shaders are compiled when they are first used, and caches, memory pages and clocks take their time.
const WARM_UP: Duration = Duration::from_secs(6);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("which mesh?")?;
    let frames: usize = arguments.next().map_or(Ok(200), |n| n.parse())?;
    let glossy: Option<usize> = arguments.next().map(|n| n.parse()).transpose()?;
    let glossy = glossy.map(Order::new).transpose()?;
    let mut scene = scene::load(path.as_ref(), &ImportOptions::default())?;
    if glossy.is_some() {
        scene.materials.iter_mut().for_each(make_metal);
    }
    let world = World::new(&scene);
    let sky = light::load(&"sky:30,3".parse()?, &LightOptions::default())?.0;

    let mut bench = Bench::open(&world)?;
    println!(
        "{} vertices, {} triangles, {}",
        world.positions.len(),
        world.triangles.len(),
        bench.watch.adapter
    );
    println!("order\tchannels\tframe\tp99\trelight\tview\tlambert\tprice");
    let rows: &[(usize, usize)] = match glossy {
        Some(_) => &[(5, 1)],
        None => &[(4, 1), (4, 3), (5, 1), (5, 3), (10, 1), (10, 3)],
    };
    for &(order, channels) in rows {
        let order = Order::new(order)?;
        let transfer = transfer(&world, (order, glossy), channels)?;
        bench.renderer.upload(&world, &transfer)?;
        let times = bench.run(&sky.project(order), frames)?;
        println!("{}\t{channels}\t{times}", order.get());
    }
    Ok(())
}

fn make_metal(material: &mut Material) {
    material.reflection = Reflection::MetallicRoughness {
        metallic: 1.0,
        roughness: 0.4,
    };
}

/// A transfer of the right size. What is in it does not matter here, so it is made quickly.
fn transfer(
    world: &World,
    (order, transfer_order): (Order, Option<Order>),
    channels: usize,
) -> Result<Transfer, Box<dyn Error>> {
    let options = BakeOptions {
        order,
        transfer_order,
        samples: 16,
        shadows: channels == 3,
        bounces: u32::from(channels == 3),
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    Ok(bake::bake(world, &options, &monitor)?.transfer)
}

/// Everything that is on the device, and the camera that looks at it.
struct Bench {
    watch: Stopwatch,
    renderer: Renderer,
    lambert: Lambert,
    picture: Offscreen,
    camera: Camera,
    look: Look,
}

/// Milliseconds of every turn.
#[derive(Default)]
struct Times {
    frame: Vec<f64>,
    relight: Vec<f64>,
    view: Vec<f64>,
    lambert: Vec<f64>,
}

impl Bench {
    fn open(world: &World) -> Result<Self, Box<dyn Error>> {
        let watch = pollster::block_on(Stopwatch::open())?;
        let camera = Camera::framing(world, SIZE.0 as f32 / SIZE.1 as f32);
        Ok(Self {
            renderer: Renderer::new(&watch.device, &watch.queue, TARGET),
            lambert: Lambert::new(&watch.device, TARGET, world, &camera)?,
            picture: Offscreen::new(&watch.device, TARGET, SIZE.0, SIZE.1),
            camera,
            look: Look::default(),
            watch,
        })
    }

    fn run(&mut self, light: &ShLight, frames: usize) -> Result<Times, Box<dyn Error>> {
        let mut times = Times::default();
        let start = Instant::now();
        for i in 0.. {
            let turn = DMat3::from_rotation_y(0.02 * f64::from(i));
            let mut turned = Times::default();
            self.turn(light, turn, &mut turned)?;
            if start.elapsed() > WARM_UP {
                times.extend(turned);
            }
            if times.frame.len() >= frames {
                break;
            }
        }
        Ok(times)
    }

    /// One frame of each kind.
    fn turn(
        &mut self,
        light: &ShLight,
        world_from_light: DMat3,
        times: &mut Times,
    ) -> Result<(), Box<dyn Error>> {
        let Self {
            watch,
            renderer,
            lambert,
            picture,
            camera,
            look,
        } = self;
        times.lambert.push(watch.time(|encoder| {
            let mut pass = picture.pass(encoder, wgpu::Color::BLACK, None);
            lambert.draw(&mut pass);
            Ok(())
        })?);
        times.frame.push(watch.time(|encoder| {
            let light = light.rotated(world_from_light)?;
            renderer.stage_light(&IncidentLight::Distant(light))?;
            renderer.relight(encoder, watch.timestamps(Pass::Relight));
            let mut pass = picture.pass(encoder, wgpu::Color::BLACK, watch.timestamps(Pass::View));
            Ok(renderer.draw(&mut pass, camera, look)?)
        })?);
        let (relight, view) = match watch.passes() {
            Some(passes) => passes,
            None => (
                watch.time(|encoder| {
                    renderer.relight(encoder, None);
                    Ok(())
                })?,
                watch.time(|encoder| {
                    let mut pass = picture.pass(encoder, wgpu::Color::BLACK, None);
                    Ok(renderer.draw(&mut pass, camera, look)?)
                })?,
            ),
        };
        times.relight.push(relight);
        times.view.push(view);
        Ok(())
    }
}

impl Times {
    fn extend(&mut self, other: Self) {
        self.frame.extend(other.frame);
        self.relight.extend(other.relight);
        self.view.extend(other.view);
        self.lambert.extend(other.lambert);
    }
}

impl std::fmt::Display for Times {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let prices = self.frame.iter().zip(&self.lambert).map(|(a, b)| a / b);
        write!(
            f,
            "{:.2}\t{:.2}\t{:.2}\t{:.2}\t{:.2}\t{:.2}",
            median(&self.frame),
            percentile(&self.frame, 0.99),
            median(&self.relight),
            median(&self.view),
            median(&self.lambert),
            median(&prices.collect::<Vec<_>>()),
        )
    }
}
